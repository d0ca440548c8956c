#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/shared/lines.h"

namespace holotrace {

/// The triangles of a scene that shine, to be drawn in proportion to what they send out.
///
///     P(t) ∝ Aₜ·(L̄ₜ + L̄/20),   density over solid angle: P(t)/Aₜ · d²/cosθ'
///
/// A is the area, L̄ₜ the emission (texture included) averaged over 16 places of the triangle and summed over the lines,
/// L̄ that of its whole material, so that a triangle whose bright spots lie between the places has its share. Memory: 32
/// bytes per triangle that shines. Keeps a reference to the scene.
class EmissiveTriangles {
 public:
  EmissiveTriangles(const Scene& scene, const Lines& lines);

  bool is_empty() const { return triangles_.empty(); }

  /// Draws a way from the point `from` [m] to a place evenly over the triangle that u_triangle draws; numbers in
  /// [0, 1). Radiance at the lines, 0 from behind a one-sided surface. O(log n).
  LightSample sample(Vec3 from, double u_triangle, Vec2 u) const;

  /// The density over solid angle [1/sr] with which `sample` draws a place that a ray has met at a distance [m] and at
  /// |cosθ'| to its normal.
  double pdf(uint32_t mesh, uint32_t triangle, double distance, double cosine) const {
    const auto& densities = densities_[mesh];
    return densities.empty() ? 0 : double(densities[triangle]) * distance * distance / cosine;
  }

 private:
  struct Triangle {
    uint32_t mesh, index;
  };
  const Scene& scene_;
  Lines lines_;
  std::vector<Triangle> triangles_;
  std::vector<double> cumulative_;             // of P(t), the last one 1
  std::vector<std::vector<float>> densities_;  // P(t)/A [1/m²] by mesh and triangle, none for a dark mesh
};

}  // namespace holotrace
