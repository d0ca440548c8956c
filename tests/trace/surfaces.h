#pragma once

#include <complex>
#include <string>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/trace/materials/bsdf.h"

// BSDFs of every kind at a point of the plane z = 0, seen from z > 0.

namespace holotrace {

/// Angles from the normal [degrees].
inline constexpr double view_angles[] = {0, 45, 80};
inline constexpr double roughnesses[] = {0.25, 0.55, 0.8, 1};

inline Vec3 view_direction_at(double degrees) {
  const double angle = degrees * pi / 180, turn = 0.4;
  return {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle)};
}

/// A point whose normals are +z, with texture coordinates along x and y as seen from the front.
inline SurfacePoint flat_point(bool is_front = true) {
  SurfacePoint point;
  point.geometric_normal = point.normal = {0, 0, 1};
  point.uv = {0.5, 0.5};
  point.tangent_u = {1, 0, 0};
  point.tangent_v = {0, is_front ? 1.0 : -1.0, 0};
  point.is_front = is_front;
  return point;
}

struct NamedSurface {
  std::string name;
  Bsdf bsdf;
  double alpha = 1;  ///< α of its narrowest lobe
};

inline NamedSurface named(std::string name, const Material& material, double roughness = 1,
                          const SurfacePoint& point = flat_point()) {
  return {name + " of roughness " + std::to_string(roughness), make_bsdf(material, point, Lines{}),
          roughness * roughness};
}

inline std::vector<NamedSurface> diffuse_surfaces() {
  DiffuseMaterial paper{.reflectance = {0.6, 0.5, 0.1}, .transmittance = {0.3, 0.2, 0.1}};
  return {named("grey", DiffuseMaterial{}), named("paper", paper)};
}

inline std::vector<NamedSurface> conductor_surfaces() {
  std::vector<NamedSurface> all;
  for (double roughness : roughnesses)
    all.push_back(named("gold", ConductorMaterial{metal_index("Au"), roughness}, roughness));
  SurfacePoint leaning = flat_point();
  leaning.normal = normalize({0.3, -0.2, 1});  // some directions then fall below the triangle
  all.push_back(named("leaning silver", ConductorMaterial{metal_index("Ag"), 0.8}, 0.8, leaning));
  return all;
}

inline std::vector<NamedSurface> dielectric_surfaces() {
  std::vector<NamedSurface> all;
  for (double roughness : roughnesses) {
    const DielectricMaterial glass{constant_index(1.5), roughness};
    all.push_back(named("glass", glass, roughness));
    all.push_back(named("glass from inside", glass, roughness, flat_point(false)));
  }
  SurfacePoint leaning = flat_point();
  leaning.normal = normalize({0.3, -0.2, 1});
  all.push_back(named("leaning diamond", DielectricMaterial{glass_index("diamond"), 0.8}, 0.8, leaning));
  return all;
}

inline std::vector<NamedSurface> metallic_surfaces() {
  std::vector<NamedSurface> all;
  for (double roughness : roughnesses)
    for (double metallic : {0.0, 0.5, 1.0}) {
      const MetallicRoughnessMaterial paint{
          .base_color = {0.8, 0.5, 0.2}, .metallic = metallic, .roughness = roughness};
      all.push_back(named("metallic " + std::to_string(metallic), paint, roughness));
    }
  all.push_back(named("varnish", MetallicRoughnessMaterial{.metallic = 0, .roughness = 0}));
  return all;
}

inline std::vector<NamedSurface> specular_surfaces() {
  return {named("mirror", ConductorMaterial{}),
          named("gold mirror", ConductorMaterial{metal_index("Au")}),
          named("glass", DielectricMaterial{}),
          named("glass from inside", DielectricMaterial{}, 1, flat_point(false)),
          named("pane", DielectricMaterial{.is_thin = true}),
          named("varnish", MetallicRoughnessMaterial{.metallic = 0, .roughness = 0}),
          named("red mirror", MetallicRoughnessMaterial{.base_color = {0.9, 0.1, 0.1}, .roughness = 0})};
}

inline std::vector<NamedSurface> all_surfaces() {
  std::vector<NamedSurface> all;
  for (const auto& some :
       {diffuse_surfaces(), conductor_surfaces(), dielectric_surfaces(), metallic_surfaces(), specular_surfaces()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

/// Materials of every kind and roughness, the limits included.
inline std::vector<Material> sample_materials() {
  std::vector<Material> all{DiffuseMaterial{}, DielectricMaterial{.is_thin = true}};
  for (double roughness : {0.0, 0.0099, 0.0101, 0.1, 0.5, 1.0}) {
    all.push_back(ConductorMaterial{metal_index("Cu"), roughness});
    all.push_back(DielectricMaterial{glass_index("diamond"), roughness});
    for (double metallic : {0.0, 0.5, 1.0})
      all.push_back(MetallicRoughnessMaterial{.metallic = metallic, .roughness = roughness});
  }
  return all;
}

}  // namespace holotrace
