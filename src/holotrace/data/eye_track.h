#pragma once

#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/eye.h"

namespace holotrace {

/// Places of an eye over time.
struct EyeTrack {
  std::vector<double> times;  ///< [s], at least two, each later than the one before
  std::vector<Vec3> places;   ///< [m], one for each time, in front of the panel: z > 0
};

/// The place of the eye at a time [m]: on a straight line between two places; before the first time the first place, after the
/// last time the last one.
Vec3 place_at(const EyeTrack& track, double time);

/// The eye of a viewer at a time, and where a display takes it to be [m].
struct TrackedEye {
  Vec3 place;        ///< e(t), where the eye is
  Vec3 measured;     ///< where the hologram takes it to be
  Vec3 unpredicted;  ///< the same without a prediction
  double end = 0;    ///< of the track [s]

  /// Whether the hologram is made for another place than that of the eye, beyond the rounding of times.
  bool is_off() const { return length(measured - place) > 1e-9; }
};

/// The eye at a time t, which is measured with the latency L and noise n of the standard deviation σ along each axis:
///
///     m(t) = e(t) + σ·n(t),   measured = m(t − L),   predicted = 2·m(t − L) − m(t − 2L)
///
/// A straight walk at the speed v is measured v·L behind the eye, and predicted without an error; an accelerated one is predicted
/// a·L² behind. The noise of a prediction is √5·σ. n depends on the seed and on the time of the measurement alone, to a nanosecond.
/// @throws Error  for parameters outside their ranges, and for a measured eye that is not in front of the panel
TrackedEye tracked_eye(const EyeTrack& track, const EyeParams& params, double time);

}  // namespace holotrace
