#include "holotrace/trace/materials/microfacet.h"

#include "holotrace/trace/materials/fresnel.h"

namespace holotrace {
namespace {

using Table = MicrofacetAlbedoTable;

/// Means over the visible microfacet normals of two quantities: the sampling weight G₂/G₁, and this times (1 − o·h)⁵.
Table::Entry integrate(double cosine, double alpha) {
  const Vec3 outgoing{std::sqrt(1 - cosine * cosine), 0, cosine};
  const double masking = smith_masking(outgoing, alpha);
  const Vec3 sum = mean_over_visible_normals<16>(outgoing, alpha, [&](Vec3 h) {
    const double cosine_h = dot(outgoing, h);
    const Vec3 incoming = 2 * cosine_h * h - outgoing;
    const double weight = incoming.z > 0 ? smith_masking_shadowing(outgoing, incoming, alpha) / masking : 0;
    return Vec3{1 - weight, weight * schlick_weight(cosine_h), 0};
  });
  return {float(sum.x), float(sum.y)};
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
    const auto& entries = table.entries[size_t(row)];
    table.means[size_t(row)] = {
        float(mean_over_hemisphere(Table::size, [&](int i) { return entries[size_t(i)].loss; })),
        float(mean_over_hemisphere(Table::size, [&](int i) { return entries[size_t(i)].schlick; }))};
  }
  return table;
}

}  // namespace

const MicrofacetAlbedoTable& microfacet_albedo_table() {
  static const Table table = make_table();
  return table;
}

}  // namespace holotrace
