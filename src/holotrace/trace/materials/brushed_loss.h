#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

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

  /// Where a direction is in the table.
  struct Place {
    size_t row, column;
    double down, along;  ///< parts of the way to the next ones
  };

  /// @param w  local, with x along the tangent; z > 0
  static Place place_of(Vec3 w) {
    const double across = std::hypot(w.x, w.y);
    const double x = std::sqrt(w.z) * (cosines - 1), y = (across > 0 ? std::fabs(w.x) / across : 1) * (turns - 1);
    const int i = std::clamp(int(x), 0, cosines - 2), j = std::clamp(int(y), 0, turns - 2);
    return {size_t(i), size_t(j), x - i, y - j};
  }

  double at(const Place& p) const {
    const auto in_row = [&](const auto& row) {
      return double(row[p.column]) + p.along * double(row[p.column + 1] - row[p.column]);
    };
    const double above = in_row(losses[p.row]);
    return above + p.down * (in_row(losses[p.row + 1]) - above);
  }
};

/// The loss of a surface: a sum of tables, of which those without a weight may be missing.
struct BrushedLossBetween {
  std::array<const BrushedLoss*, 4> tables{};
  std::array<double, 4> weights{};

  template <class F>
  double of_tables(const F& f) const {
    double sum = 0;
    for (size_t k = 0; k < tables.size() && tables[k]; ++k) sum += weights[k] * f(*tables[k]);
    return sum;
  }
  double mean() const {
    return of_tables([](const BrushedLoss& table) { return table.mean; });
  }
  double even_alpha() const {
    return of_tables([](const BrushedLoss& table) { return table.even_alpha; });
  }
  double at(Vec3 w) const {
    const BrushedLoss::Place place = BrushedLoss::place_of(w);
    return of_tables([&](const BrushedLoss& table) { return table.at(place); });
  }
};

/// Reflection off microfacets that may be brushed: E depends on the direction. Its `albedo` is that of the isotropic surface with the
/// same mean loss.
struct BrushedReflection : RoughReflectionOf<Vec2> {
  std::optional<BrushedLossBetween> brushed{};  ///< nothing: isotropic

  using RoughReflectionOf<Vec2>::loss;
  double loss(Vec3 w) const { return brushed ? brushed->at(w) : loss(w.z); }
};

/// α along the tangent, α + (1 − α)·anisotropy², and across it, α = roughness², as PrincipledMaterial says; 10⁻³ or more.
inline Vec2 brushed_alpha(double roughness, double anisotropy) {
  constexpr double least = 1e-3;
  const double even = roughness * roughness;
  return {std::fmax(even + (1 - even) * anisotropy * anisotropy, least), std::fmax(even, least)};
}

/// The loss of a surface of this roughness and anisotropy, by a table of its own that is made on the first call (50 ms) and kept. Any
/// number of threads may call.
BrushedLossBetween brushed_loss(double roughness, double anisotropy);

/// The same of a texture, which has many values: between tables at 13 by 9 of them, made when they are needed (15 ms each; all take
/// 1 s on two cores). Losses are within 0.026 of the integral near grazing angles (86°), within 0.013 up to 76°, and 0.0035 (rms) over all.
BrushedLossBetween brushed_loss_of_texel(double roughness, double anisotropy);

}  // namespace holotrace
