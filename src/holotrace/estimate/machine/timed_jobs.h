#pragma once

#include "holotrace/base/units.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"
#include "holotrace/data/triangles.h"

// Jobs for measurements of speed: used by holotrace bench, by bench/, and by the calibration of the cost model. The
// wavelength is 532 nm, and the seed is fixed.

namespace holotrace {

inline constexpr double timed_wavelength = 532e-9;
inline constexpr Grid timed_full_hd{1920, 1080, 8e-6};
inline constexpr Grid timed_ultra_hd{3840, 2160, 3.74e-6};

/// Waves of random phase, spread evenly over the panel and over depths from `nearest` to `farthest` [m].
Sources timed_waves(const Grid& panel, int64_t count, double nearest, double farthest);

/// The half of a sphere of 8 mm that faces the panel, 0.2 m behind it, as about `count` triangles of random phase;
/// triangles that face the panel more directly are brighter.
Triangles timed_half_sphere(int64_t count);

/// A field of amplitude 1 and random phases.
Field timed_field(const Grid& panel);

}  // namespace holotrace
