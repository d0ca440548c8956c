#pragma once

#include <cstdint>
#include <string>

namespace holotrace {

/// What tells light, and what shows it, from others of its wavelength. Every verb hands it on: trace, synthesize, encode, show, propagate.
struct Label {
  std::string name{};  ///< name of the path group or light that it shows, "" for all light
  uint32_t frame = 0;  ///< index of the frame of a time-multiplexed hologram, which has random phases of its own
  /// Acceptance wavelength: the one whose acceptance cone bounds the light [m], at most its own. If all colours of a job share one cone,
  /// it is the job's shortest wavelength. 0: its own.
  double cone_wavelength = 0;
  bool operator==(const Label&) const = default;
};

}  // namespace holotrace
