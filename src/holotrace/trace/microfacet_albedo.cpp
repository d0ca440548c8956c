#include "holotrace/trace/microfacet_albedo.h"

#include "holotrace/trace/fresnel.h"
#include "holotrace/trace/microfacet.h"

namespace holotrace {

namespace {

using Table = MicrofacetAlbedoTable;

/// Means over the visible microfacet normals: of the weight G₂/G₁ of sampling them, and of that times (1 − o·h)⁵.
Table::Entry integrate(double cosine, double alpha) {
  constexpr int azimuths = 24, heights = 32;  // midpoints; the two halves of the azimuth are alike
  const Vec3 outgoing{std::sqrt(1 - cosine * cosine), 0, cosine};
  const double masking = smith_masking(outgoing, alpha);
  double loss = 0, schlick = 0;
  for (int i = 0; i < azimuths; ++i)
    for (int j = 0; j < heights; ++j) {
      const Vec3 h = sample_visible_normal(outgoing, alpha, {0.5 * (i + 0.5) / azimuths, (j + 0.5) / heights});
      const double cosine_h = dot(outgoing, h);
      const Vec3 incoming = 2 * cosine_h * h - outgoing;
      const double weight = incoming.z > 0 ? smith_masking_shadowing(outgoing, incoming, alpha) / masking : 0;
      loss += 1 - weight;
      schlick += weight * schlick_weight(cosine_h);
    }
  return {float(loss / (azimuths * heights)), float(schlick / (azimuths * heights))};
}

/// 2∫E·μ dμ = 4∫E·s³ ds with μ = s²: Gauss's rule of three points is exact where E is straight in s.
Table::Entry mean_of(const std::array<Table::Entry, Table::size>& row) {
  constexpr double nodes[] = {0.1127016653792583, 0.5, 0.8872983346207417}, weights[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  double loss = 0, schlick = 0;
  for (int i = 0; i + 1 < Table::size; ++i)
    for (int j = 0; j < 3; ++j) {
      const double s = (i + nodes[j]) / (Table::size - 1), t = nodes[j];
      const double weight = 4 * s * s * s * weights[j] / (Table::size - 1);
      loss += weight * (row[size_t(i)].loss * (1 - t) + row[size_t(i) + 1].loss * t);
      schlick += weight * (row[size_t(i)].schlick * (1 - t) + row[size_t(i) + 1].schlick * t);
    }
  return {float(loss), float(schlick)};
}

Table make_table() {
  Table table;
  for (int row = 0; row < Table::size; ++row) {
    const double roughness = double(row) / (Table::size - 1);
    const double alpha = std::fmax(smooth_alpha, roughness * roughness);
    for (int column = 0; column < Table::size; ++column) {
      const double s = double(column) / (Table::size - 1);
      table.entries[size_t(row)][size_t(column)] = integrate(std::fmax(1e-6, s * s), alpha);
    }
    table.means[size_t(row)] = mean_of(table.entries[size_t(row)]);
  }
  return table;
}

}  // namespace

const MicrofacetAlbedoTable& microfacet_albedo_table() {
  static const Table table = make_table();
  return table;
}

}  // namespace holotrace
