#pragma once

#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/shared/lines.h"

namespace holotrace {

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

  Environment environment_;
  Lines lines_;
  int nx_, ny_;
  double total_ = 0;                // Σ Ω·L̄
  std::vector<double> rows_;        // cumulative share of the rows, the last one 1
  std::vector<float> means_;        // L̄ of each pixel
  std::vector<double> cumulative_;  // cumulative share of L̄ along each row, its last one 1
};

}  // namespace holotrace
