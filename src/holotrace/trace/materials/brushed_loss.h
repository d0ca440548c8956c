#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "holotrace/base/vec.h"
#include "holotrace/trace/materials/microfacet.h"

namespace holotrace {

/// The loss of single scattering of white brushed microfacets, 1 − E(o), by direction: in a table over √cosθ and over |cosφ|, φ being
/// the angle from the tangent. With it, multiple scattering (RoughReflectionOf) sends back all that is lost. The mean is that of the
/// interpolated values, so the balance of energy is exact but for the error of the table at the viewer's own direction.
struct BrushedLoss {
  static constexpr int cosines = 24, turns = 17;
  std::array<std::array<float, turns>, cosines> losses{};
  double mean = 0;        ///< over the hemisphere, by the cosine
  double even_alpha = 0;  ///< α of the isotropic surface with the same mean loss

  /// @param w  local, with x along the tangent; z > 0
  double at(Vec3 w) const {
    const double across = std::hypot(w.x, w.y);
    const double x = std::sqrt(w.z) * (cosines - 1), y = (across > 0 ? std::fabs(w.x) / across : 1) * (turns - 1);
    const int i = std::clamp(int(x), 0, cosines - 2), j = std::clamp(int(y), 0, turns - 2);
    const auto along = [&](int row) {
      const auto& entries = losses[size_t(row)];
      return double(entries[size_t(j)]) + (y - j) * double(entries[size_t(j) + 1] - entries[size_t(j)]);
    };
    return along(i) + (x - i) * (along(i + 1) - along(i));
  }
};

/// Reflection off microfacets that may be brushed: E depends on the direction. Its `albedo` is that of the isotropic surface with the
/// same mean loss.
struct BrushedReflection : RoughReflectionOf<Vec2> {
  const BrushedLoss* brushed = nullptr;  ///< nullptr: isotropic

  using RoughReflectionOf<Vec2>::loss;
  double loss(Vec3 w) const { return brushed ? brushed->at(w) : loss(w.z); }
};

/// The table of α along the tangent and across it, each from smooth_alpha to 1; made on the first call for them (50 ms) and kept.
/// Any number of threads may call.
const BrushedLoss& brushed_loss(Vec2 alpha);

}  // namespace holotrace
