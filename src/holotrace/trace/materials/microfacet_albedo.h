#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace holotrace {

/// Directional albedos of the GGX reflection lobe (microfacet.h), against √cosθ_o (columns) and roughness √α (rows).
struct MicrofacetAlbedoTable {
  static constexpr int size = 32;
  struct Entry {
    float loss;     ///< 1 − ∫f·cosθ_i dω for white microfacets: the loss of single scattering
    float schlick;  ///< ∫f·cosθ_i dω for microfacets of reflectance (1 − o·h)⁵
  };
  std::array<std::array<Entry, size>, size> entries;
  std::array<Entry, size> means;  ///< means 2·∫·cosθ_o d(cosθ_o) of the linear interpolation between entries
};

/// 2·∫E·μ dμ = 4·∫E·s³ ds, μ = s², of a function of s that is linear between its values at `size` even steps from 0
/// to 1; with `end`, only the part below the value `end`. The three-point Gauss rule is exact for it.
template <class Function>
double mean_over_hemisphere(int size, int end, const Function& value) {
  constexpr double nodes[] = {0.1127016653792583, 0.5, 0.8872983346207417}, weights[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  double sum = 0;
  for (int i = 0; i < end; ++i)
    for (int j = 0; j < 3; ++j) {
      const double s = (i + nodes[j]) / (size - 1), t = nodes[j];
      sum += 4 * s * s * s * weights[j] / (size - 1) * (double(value(i)) * (1 - t) + double(value(i + 1)) * t);
    }
  return sum;
}

template <class Function>
double mean_over_hemisphere(int size, const Function& value) {
  return mean_over_hemisphere(size, size - 1, value);
}

/// The table, computed on the first call (0.1 s). Any number of threads may call.
const MicrofacetAlbedoTable& microfacet_albedo_table();

/// The albedos at one roughness, linear between entries. The mean is that of the interpolated values, so an energy
/// balance computed with it is exact.
class MicrofacetAlbedo {
 public:
  MicrofacetAlbedo() = default;

  /// @param alpha  α of the GGX distribution, in [0, 1]
  explicit MicrofacetAlbedo(double alpha) : table_(&microfacet_albedo_table()) {
    const double x = std::sqrt(alpha) * (MicrofacetAlbedoTable::size - 1);
    row_ = std::clamp(int(x), 0, MicrofacetAlbedoTable::size - 2);
    weight_ = x - row_;
  }

  struct Value {
    double loss = 0, schlick = 0;
    /// Albedo of microfacets with Schlick's reflectance, f0 at normal incidence.
    double reflected(double f0) const { return f0 * (1 - loss) + (1 - f0) * schlick; }
  };

  /// The albedos at a cosine in [0, 1].
  Value at(double cosine) const {
    const double x = std::sqrt(cosine) * (MicrofacetAlbedoTable::size - 1);
    const int column = std::clamp(int(x), 0, MicrofacetAlbedoTable::size - 2);
    const auto &low = table_->entries[size_t(row_)], &high = table_->entries[size_t(row_) + 1];
    const Value a = between(low[size_t(column)], high[size_t(column)]);
    const Value b = between(low[size_t(column) + 1], high[size_t(column) + 1]);
    const double t = x - column;
    return {a.loss + t * (b.loss - a.loss), a.schlick + t * (b.schlick - a.schlick)};
  }

  /// The cosine-weighted mean over the hemisphere.
  Value mean() const { return between(table_->means[size_t(row_)], table_->means[size_t(row_) + 1]); }

 private:
  Value between(MicrofacetAlbedoTable::Entry a, MicrofacetAlbedoTable::Entry b) const {
    return {a.loss + weight_ * (b.loss - a.loss), a.schlick + weight_ * (b.schlick - a.schlick)};
  }

  const MicrofacetAlbedoTable* table_ = nullptr;
  int row_ = 0;
  double weight_ = 0;
};

}  // namespace holotrace
