#pragma once

#include <algorithm>
#include <variant>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/sampling.h"
#include "holotrace/trace/texture.h"

// What surfaces do to light. To add a material: give its struct a place in data/scene.h, write
// its four functions here beside those of DiffuseMaterial, and std::visit finds them.

namespace holotrace {

/// A point of a surface as a material sees it. Normals are unit vectors on the side that the path
/// came from.
struct SurfacePoint {
  Vec3 position;          ///< [m]
  Vec3 geometric_normal;  ///< of the triangle
  Vec3 normal;            ///< interpolated, for shading
  Vec2 uv;
  int material = 0;  ///< index into Scene::materials
};

/// A direction drawn by a material.
struct MaterialSample {
  Vec3 direction;  ///< unit, away from the surface
  Vec3 weight;     ///< f·|cosθ|/pdf in red, green, blue; 0: the path ends here
};

// --- Lambertian surfaces: f = ρ/π on both sides -------------------------------------------------

/// Albedo ρ = reflectance · texture, held to [0, 1] so that no surface makes light.
inline Vec3 albedo(const DiffuseMaterial& material, Vec2 uv) {
  Vec3 rho = material.reflectance;
  if (material.texture) {
    const Vec3 texture = eval_texture(*material.texture, uv);
    rho = {rho.x * texture.x, rho.y * texture.y, rho.z * texture.z};
  }
  return {std::clamp(rho.x, 0.0, 1.0), std::clamp(rho.y, 0.0, 1.0), std::clamp(rho.z, 0.0, 1.0)};
}

/// f·cosθ toward a unit direction [1/sr]; 0 for light from behind the triangle.
inline Vec3 eval(const DiffuseMaterial& material, const SurfacePoint& point, Vec3 direction) {
  if (dot(point.geometric_normal, direction) <= 0) return {};
  return albedo(material, point.uv) * pdf_cosine(point.normal, direction);
}

/// Density of `sample` [1/sr].
inline double pdf(const DiffuseMaterial&, const SurfacePoint& point, Vec3 direction) {
  return pdf_cosine(point.normal, direction);
}

/// Draws by cosθ/π, so that f·cosθ/pdf = ρ.
inline MaterialSample sample(const DiffuseMaterial& material, const SurfacePoint& point, CounterRandom& random) {
  const double u = random.uniform(), v = random.uniform();
  const Vec3 direction = sample_cosine(point.normal, u, v);
  if (dot(point.geometric_normal, direction) <= 0) return {direction, {}};
  return {direction, albedo(material, point.uv)};
}

inline Vec3 emission(const DiffuseMaterial& material) { return material.emission; }

// --- any material -------------------------------------------------------------------------------

/// f·|cosθ| of a material toward a unit direction [1/sr], in red, green, blue.
inline Vec3 eval_material(const Material& material, const SurfacePoint& point, Vec3 direction) {
  return std::visit([&](const auto& m) { return eval(m, point, direction); }, material);
}

/// Density with which sample_material draws a direction [1/sr].
inline double pdf_material(const Material& material, const SurfacePoint& point, Vec3 direction) {
  return std::visit([&](const auto& m) { return pdf(m, point, direction); }, material);
}

/// Draws the direction in which a path goes on.
inline MaterialSample sample_material(const Material& material, const SurfacePoint& point, CounterRandom& random) {
  return std::visit([&](const auto& m) { return sample(m, point, random); }, material);
}

/// Radiance that a surface sends out by itself, on both sides [W/m²/sr].
inline Vec3 eval_emission(const Material& material) {
  return std::visit([](const auto& m) { return emission(m); }, material);
}

}  // namespace holotrace
