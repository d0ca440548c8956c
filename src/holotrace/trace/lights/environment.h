#pragma once

#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/shared/lines.h"

namespace holotrace {

/// Where a unit direction lies on an equirectangular map, both in [0, 1]: x from its left to its right, y from its top
/// (+y) down; and back. `turn` [rad] turns the map about +y. The map's middle is −z, its right half +x.
Vec2 environment_place(Vec3 direction, double turn);
Vec3 environment_direction(Vec2 place, double turn);

/// Light from infinitely far away, drawn in proportion to it.
///
/// Radiance is bilinear between pixel centres, around the map, and constant toward the poles. Pixel p, of the solid
/// angle Ωₚ = 2π/nx·(cosθ₀ − cosθ₁), is drawn with Pₚ ∝ Ωₚ·L̄ₚ, L̄ₚ the mean of the radiance over it, summed over the
/// lines; a direction in it evenly: pdf = Pₚ/Ωₚ.
///
/// Reference: M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering, 4th ed., section 12.5.
/// Memory: 12 bytes per pixel. Keeps the map alive.
class EnvironmentLight {
 public:
  EnvironmentLight(const Environment& environment, const Lines& lines);

  /// At the lines [W/m²/sr], along a unit direction.
  Vec3 radiance(Vec3 direction) const;

  /// Draws a direction by two numbers in [0, 1); radiance 0 where the whole map is black.
  LightSample sample(Vec2 u) const;

  /// Its density over solid angle [1/sr].
  double pdf(Vec3 direction) const;

 private:
  Vec3 pixel(int row, int column) const;
  Vec3 radiance_at(Vec2 place) const;

  Environment environment_;
  Lines lines_;
  int nx_, ny_;
  double total_ = 0;                // Σ Ω·L̄
  std::vector<double> rows_;        // cumulative share of the rows, the last 1
  std::vector<float> means_;        // L̄ of the pixels
  std::vector<double> cumulative_;  // share of L̄ along each row, its last 1
};

}  // namespace holotrace
