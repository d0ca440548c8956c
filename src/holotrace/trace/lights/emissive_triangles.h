#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/lights/light_lanes.h"
#include "holotrace/trace/shared/lines.h"

namespace holotrace {

/// The emitting triangles of a scene, drawn with a probability that follows their emitted power.
///
///     P(t) ∝ Aₜ·(L̄ₜ + L̄/20),   density over solid angle: P(t)/Aₜ · d²/cosθ'
///
/// Aₜ is the area. L̄ₜ is the emission (with texture) averaged over 16 places of the triangle, summed over the lines.
/// L̄ is the mean of its whole material; with it, triangles whose bright spots lie between the places are drawn too.
/// Memory: 136 bytes per emitting triangle. Keeps a reference to the scene.
class EmissiveTriangles {
 public:
  EmissiveTriangles(const Scene& scene, const Lines& lines);

  bool is_empty() const { return triangles_.empty(); }

  /// Draws a direction from the point `from` [m] by two numbers in [0, 1). u.x selects a triangle, and its place between
  /// the bounds of that triangle is used again: samples that fill the square evenly also fill the emitting surface evenly.
  /// The sample holds the radiance at the lines, 0 from behind a one-sided surface. The triangle is found by cutpoints, in
  /// constant time on average (H.-C. Chen and Y. Asau, AIIE Transactions 6, 163, 1974).
  LightSample sample(Vec3 from, Vec2 u) const;

  /// Whether the radiance of each triangle is even: no emission has a texture.
  bool are_even() const { return !has_texture_; }

  /// Selects a triangle for path i, and a place on it, as `sample` does, if the triangles are even.
  void select(Vec2 u, size_t i, LightLanes& lanes, PlaceLanes& places) const;

  /// Density over solid angle [1/sr] with which `sample` draws a place that a ray has met, for its distance [m] and
  /// |cosθ'| to the surface normal.
  double pdf(uint32_t mesh, uint32_t triangle, double distance, double cosine) const {
    const auto& densities = densities_[mesh];
    return densities.empty() ? 0 : double(densities[triangle]) * distance * distance / cosine;
  }

 private:
  struct Triangle {
    uint32_t mesh, index;
    Vec3 corner, edge_u, edge_v;  // [m]
    double per_twice_area;        // 1/(2A) [1/m²]
    double longest;               // of the sides [m]
    double density;               // P(t)/A [1/m²]
    double first, end;            // the numbers in [0, 1) that select it
    double per_probability;       // 1/(end − first)
  };
  Vec3 radiance_of(const Triangle& triangle, bool is_front, double b1, double b2) const;
  const Triangle& selected_by(double u) const;
  static double place_in(const Triangle& triangle, double u) {
    return std::clamp((u - triangle.first) * triangle.per_probability, 0.0, 1.0);
  }

  const Scene& scene_;
  Lines lines_;
  std::vector<Triangle> triangles_;
  std::vector<uint32_t> cutpoints_;            // the triangle that the number i/n selects, for n triangles
  std::vector<std::vector<float>> densities_;  // P(t)/A [1/m²] by mesh and triangle; empty for a dark mesh
  std::vector<Vec3> radiances_;                // index: material; without the texture
  bool has_texture_ = false;
};

}  // namespace holotrace
