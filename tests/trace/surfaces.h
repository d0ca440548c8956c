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

/// Layered surfaces, each with one layer on a base of that roughness, and one with all of them.
inline std::vector<std::pair<std::string, PrincipledMaterial>> layered_materials(double roughness) {
  std::vector<std::pair<std::string, PrincipledMaterial>> all;
  PrincipledMaterial base;
  base.base_color.value = {0.8, 0.5, 0.2};
  base.roughness.value = roughness;
  const auto add = [&](const char* name, const auto& change) {
    PrincipledMaterial material = base;
    change(material);
    all.emplace_back(name, material);
  };
  const auto coat = [](PrincipledMaterial& m) { m.clearcoat.value = 0.8, m.clearcoat_roughness.value = 0.4; };
  const auto sheen = [](PrincipledMaterial& m) {
    m.sheen_color.value = {0.9, 0.3, 0.5}, m.sheen_roughness.value = 0.4;
  };
  const auto brushed = [](PrincipledMaterial& m) { m.metalness.value = 0.7, m.anisotropy.value = 0.6; };
  const auto film = [](PrincipledMaterial& m) { m.metalness.value = 0.3, m.iridescence.value = 0.7; };
  add("plain", [](PrincipledMaterial&) {});
  add("half metal", [](PrincipledMaterial& m) { m.metalness.value = 0.5; });
  add("coat", coat);
  add("smooth coat", [](PrincipledMaterial& m) { m.clearcoat.value = 1; });
  add("sheen", sheen);
  add("brushed", brushed);
  add("film", film);
  add("leaf", [](PrincipledMaterial& m) { m.diffuse_transmission = {0.6}; });
  add("sheet", [](PrincipledMaterial& m) { m.transmission.value = 0.7, m.is_thin = true; });
  add("all",
      [&](PrincipledMaterial& m) { coat(m), sheen(m), brushed(m), film(m), m.diffuse_transmission.value = 0.4; });
  add("solid", [](PrincipledMaterial& m) { m.transmission.value = 0.7; });
  return all;
}

/// Those that have all parts between them.
inline std::vector<NamedSurface> principled_surfaces(double roughness = 0.5) {
  std::vector<NamedSurface> all;
  for (const auto& [name, material] : layered_materials(roughness))
    if (name == "sheet" || name == "all" || name == "solid") all.push_back(named(name, material, roughness));
  all.push_back(named("solid from inside", layered_materials(roughness).back().second, roughness, flat_point(false)));
  SurfacePoint leaning = flat_point();
  leaning.normal = normalize({0.3, -0.2, 1});
  all.push_back(named("leaning layers", layered_materials(roughness)[9].second, roughness, leaning));
  return all;
}

/// Smooth layers: specular, with or without a diffuse lobe.
inline std::vector<NamedSurface> smooth_layers() {
  std::vector<NamedSurface> all;
  for (const auto& [name, material] : layered_materials(0))
    if (name != "brushed" && name != "all" && name != "coat") all.push_back(named("smooth " + name, material));
  all.push_back(named("smooth solid from inside", layered_materials(0).back().second, 1, flat_point(false)));
  return all;
}

inline std::vector<NamedSurface> specular_surfaces() {
  return {named("mirror", ConductorMaterial{}),
          named("gold mirror", ConductorMaterial{metal_index("Au")}),
          named("glass", DielectricMaterial{}),
          named("glass from inside", DielectricMaterial{}, 1, flat_point(false)),
          named("pane", DielectricMaterial{.is_thin = true}),
          named("polariser", FilterMaterial{.axis = {0.6, 0.8, 0}, .leakage = 0.1}),
          named("varnish", MetallicRoughnessMaterial{.metallic = 0, .roughness = 0}),
          named("red mirror", MetallicRoughnessMaterial{.base_color = {0.9, 0.1, 0.1}, .roughness = 0})};
}

/// Particles of media.
inline std::vector<NamedSurface> scatterers() {
  std::vector<NamedSurface> all;
  for (const double g : {-0.6, 0.0, 0.3, 0.9})
    all.push_back(named("particles of g = " + std::to_string(g), ScatteringMaterial{{0.9, 0.5, 0.2}, g}));
  all.push_back(named("droplets", ScatteringMaterial{.albedo = {0.9, 0.5, 0.2}, .droplet_radius = 1e-6}));
  return all;
}

inline std::vector<NamedSurface> all_surfaces() {
  std::vector<NamedSurface> all;
  for (const auto& some : {diffuse_surfaces(), conductor_surfaces(), dielectric_surfaces(), metallic_surfaces(),
                           specular_surfaces(), principled_surfaces(), smooth_layers()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

/// Materials of every kind and roughness, the limits included.
inline std::vector<Material> sample_materials() {
  std::vector<Material> all{DiffuseMaterial{}, DielectricMaterial{.is_thin = true}, FilterMaterial{}};
  for (double roughness : {0.0, 0.0099, 0.0101, 0.1, 0.5, 1.0}) {
    all.push_back(ConductorMaterial{metal_index("Cu"), roughness});
    all.push_back(DielectricMaterial{glass_index("diamond"), roughness});
    for (double metallic : {0.0, 0.5, 1.0})
      all.push_back(MetallicRoughnessMaterial{.metallic = metallic, .roughness = roughness});
    if (roughness != 0.0099 && roughness != 0.1 && roughness != 1)
      for (const auto& [name, material] : layered_materials(roughness)) all.push_back(material);
  }
  return all;
}

}  // namespace holotrace
