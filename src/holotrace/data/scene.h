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
#include "holotrace/data/measured_brdf.h"
#include "holotrace/data/polarization.h"
#include "holotrace/data/refractive_index.h"
#include "holotrace/data/spectrum.h"

namespace holotrace {

/// Diffuse reflection on both sides and, for thin things such as paper or leaves, diffuse transmission:
/// BRDF = reflectance/π, BTDF = transmittance/π.
struct DiffuseMaterial {
  Vec3 reflectance{0.8, 0.8, 0.8};         ///< albedo ρ in red, green, blue, each in [0, 1]
  std::shared_ptr<const Image> texture{};  ///< multiplies both, if present (linear light)
  Vec3 transmittance{0, 0, 0};             ///< BTDF·π in red, green, blue, each in [0, 1]; at most 1 with reflectance
};

/// A metal: Fresnel reflection with a complex index, off a surface of GGX microfacets.
struct ConductorMaterial {
  RefractiveIndex index = metal_index("Ag");  ///< n + ik
  double roughness = 0;                       ///< GGX α = roughness²; 0: a mirror
};

/// Glass, water, crystal: reflection and refraction. The mesh is closed, and its triangles are counter-clockwise seen
/// from outside, where rays enter. A thin one is a smooth pane: light goes straight through, reflected at both faces.
struct DielectricMaterial {
  RefractiveIndex index = constant_index(1.5);  ///< n, k = 0
  double roughness = 0;                         ///< GGX α = roughness²; 0: smooth
  bool is_thin = false;
};

/// The metallic-roughness model of glTF 2.0: a mix of a coloured metal and a dielectric coat of F₀ = 0.04 over a
/// diffuse base.
struct MetallicRoughnessMaterial {
  Vec3 base_color{1, 1, 1};                         ///< colour of the diffuse base, or F₀ of the metal
  std::shared_ptr<const Image> base_texture{};      ///< multiplies base_color (linear light)
  double metallic = 1, roughness = 1;               ///< each in [0, 1]; GGX α = roughness²
  std::shared_ptr<const Image> metallic_texture{};  ///< multiplies both: roughness in green, metallic in blue
};

/// A texture that is read at (u, v) ↦ (uu·u + uv·v + u0, vu·u + vv·v + v0) of the mesh's coordinates, v up.
struct PlacedTexture {
  std::shared_ptr<const Image> image{};
  double uu = 1, uv = 0, u0 = 0, vu = 0, vv = 1, v0 = 0;
  bool is_second = false;  ///< whether it is at the second coordinates of the mesh
};

/// A number, and a texture of one channel that multiplies it, if present.
struct TexturedNumber {
  double value = 0;
  PlacedTexture texture{};
};

/// A colour, and a texture that multiplies it, if present (linear light).
struct TexturedColour {
  Vec3 value{1, 1, 1};
  PlacedTexture texture{};
};

/// A surface of layers, in the terms of OpenPBR and of the extensions KHR_materials of glTF 2.0. From the top: sheen, a clear
/// coat, and a base that is a mix of a metal and a dielectric. Below the surface of the dielectric, light is scattered
/// (diffuse) or goes on (transmission). Numbers without a unit are in [0, 1]. GGX α = roughness².
struct PrincipledMaterial {
  TexturedColour base_color{{0.8, 0.8, 0.8}};   ///< diffuse reflectance, tint of the transmission, F₀ of the metal
  TexturedNumber metalness{0};                  ///< fraction of metal
  TexturedNumber roughness{0.3};                ///< of the base
  RefractiveIndex index = constant_index(1.5);  ///< of the dielectric, k = 0
  TexturedNumber specular{1};                   ///< factor for the reflection of the dielectric
  TexturedColour specular_color{};              ///< factor for its F₀
  TexturedNumber anisotropy{0};                 ///< α along the tangent is α + (1 − α)·anisotropy²
  double anisotropy_rotation = 0;               ///< from ∂position/∂u toward ∂position/∂v [rad]
  PlacedTexture anisotropy_direction{};         ///< red, green: direction from that angle on, [0, 1] for [−1, 1]

  TexturedNumber transmission{0};   ///< fraction of the dielectric that is clear
  bool is_thin = false;             ///< a sheet without refraction; else the surface of a solid
  Vec3 attenuation_color{1, 1, 1};  ///< colour of white light after attenuation_distance in the solid
  double attenuation_distance = std::numeric_limits<double>::infinity();  ///< [m]
  TexturedNumber diffuse_transmission{0};       ///< fraction of the diffuse light that leaves on the other side
  TexturedColour diffuse_transmission_color{};  ///< its colour

  TexturedNumber clearcoat{0}, clearcoat_roughness{0};  ///< weight and roughness of the coat
  double clearcoat_index = 1.5;
  bool has_coat_normals = false;  ///< the coat has the normals of the mesh, mapped by its own texture; else the base's
  PlacedTexture clearcoat_normals{};  ///< as Material::normal_map
  double clearcoat_normal_scale = 1;
  TexturedColour sheen_color{{0, 0, 0}};
  TexturedNumber sheen_roughness{0.3};

  TexturedNumber iridescence{0};    ///< weight of a thin film on the base
  double iridescence_index = 1.3;   ///< of the film, 1 or more
  double film_thickness = 400e-9;   ///< where its texture is 1, and without a texture [m]
  double least_thickness = 100e-9;  ///< where its texture is 0 [m]
  PlacedTexture thickness_texture{};
};

/// Calls f(texture) for each PlacedTexture of the material.
template <class Principled, class F>
void for_each_texture(Principled& m, F&& f) {
  for (auto* number : {&m.metalness, &m.roughness, &m.specular, &m.anisotropy, &m.transmission, &m.diffuse_transmission,
                       &m.clearcoat, &m.clearcoat_roughness, &m.sheen_roughness, &m.iridescence})
    f(number->texture);
  for (auto* colour : {&m.base_color, &m.specular_color, &m.diffuse_transmission_color, &m.sheen_color})
    f(colour->texture);
  f(m.anisotropy_direction);
  f(m.clearcoat_normals);
  f(m.thickness_texture);
}

inline bool has_texture(const PrincipledMaterial& material) {
  bool has_any = false;
  for_each_texture(material, [&](const PlacedTexture& texture) { has_any = has_any || texture.image; });
  return has_any;
}

/// What the particles of a medium do to light that meets one: a fraction, the albedo, is scattered. The phase function is that
/// of Henyey and Greenstein, or that of water droplets of one size (Lorenz and Mie).
struct ScatteringMaterial {
  Vec3 albedo{1, 1, 1};       ///< in red, green, blue, each in [0, 1]
  double anisotropy = 0;      ///< g of Henyey and Greenstein, the mean cosine of the angle of scattering, |g| ≤ 0.999
  double droplet_radius = 0;  ///< above 0: of water droplets, which replace g [m]
  double blackbody = 0;  ///< factor for the light of a black body of the medium's temperature (Medium::temperature)
};

/// A surface whose reflection was measured; its back is like its front.
struct MeasuredMaterial {
  std::shared_ptr<const MeasuredBrdf> brdf{};
};

/// A sheet that polarises or delays light on its way straight through it, without reflection: a polariser, a wave plate.
struct FilterMaterial {
  Vec3 axis{1, 0, 0};          ///< direction in the scene; its part in the sheet counts
  double transmittance = 1;    ///< of light polarised along the axis, in [0, 1]
  double leakage = 0;          ///< transmittance of light polarised across the axis
  double delay = 0;            ///< of the light along the axis, at every wavelength [rad]
  double path_difference = 0;  ///< and of 2π·path_difference/λ [m]
};

/// The reflection, transmission and emission of a surface. To add a material: see CONTRIBUTING.md.
struct Material {
  using Surface = std::variant<DiffuseMaterial, ConductorMaterial, DielectricMaterial, MetallicRoughnessMaterial,
                               PrincipledMaterial, MeasuredMaterial, ScatteringMaterial, FilterMaterial>;
  Surface surface;
  Vec3 emission{0, 0, 0};                               ///< emitted radiance [W/m²/sr]
  std::shared_ptr<const Image> emission_texture{};      ///< multiplies emission (linear light)
  std::shared_ptr<const Spectrum> emission_spectrum{};  ///< multiplies emission, if present
  std::shared_ptr<const Image> normal_map{};  ///< tangent space, as in glTF: red to +u, green to +v, [0, 1] for [−1, 1]
  double normal_scale = 1;                    ///< factor for the x and y of the map
  /// Part of the rays that the surface stops, in [0, 1]. Others go straight through it, as if it were not there: leaves and
  /// fences as pictures on flat surfaces, gauze, thin smoke. Which ones is drawn by a hash of the ray.
  double opacity = 1;
  std::shared_ptr<const Image> opacity_texture{};  ///< one channel; multiplies opacity
  double opacity_cutoff = 0;                       ///< above 0: opacities from here on are 1, others 0 (a mask)
  /// One-sided surfaces are black from behind: triangles are counter-clockwise as seen from their front. The back of a
  /// solid dielectric is its inside and is never black.
  bool two_sided = true;
  int medium = -1;  ///< index into Scene::media of what closed meshes of this material are filled with; −1: none

  Material() = default;
  template <class S>
  requires std::constructible_from<Surface, S> Material(S surface, Vec3 emission = {})
      : surface(std::move(surface)), emission(emission) {}
};

/// A box with sides along the axes.
struct MediumBox {
  Vec3 low, high;  ///< corners [m]
};

/// Values at the centres of equal cells of a box, linear between them.
struct Cells {
  /// One channel; a row along +x; the rows of a plane along +y, and the planes after each other along +z. None: no cells.
  std::shared_ptr<const Image> values{};
  int planes = 0;
};

/// Fog, smoke, milk: particles in a volume that absorb, scatter and emit light. A medium fills the closed meshes whose material
/// names it, its box, or the whole of space.
struct Medium {
  std::string name;
  Vec3 extinction;       ///< absorbed and scattered part per length in red, green, blue, σ_t = σ_a + σ_s [1/m]
  int material = -1;     ///< index into Scene::materials: a ScatteringMaterial, with the emission of a particle
  bool is_open = false;  ///< whether it fills its box, or without a box the whole of space; else meshes
  std::optional<MediumBox> box{};
  Cells density{};      ///< factors for the extinction, 0 or more; 1 without them
  Cells temperature{};  ///< of black particles [K]; one cell: the same everywhere, also without a box
};

/// Triangles of one material.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;                     ///< [m]
  std::vector<Vec3> normals;                       ///< unit, one per position, or empty: flat shading
  std::vector<Vec2> texture_coordinates;           ///< (u, v), v up, one pair per position, or empty
  std::vector<Vec2> second_coordinates{};          ///< the same, of a second set for PlacedTexture
  std::vector<Vec3> colours;                       ///< linear, one per position, or empty; multiply the base colour
  std::vector<std::array<uint32_t, 3>> triangles;  ///< indices into positions
  int material = 0;                                ///< index into Scene::materials
};

/// Light that leaves a point evenly in all directions. The light of a laser is coherent: phases follow its path.
struct PointLight {
  Vec3 position;   ///< [m]
  Vec3 intensity;  ///< radiant intensity [W/sr]
  bool is_laser = false;
  std::shared_ptr<const Spectrum> spectrum{};  ///< multiplies the intensity, if present; so do those of other lights
};

/// A point light in a cone: full intensity up to inner_angle from its axis, none beyond outer_angle, smooth between.
struct SpotLight {
  Vec3 position;                            ///< [m]
  Vec3 direction;                           ///< unit vector, the direction in which the light travels
  Vec3 intensity;                           ///< radiant intensity on the axis [W/sr]
  double inner_angle = 0, outer_angle = 0;  ///< half angles [rad], 0 ≤ inner ≤ outer ≤ π
  std::shared_ptr<const Spectrum> spectrum{};
};

/// Parallel light: the sun, or the beam of a laser, which has a round cross-section and a phase.
struct DirectionalLight {
  Vec3 direction;          ///< unit vector, the direction in which the light travels
  Vec3 irradiance;         ///< irradiance on a plane across it [W/m²]
  Vec3 position{0, 0, 0};  ///< a point on the axis of the beam [m]; the phase of a laser is 0 in the plane through it
  double radius = std::numeric_limits<double>::infinity();  ///< radius of the beam [m]
  bool is_laser = false;
  std::shared_ptr<const Spectrum> spectrum{};
};

/// A rectangle corner + s·edge_u + t·edge_v that emits on the side to which edge_u × edge_v points. A visible one is a
/// black surface that emits: it is seen, and hides what is behind it. An invisible one lights the scene and is seen in
/// reflections, but it is not seen from the panel and blocks no light.
struct RectangleLight {
  Vec3 corner, edge_u, edge_v;  ///< [m]
  Vec3 radiance;                ///< [W/m²/sr]
  bool is_visible = true;
  std::shared_ptr<const Spectrum> spectrum{};
};

/// Light sources other than meshes that emit. New kinds of lights are added to this list.
using Light = std::variant<PointLight, SpotLight, DirectionalLight, RectangleLight>;

/// A clear sky with its sun, above the horizon y = 0; below, it is black (trace/lights/sky.h).
struct Sky {
  double turbidity = 3;    ///< haze, from 1.7 (clear) to 10 (hazy)
  double elevation = 0.8;  ///< of the sun above the horizon [rad], 0 to π/2
  double azimuth = 0;      ///< of the sun, from −z to the right (+x) [rad]
  bool has_sun = true;     ///< whether the disc of the sun shines, too
};

/// Light from infinitely far away: radiance = scale·map. The map is equirectangular: its middle column
/// shows the direction −z (behind the scene), its right half +x, its top row +y. A sky takes the place of the map; its
/// radiance is scale·(that of a nanometre of its spectrum).
struct Environment {
  std::shared_ptr<const Image> map{};  ///< linear light
  Vec3 scale{1, 1, 1};                 ///< [W/m²/sr] per unit of the map
  double turn = 0;                     ///< rotation of the map about +y, right-handed [rad]
  std::optional<Sky> sky{};            ///< instead of the map
};

/// A luminous point, a source of one wave, as bright as a surface of the radiance amplitude² (acceptance.h).
struct ScenePoint {
  Vec3 position;        ///< [m]
  float amplitude = 1;  ///< square root of its radiance [√(W/m²/sr)]
  float phase = 0;      ///< phase [rad], added to that of TraceParams::phase
};

/// Geometry in the panel's frame: origin at its centre, x right, y up, z toward the viewer. Most
/// scenes are behind the panel, at z < 0; what is at z > 0 floats in front of it.
struct Scene {
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Light> lights;
  std::vector<ScenePoint> points;
  Vec3 background{0, 0, 0};                          ///< radiance of rays that leave the scene [W/m²/sr]
  std::optional<Environment> environment;            ///< radiance of such rays from a map; added to the background
  Reflectances reflectances = Reflectances::linear;  ///< what the colours of surfaces reflect between the three lines
  std::vector<Medium> media;
  /// What the viewer sees of the Stokes parameters, such as through polarised glasses; none: light has no polarization.
  std::optional<StokesVector> analyser{};
};

/// @throws Error, naming mesh and element, for triangles with invalid vertex indices, numbers that are
///         not finite, materials that do not exist, points on the panel (z = 0), meshes that emit and have no
///         area, and an empty scene.
void check_scene(const Scene& scene);

}  // namespace holotrace
