#pragma once

#include "holotrace/base/units.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"
#include "holotrace/data/triangles.h"

// What is summed, moved and shown where speed is measured: by holotrace bench, by bench/, and by the calibration of the
// cost model. At 532 nm, from a fixed seed.

namespace holotrace {

inline constexpr double timed_wavelength = 532e-9;
inline constexpr Grid timed_full_hd{1920, 1080, 8e-6};
inline constexpr Grid timed_ultra_hd{3840, 2160, 3.74e-6};

/// Waves of random phase, spread evenly over the panel and over depths from `nearest` to `farthest` [m].
Sources timed_waves(const Grid& panel, int64_t count, double nearest, double farthest);

/// The half of a sphere of 8 mm that faces the panel, 0.2 m behind it, as about that many triangles of random phase,
/// bright as their normals face the panel.
Triangles timed_half_sphere(int64_t count);

/// Random phases of amplitude 1.
Field timed_field(const Grid& panel);

}  // namespace holotrace
