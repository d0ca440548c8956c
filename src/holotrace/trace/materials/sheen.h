#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"

// Sheen of fibres that stand off a surface (velvet, dust), as KHR_materials_sheen has it: Estevez and Kulla, Production
// friendly microfacet sheen BRDF, SIGGRAPH 2017 course; visibility by Neubelt and Pettineo, SIGGRAPH 2013 course.

namespace holotrace {

/// Directional albedos of white sheen, against √cosθ (columns) and roughness (rows).
struct SheenAlbedoTable {
  static constexpr int size = 24;
  using Rows = std::array<std::array<float, size>, size>;
  Rows whole;  ///< E of the formula, which is above 1 at grazing angles for a low roughness
  Rows kept;   ///< of what is kept of it, at most 1
};

/// The table, computed on the first call (0.2 s). Any number of threads may call.
const SheenAlbedoTable& sheen_albedo_table();

/// White sheen of one roughness:
///
///     f = D/(4·(cosθ_o + cosθ_i − cosθ_o·cosθ_i))/max(1, E(o), E(i)),   D = (2 + 1/α)·(sinθ_h)^{1/α}/(2π),   α = roughness².
///
/// E is the albedo of the first part. The last factor keeps that of the whole at most 1; it is 1 for roughnesses above 0.5.
/// Directions are local, z > 0.
class Sheen {
 public:
  static constexpr double least_roughness = 0.1;

  Sheen() = default;

  /// @param roughness  in [0, 1]; below least_roughness it counts as that
  explicit Sheen(double roughness) : table_(&sheen_albedo_table()) {
    const double r = std::fmax(roughness, least_roughness), x = r * (SheenAlbedoTable::size - 1);
    inverse_alpha_ = 1 / (r * r);
    row_ = std::clamp(int(x), 0, SheenAlbedoTable::size - 2);
    weight_ = x - row_;
  }

  /// Albedo at a cosine in [0, 1].
  double albedo(double cosine) const { return at(table_->kept, cosine); }

  /// f·cosθ_i; 0 below the surface.
  double eval(Vec3 o, Vec3 i) const {
    if (!(i.z > 0)) return 0;
    return formula(o, i, inverse_alpha_) / std::max({1.0, at(table_->whole, o.z), at(table_->whole, i.z)});
  }

  /// The same without the last factor.
  static double formula(Vec3 o, Vec3 i, double inverse_alpha) {
    const double cosine = normalize(o + i).z, sine = std::sqrt(std::fmax(0, 1 - cosine * cosine));
    const double density = (2 + inverse_alpha) * std::pow(sine, inverse_alpha) / (2 * pi);
    return density * i.z / (4 * (o.z + i.z - o.z * i.z));
  }

 private:
  double at(const SheenAlbedoTable::Rows& rows, double cosine) const {
    const double x = std::sqrt(cosine) * (SheenAlbedoTable::size - 1);
    const int column = std::clamp(int(x), 0, SheenAlbedoTable::size - 2);
    const double s = x - column;
    const auto of_row = [&](int row) {
      const auto& entries = rows[size_t(row)];
      return entries[size_t(column)] * (1 - s) + entries[size_t(column) + 1] * s;
    };
    return of_row(row_) * (1 - weight_) + of_row(row_ + 1) * weight_;
  }

  const SheenAlbedoTable* table_ = nullptr;
  double inverse_alpha_ = 1, weight_ = 0;
  int row_ = 0;
};

}  // namespace holotrace
