#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/lights/sky.h"
#include "holotrace/trace/shared/ray.h"

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

/// Position of a unit direction on an equirectangular map, both coordinates in [0, 1]: x from left to right, y from the
/// top (+y) down; and the inverse. `turn` [rad] rotates the map about +y. The map's middle is −z, its right half +x.
Vec2 environment_place(Vec3 direction, double turn);
Vec3 environment_direction(Vec2 place, double turn);

/// Light from infinitely far away, with directions drawn in proportion to its radiance.
///
/// Radiance is interpolated bilinearly between pixel centres, wraps around the map, and is constant toward the poles.
/// Pixel p of solid angle Ωₚ = 2π/nx·(cosθ₀ − cosθ₁) is drawn with Pₚ ∝ Ωₚ·L̄ₚ. L̄ₚ is the mean of its radiance, summed
/// over the lines. A direction in the pixel is drawn evenly: pdf = Pₚ/Ωₚ.
///
/// A sky (sky.h) takes the place of the map. Its radiance comes from its formulas; its pixels, of 1.4°, serve to draw
/// directions. The disc of the sun is drawn as often as its share of the irradiance across the light's directions.
///
/// Reference: M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering, 4th ed., section 12.5.
/// Memory: 12 bytes per pixel. Keeps a pointer to the map.
class EnvironmentLight {
 public:
  EnvironmentLight(const Environment& environment, const Lines& lines);

  /// Radiance at the lines along a unit direction [W/m²/sr].
  Vec3 radiance(Vec3 direction) const;

  /// Draws a direction from two numbers in [0, 1); the radiance is 0 if the whole map is black.
  LightSample sample(Vec2 u) const;

  /// Density over solid angle with which `sample` draws the direction [1/sr].
  double pdf(Vec3 direction) const;

 private:
  Vec3 pixel(int row, int column) const;
  Vec3 radiance_at(Vec2 place) const;
  double pixel_pdf(Vec3 direction) const;

  Environment environment_;
  Lines lines_;
  std::optional<SkyModel> sky_;
  Vec3 scale_;  // at the lines
  double sun_share_ = 0;
  int nx_, ny_;
  double total_ = 0;                // Σ Ω·L̄
  std::vector<double> rows_;        // cumulative share of the rows, the last one 1
  std::vector<float> means_;        // L̄ of each pixel
  std::vector<double> cumulative_;  // cumulative share of L̄ along each row, its last one 1
};

/// All emitters of a scene, prepared for sampling. Light groups are numbered: the lights of Scene::lights in
/// their order, then the meshes that emit (together), then background and environment (together). Keeps a reference to
/// the scene.
class Emitters {
 public:
  Emitters(const Scene& scene, const Lines& lines);

  int groups() const { return int(lights_.size()) + 2; }
  int mesh_group() const { return int(lights_.size()); }
  int background_group() const { return mesh_group() + 1; }

  /// Name of a group's separate hologram: "light 0", …, "emission", "background".
  std::string group_name(int group) const;

  /// Scene::lights; their strengths are at the lines instead of red, green and blue.
  const std::vector<Light>& lights() const { return lights_; }

  /// The emitting triangles.
  const EmissiveTriangles& triangles() const { return triangles_; }
  bool is_emissive(int material) const { return is_emissive_[size_t(material)]; }

  /// The environment map, if there is one.
  const EnvironmentLight* environment() const { return environment_ ? &*environment_ : nullptr; }

  /// Radiance from infinitely far away along a unit direction, at the lines [W/m²/sr]: background and environment.
  Vec3 background(Vec3 direction) const {
    return environment_ ? background_ + environment_->radiance(direction) : background_;
  }
  /// Radiance of the background alone, the same in every direction [W/m²/sr].
  Vec3 even_background() const { return background_; }

  /// Whether a ray that meets no further mesh can find light from the background, the environment or a light with an
  /// area.
  bool shine_beyond_surfaces() const { return shine_beyond_surfaces_; }

  /// Whether a ray can find light elsewhere than at a surface: of the background, the environment or lights_on_way.
  bool shine_on_way() const { return shine_on_way_; }

  /// Lights with an area that rays meet and pass through, as indices into lights(). Visible ones are surfaces.
  const std::vector<int>& lights_on_way() const { return lights_on_way_; }

 private:
  std::vector<Light> lights_;
  EmissiveTriangles triangles_;
  std::vector<char> is_emissive_;  // index: material
  std::optional<EnvironmentLight> environment_;
  Vec3 background_;
  std::vector<int> lights_on_way_;
  bool shine_beyond_surfaces_, shine_on_way_;
};

}  // namespace holotrace
