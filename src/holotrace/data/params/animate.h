#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "holotrace/data/params/parameter.h"

// animate: a scene at several times → a film

namespace holotrace {

/// File of a film: an animation, or a series of pictures.
enum class FilmFormat { webp, gif, mp4, webm, png };

/// The times of a film: `times`, or `fps` times per second from `start` on, as long as `seconds`.
struct AnimateParams {
  double start = 0;             ///< first time [s]
  double seconds = 0;           ///< duration [s]; 0: up to the last key of the scene
  double fps = 25;              ///< times per second
  std::vector<double> times{};  ///< [s]; empty: by the above
  FilmFormat format = FilmFormat::webp;
  /// Whether the iterations go on from the holograms of the time before (encode_frames), which takes a fifth of them; else each
  /// time has the bytes of a run of its own.
  bool from_last = false;
};

template <class Visitor>
void describe(Visitor&& v, AnimateParams& p) {
  v(time("start", p.start, range::any, "first time of the film"));
  v(number("seconds", p.seconds, range::not_negative,
           "duration of the film in seconds; 0: up to the last key of the scene and of the animations of its models"));
  v(number("fps", p.fps, range::above_to(0, 1e5), "times per second"));
  v(times("times", p.times, range::any, "times of the film, in place of start and seconds; each is shown for 1/fps"));
  v(choice("format", p.format,
           {{"webp", FilmFormat::webp},
            {"gif", FilmFormat::gif},
            {"mp4", FilmFormat::mp4},
            {"webm", FilmFormat::webm},
            {"png", FilmFormat::png}},
           "file of the films: an animation, or a series of pictures (png); mp4 and webm need the program ffmpeg"));
  v(flag("from_last", p.from_last,
         "sgd: iterations go on from the holograms of the time before, and take a fifth of their number "
         "(--next-iterations); false: each time starts afresh, with the bytes of a run of its own"));
}

/// Most times of a film.
inline constexpr int64_t most_times = 100'000;

/// The times of a film [s]: `times`, or start + i/fps for i = 0 … round(seconds·fps) − 1.
/// @param last  the last key of the scene [s]: the end of a film without `seconds`
/// @throws Error  for a scene without keys if `seconds` and `times` are not given, for a last key that is not after the start,
///                for times that are not in their order, and for more than most_times
std::vector<double> times_of(const AnimateParams& params, std::optional<double> last);

}  // namespace holotrace
