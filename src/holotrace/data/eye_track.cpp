#include "holotrace/data/eye_track.h"

#include <cmath>
#include <cstdint>
#include <numbers>

#include "holotrace/base/error.h"
#include "holotrace/base/keyframes.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

// Three normal numbers of mean 0 and variance 1, by the method of Box and Muller. The same measurement is reached by different
// sums of times, which agree to less than a nanosecond.
Vec3 normal_numbers(int64_t seed, double time) {
  CounterRandom random(uint64_t(seed), 0, uint64_t(std::llround(time * 1e9)));
  const auto normal = [&] {
    const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
    return radius * std::cos(2 * std::numbers::pi * random.uniform());
  };
  const double x = normal(), y = normal(), z = normal();
  return {x, y, z};
}

Vec3 measured_at(const EyeTrack& track, const EyeParams& params, double time) {
  const Vec3 place = place_at(track, time);
  return params.noise > 0 ? place + normal_numbers(params.seed, time) * params.noise : place;
}

}  // namespace

Vec3 place_at(const EyeTrack& track, double time) {
  const KeyPlace at = place_among(track.times, time);
  const Vec3& from = track.places[at.key];
  if (at.part == 0) return from;
  const Vec3& to = track.places[at.key + 1];
  return {std::lerp(from.x, to.x, at.part), std::lerp(from.y, to.y, at.part), std::lerp(from.z, to.z, at.part)};
}

TrackedEye tracked_eye(const EyeTrack& track, const EyeParams& params, double time) {
  check_ranges(params);
  TrackedEye eye{place_at(track, time), measured_at(track, params, time - params.latency), {}, track.times.back()};
  eye.unpredicted = eye.measured;
  if (params.is_predicted && params.latency > 0)
    eye.measured = eye.measured * 2 - measured_at(track, params, time - 2 * params.latency);
  require(eye.measured.z > 0,
          "expected a measured eye in front of the panel at {}, got z = {}; use less noise, or a shorter latency",
          format_time(time), format_length(eye.measured.z));
  return eye;
}

}  // namespace holotrace
