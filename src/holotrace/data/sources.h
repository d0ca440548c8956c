#pragma once

#include <vector>

#include "holotrace/base/vec.h"

namespace holotrace {

/// A spherical wave that leaves a point behind the panel:
///
///     U(p) = a · (d₀/r) · exp(i(2πr/λ + φ₀)),   r = ‖p − o‖,  d₀ = −o.z     (Eq. 5, 6)
///
/// a is its amplitude where it meets the panel head-on.
struct Source {
  Vec3 origin;          ///< o [m], z < 0
  float amplitude = 0;  ///< a [√(W/m²)]
  float phase = 0;      ///< φ₀ [rad]
  bool operator==(const Source&) const = default;
};

/// Waves of one wavelength [m].
struct Sources {
  double wavelength = 0;
  std::vector<Source> waves;
};

/// @throws Error, naming the first wave at fault, unless every number is finite and every wave is
///         behind the panel (z < 0).
void check_sources(const Sources& sources);

}  // namespace holotrace
