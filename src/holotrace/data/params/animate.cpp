#include "holotrace/data/params/animate.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {

std::vector<double> times_of(const AnimateParams& params, std::optional<double> last) {
  check_ranges(params);
  if (!params.times.empty()) {
    const auto late = std::adjacent_find(params.times.begin(), params.times.end(), std::greater_equal<>());
    require(late == params.times.end(), "expected the times of a film in their order, got {} after {}",
            late == params.times.end() ? "" : format_time(late[1]),
            late == params.times.end() ? "" : format_time(late[0]));
    require(int64_t(params.times.size()) <= most_times, "expected at most {} times of a film, got {}", most_times,
            params.times.size());
    return params.times;
  }
  double seconds = params.seconds;
  if (seconds == 0) {
    require(last.has_value(),
            "expected the duration of the film, got none, and nothing in the scene changes over time; give seconds (a "
            "flag, or a key below [animate]), keys over time to what moves, or --turntable to a model");
    seconds = *last - params.start;
    require(seconds > 0,
            "expected a start before the last key of the scene at {}, got {}; give the duration of the film as seconds",
            format_time(*last), format_time(params.start));
  }
  const double count = std::max(1.0, std::round(seconds * params.fps));
  require(count <= double(most_times),
          "expected at most {} times of a film, got {:.6g}: {:g} s with {:g} per second; shorten it, or make films of "
          "its parts",
          most_times, count, seconds, params.fps);
  std::vector<double> times(static_cast<size_t>(count));
  for (size_t i = 0; i < times.size(); ++i) times[i] = params.start + double(i) / params.fps;
  return times;
}

}  // namespace holotrace
