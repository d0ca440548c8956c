#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/image.h"
#include "holotrace/data/refractive_index.h"

namespace holotrace {

/// Diffuse reflection on both sides and, for thin things such as paper or leaves, diffuse transmission:
/// BRDF = reflectance/π, BTDF = transmittance/π.
struct DiffuseMaterial {
  Vec3 reflectance{0.8, 0.8, 0.8};         ///< albedo ρ in red, green, blue, each in [0, 1]
  std::shared_ptr<const Image> texture{};  ///< multiplies both where present (linear light)
  Vec3 transmittance{0, 0, 0};             ///< to the other side, each in [0, 1], with the reflectance at most 1
};

/// A metal: reflection by Fresnel's equations with a complex index, off a surface of GGX microfacets.
struct ConductorMaterial {
  RefractiveIndex index = metal_index("Ag");  ///< n + ik
  double roughness = 0;                       ///< GGX α = roughness²; 0: a mirror
};

/// Glass, water, crystal: reflection and refraction. The mesh is closed, its triangles counter-clockwise as seen from
/// outside; rays enter on that side. A thin one is a smooth pane: light goes straight through, reflected at both faces.
struct DielectricMaterial {
  RefractiveIndex index = constant_index(1.5);  ///< n, k = 0
  double roughness = 0;                         ///< GGX α = roughness²; 0: smooth
  bool is_thin = false;
};

/// The metallic-roughness model of glTF 2.0: a mix of a coloured metal and a dielectric coat of F₀ = 0.04 over a
/// diffuse base.
struct MetallicRoughnessMaterial {
  Vec3 base_color{1, 1, 1};                         ///< of the diffuse base, or F₀ of the metal
  std::shared_ptr<const Image> base_texture{};      ///< multiplies it (linear light)
  double metallic = 1, roughness = 1;               ///< each in [0, 1]; GGX α = roughness²
  std::shared_ptr<const Image> metallic_texture{};  ///< multiplies: roughness in green, metallic in blue
};

/// What a surface does to light, and the light that it sends out by itself. To add a material: see CONTRIBUTING.md.
struct Material {
  using Surface = std::variant<DiffuseMaterial, ConductorMaterial, DielectricMaterial, MetallicRoughnessMaterial>;
  Surface surface;
  Vec3 emission{0, 0, 0};                           ///< radiance [W/m²/sr]
  std::shared_ptr<const Image> emission_texture{};  ///< multiplies it (linear light)
  std::shared_ptr<const Image> normal_map{};  ///< tangent space, glTF's: red to +u, green to +v, [0, 1] for [−1, 1]
  double normal_scale = 1;                    ///< stretches the x and y of the map
  /// One-sided surfaces are black from behind: triangles are counter-clockwise as seen from their front. The back of a
  /// solid dielectric is its inside and never black.
  bool two_sided = true;

  Material() = default;
  template <class S>
  requires std::constructible_from<Surface, S> Material(S surface, Vec3 emission = {})
      : surface(std::move(surface)), emission(emission) {}
};

/// Triangles of one material.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;                     ///< [m]
  std::vector<Vec3> normals;                       ///< unit, one per position, or empty: flat shading
  std::vector<Vec2> texture_coordinates;           ///< (u, v), v up, one per position, or empty
  std::vector<Vec3> colours;                       ///< linear, one per position, or empty; multiply the base colour
  std::vector<std::array<uint32_t, 3>> triangles;  ///< indices into positions
  int material = 0;                                ///< index into Scene::materials
};

/// Light that leaves a point evenly in all directions. A laser's is coherent: phases follow its path.
struct PointLight {
  Vec3 position;   ///< [m]
  Vec3 intensity;  ///< [W/sr]
  bool is_laser = false;
};

/// A point light in a cone: full intensity to inner_angle off its axis, none past outer_angle, smooth between.
struct SpotLight {
  Vec3 position;                            ///< [m]
  Vec3 direction;                           ///< unit, the way the light goes
  Vec3 intensity;                           ///< on the axis [W/sr]
  double inner_angle = 0, outer_angle = 0;  ///< half angles [rad], 0 ≤ inner ≤ outer ≤ π
};

/// Parallel light: the sun, or the beam of a laser, which has a round section and a phase.
struct DirectionalLight {
  Vec3 direction;          ///< unit, the way the light goes
  Vec3 irradiance;         ///< across it [W/m²]
  Vec3 position{0, 0, 0};  ///< on the axis of the beam [m]; the phase of a laser is 0 in the plane through it
  double radius = std::numeric_limits<double>::infinity();  ///< of the beam [m]
  bool is_laser = false;
};

/// A rectangle corner + s·edge_u + t·edge_v that shines from the side edge_u × edge_v points to. A visible one is a
/// surface, black but for its light: it is seen, and hides what is behind it. One that is not visible lights the scene
/// and is seen in reflections, but neither from the panel nor in the way of any light.
struct RectangleLight {
  Vec3 corner, edge_u, edge_v;  ///< [m]
  Vec3 radiance;                ///< [W/m²/sr]
  bool is_visible = true;
};

/// What sends light beside the meshes that emit. Further lights join this list.
using Light = std::variant<PointLight, SpotLight, DirectionalLight, RectangleLight>;

/// The light from infinitely far away: radiance = scale·map, the map being equirectangular: its middle column
/// shows what lies toward −z (behind the scene), its right half toward +x, its top row +y.
struct Environment {
  std::shared_ptr<const Image> map{};  ///< linear light
  Vec3 scale{1, 1, 1};                 ///< [W/m²/sr] per unit of the map
  double turn = 0;                     ///< of the map about +y, right-handed [rad]
};

/// A luminous point that is a source by itself, as bright as a surface of radiance amplitude² (point_strength.h).
struct ScenePoint {
  Vec3 position;        ///< [m]
  float amplitude = 1;  ///< root of its radiance [√(W/m²/sr)]
  float phase = 0;      ///< [rad], added to what TraceParams::phase gives
};

/// Geometry in the panel's frame: origin at its centre, x right, y up, z toward the viewer; the
/// scene stands at z < 0.
struct Scene {
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Light> lights;
  std::vector<ScenePoint> points;
  Vec3 background{0, 0, 0};                ///< radiance where a ray leaves the scene [W/m²/sr]
  std::optional<Environment> environment;  ///< the same from a map; added to the background
};

/// @throws Error, naming mesh and element, for triangles that index no vertex, numbers that are
///         not finite, materials that do not exist, points that are not behind the panel (z ≥ 0), meshes wholly in
///         front of it, meshes that shine and have no area, and a scene with nothing in it.
void check_scene(const Scene& scene);

}  // namespace holotrace
