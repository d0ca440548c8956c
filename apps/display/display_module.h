#pragma once

// The interface between the program and holotrace_display.so, which alone knows SDL: a program that shows nothing on a
// monitor need not load it.

namespace holotrace {

/// What to show: pictures of columns × rows colours of 8 bits per channel, one after the other.
struct DisplayJob {
  int columns = 0, rows = 0, pictures = 0;
  const unsigned* const* colours = nullptr;  ///< colours 0xRRGGBB of each picture, [row][column]
  int monitor = 0;                           ///< from 0
  double rate = 0;                           ///< pictures per second; 0: that of the monitor
  double seconds = 0;                        ///< duration; 0: until a key or is_over
  bool (*is_over)() = nullptr;               ///< asked at every picture
  /// Asked at every picture, with `context`, whether others are shown from now on, of the same size: it then changes `pictures` and
  /// `colours` of its job. nullptr: they stay.
  bool (*renew)(void* context, DisplayJob* job) = nullptr;
  void* context = nullptr;
};

/// What happened.
struct DisplayOutcome {
  long shown = 0, missed = 0;  ///< changes of the picture; times at which the next one was due, but came later
  double rate = 0;             ///< pictures per second that were asked for
  char problem[512] = "";      ///< a sentence, if nothing could be shown
};

using DisplayFunction = void (*)(const DisplayJob*, DisplayOutcome*);
inline constexpr const char* display_function = "holotrace_display";

}  // namespace holotrace
