#include <algorithm>
#include <cmath>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/medium_checks.h"
#include "holotrace/trace/geometry/accelerator.h"

namespace holotrace {

namespace {

bool is_light_value(Vec3 v) { return is_finite(v) && v.x >= 0 && v.y >= 0 && v.z >= 0; }
bool is_share(double v) { return v >= 0 && v <= 1; }
bool is_colour(Vec3 v) { return is_share(v.x) && is_share(v.y) && is_share(v.z); }

void require_strength(Vec3 value, const char* what, const char* unit, size_t index) {
  require(is_light_value(value), "expected {} of 0 {} or more in light {}, got ({}, {}, {})", what, unit, index,
          value.x, value.y, value.z);
}

void require_direction(Vec3 direction, size_t index) {
  const double size = length(direction);
  require(std::abs(size - 1) < 1e-6, "expected a direction of length 1 in light {}, got ({}, {}, {}) of length {}",
          index, direction.x, direction.y, direction.z, size);
}

void check_light(const PointLight& light, size_t index) {
  require(is_finite(light.position), "expected a finite position of light {}", index);
  require_strength(light.intensity, "an intensity", "W/sr", index);
}

void check_light(const SpotLight& light, size_t index) {
  require(is_finite(light.position), "expected a finite position of light {}", index);
  require_direction(light.direction, index);
  require_strength(light.intensity, "an intensity", "W/sr", index);
  require(
      light.inner_angle >= 0 && light.inner_angle <= light.outer_angle && light.outer_angle <= pi,
      "expected angles 0 ≤ inner ≤ outer ≤ 180 deg of the cone of light {}, got an inner one of {} deg and an outer "
      "one of {} deg",
      index, light.inner_angle * 180 / pi, light.outer_angle * 180 / pi);
}

void check_light(const DirectionalLight& light, size_t index) {
  require_direction(light.direction, index);
  require_strength(light.irradiance, "an irradiance", "W/m²", index);
  require(is_finite(light.position), "expected a finite position of light {}", index);
  require(light.radius > 0, "expected a radius above 0 m of the beam of light {}, got {} m", index, light.radius);
}

void check_light(const RectangleLight& light, size_t index) {
  require(is_finite(light.corner), "expected a finite corner of light {}", index);
  const double area = length(cross(light.edge_u, light.edge_v));
  require(std::isfinite(area) && area > 0, "expected edges of light {} that span an area, got {} m²", index, area);
  require_strength(light.radiance, "a radiance", "W/m²/sr", index);
}

void check_texture(const Image* image, const char* what, size_t index) {
  if (!image) return;
  const bool is_complete = image->values.size() == size_t(image->nx) * size_t(image->ny) * size_t(image->channels);
  require(image->nx > 0 && image->ny > 0 && (image->channels == 1 || image->channels == 3) && is_complete,
          "expected {} of at least 1 × 1 pixels with 1 or 3 channels in material {}, got {} × {} with {}", what, index,
          image->nx, image->ny, image->channels);
  const auto is_good = [](float value) { return value >= 0 && std::isfinite(value); };
  const auto bad = std::find_if_not(image->values.begin(), image->values.end(), is_good);
  require(bad == image->values.end(), "expected {} of finite values of 0 or more in material {}, got {}", what, index,
          bad == image->values.end() ? 0 : *bad);
}

void require_share(double value, const char* what, size_t index) {
  require(is_share(value), "expected a {} from 0 to 1 in material {}, got {}", what, index, value);
}

void require_colour(Vec3 value, const char* what, size_t index) {
  require(is_colour(value), "expected a {} from 0 to 1 in material {}, got ({}, {}, {})", what, index, value.x, value.y,
          value.z);
}

void check_index(const RefractiveIndex& refractive, size_t index) {
  require(!refractive.samples.empty(), "expected a refractive index in material {}, got one without samples", index);
  for (const auto& [wavelength, n, k] : refractive.samples)
    require(std::isfinite(wavelength) && wavelength >= 0 && std::isfinite(n) && n > 0 && std::isfinite(k) && k >= 0,
            "expected a refractive index n + ik with n > 0 and k ≥ 0 in material {}, got {} + {}i at {} m", index, n, k,
            wavelength);
}

void check_surface(const DiffuseMaterial& material, size_t index) {
  require_colour(material.reflectance, "reflectance", index);
  require_colour(material.transmittance, "transmittance", index);
  const double sum = max_component(material.reflectance + material.transmittance);
  require(sum <= 1 + 1e-9, "expected a reflectance and a transmittance of at most 1 together in material {}, got {}",
          index, sum);
  check_texture(material.texture.get(), "a texture", index);
}

void check_surface(const ConductorMaterial& material, size_t index) {
  check_index(material.index, index);
  require_share(material.roughness, "roughness", index);
}

constexpr double most_glass_index = 1e4;  // it reflects 0.9996 of the light

void check_glass_index(const RefractiveIndex& glass, size_t index) {
  check_index(glass, index);
  for (const auto& sample : glass.samples)
    require(sample.n <= most_glass_index, "expected an index of at most {:g} in material {}, got {:g}",
            most_glass_index, index, sample.n);
  for (const auto& [wavelength, n, k] : glass.samples)
    require(k == 0, "expected glass that does not absorb (k = 0) in material {}, got {} + {}i at {} m", index, n, k,
            wavelength);
}

void check_surface(const DielectricMaterial& material, size_t index) {
  check_glass_index(material.index, index);
  require_share(material.roughness, "roughness", index);
}

void check_surface(const MetallicRoughnessMaterial& material, size_t index) {
  require_colour(material.base_color, "base colour", index);
  require_share(material.metallic, "metallic", index);
  require_share(material.roughness, "roughness", index);
  check_texture(material.base_texture.get(), "a base texture", index);
  check_texture(material.metallic_texture.get(), "a metallic-roughness texture", index);
}

void check_surface(const PrincipledMaterial& material, size_t index) {
  const std::pair<const TexturedNumber&, const char*> numbers[] = {
      {material.metalness, "metalness"},
      {material.roughness, "roughness"},
      {material.specular, "specular weight"},
      {material.anisotropy, "anisotropy"},
      {material.transmission, "transmission"},
      {material.diffuse_transmission, "diffuse transmission"},
      {material.clearcoat, "clear coat"},
      {material.clearcoat_roughness, "roughness of the clear coat"},
      {material.sheen_roughness, "roughness of the sheen"},
      {material.iridescence, "iridescence"}};
  for (const auto& [number, name] : numbers) require_share(number.value, name, index);
  const std::pair<const TexturedColour&, const char*> colours[] = {
      {material.base_color, "base colour"},
      {material.diffuse_transmission_color, "colour of the diffuse transmission"},
      {material.sheen_color, "colour of the sheen"}};
  for (const auto& [colour, name] : colours) require_colour(colour.value, name, index);
  require_colour(material.attenuation_color, "attenuation colour", index);
  require(is_light_value(material.specular_color.value),
          "expected a specular colour of 0 or more in material {}, got ({}, {}, {})", index,
          material.specular_color.value.x, material.specular_color.value.y, material.specular_color.value.z);
  for_each_texture(material, [&](const PlacedTexture& texture) {
    check_texture(texture.image.get(), "a texture", index);
    constexpr double most = 1e6;
    for (const double number : {texture.uu, texture.uv, texture.u0, texture.vu, texture.vv, texture.v0})
      require(std::abs(number) <= most,
              "expected a texture in material {} that is scaled and moved by at most {:g}, got {:g}", index, most,
              number);
  });
  check_glass_index(material.index, index);
  const auto is_layer = [](double n) { return n >= 1 && n <= most_glass_index; };
  require(is_layer(material.clearcoat_index),
          "expected an index from 1 to {:g} of the clear coat in material {}, got {:g}", most_glass_index, index,
          material.clearcoat_index);
  require(is_layer(material.iridescence_index),
          "expected an index from 1 to {:g} of the thin film in material {}, got {:g}", most_glass_index, index,
          material.iridescence_index);
  constexpr double thickest_film = 1e-3;  // its colours change within 1/1000 of a wavelength
  for (const double thickness : {material.film_thickness, material.least_thickness})
    require(thickness >= 0 && thickness <= thickest_film, "expected a thin film of 0 m to {} in material {}, got {}",
            format_length(thickest_film), index, format_length(thickness));
  require(material.attenuation_distance > 0, "expected an attenuation distance above 0 m in material {}, got {}", index,
          material.attenuation_distance);
  require(std::isfinite(material.anisotropy_rotation), "expected a finite rotation in material {}, got {} rad", index,
          material.anisotropy_rotation);
}

void check_surface(const ScatteringMaterial& material, size_t index) {
  require_colour(material.albedo, "albedo", index);
  require(std::abs(material.anisotropy) <= most_anisotropy,
          "expected an anisotropy from -{} to {} in material {}, got {}", most_anisotropy, most_anisotropy, index,
          material.anisotropy);
  constexpr double largest = 200e-6;  // of larger ones the tables of directions take long
  require(material.droplet_radius >= 0 && material.droplet_radius <= largest,
          "expected a radius of droplets of at most 0.2 mm in material {}, got {} m", index, material.droplet_radius);
}

void check_surface(const MeasuredMaterial& material, size_t index) {
  require(material.brdf != nullptr, "expected a table of the measured material {}, got none", index);
}

void check_surface(const FilterMaterial& material, size_t index) {
  require(std::isfinite(length(material.axis)) && length(material.axis) > 0,
          "expected an axis of the polariser or retarder in material {} that is not 0, got ({}, {}, {})", index,
          material.axis.x, material.axis.y, material.axis.z);
  require_share(material.transmittance, "transmittance", index);
  require_share(material.leakage, "leakage", index);
  require(std::isfinite(material.delay) && std::isfinite(material.path_difference),
          "expected a finite delay in material {}, got {} rad and {} m", index, material.delay,
          material.path_difference);
}

void check_material(const Material& material, size_t index) {
  std::visit([&](const auto& surface) { check_surface(surface, index); }, material.surface);
  require(is_light_value(material.emission),
          "expected an emission of 0 W/m²/sr or more in material {}, got ({}, {}, {})", index, material.emission.x,
          material.emission.y, material.emission.z);
  check_texture(material.emission_texture.get(), "an emission texture", index);
  check_texture(material.normal_map.get(), "a normal map", index);
  require(!material.normal_map || material.normal_map->channels == 3,
          "expected a normal map of 3 channels in material {}, got 1", index);
  check_texture(material.opacity_texture.get(), "an opacity texture", index);
  require_share(material.opacity, "share of opacity", index);
  require_share(material.opacity_cutoff, "cutoff of opacity", index);
  require(std::isfinite(material.normal_scale), "expected a finite normal scale in material {}, got {}", index,
          material.normal_scale);
}

using holotrace::has_texture;
bool has_texture(const DiffuseMaterial& material) { return material.texture != nullptr; }
bool has_texture(const MetallicRoughnessMaterial& material) {
  return material.base_texture || material.metallic_texture;
}
bool has_texture(const ConductorMaterial&) { return false; }
bool has_texture(const DielectricMaterial&) { return false; }
bool has_texture(const ScatteringMaterial&) { return false; }
bool has_texture(const MeasuredMaterial&) { return false; }
bool has_texture(const FilterMaterial&) { return false; }

void check_sky(const Sky& sky) {
  require(sky.turbidity >= 1.7 && sky.turbidity <= 10, "expected a turbidity of the sky from 1.7 to 10, got {}",
          sky.turbidity);
  require(sky.elevation >= 0 && sky.elevation <= pi / 2,
          "expected a sun from the horizon (0 deg) to the zenith (90 deg), got an elevation of {} deg",
          sky.elevation * 180 / pi);
  require(std::isfinite(sky.azimuth), "expected a finite azimuth of the sun, got {} rad", sky.azimuth);
}

void check_environment(const Environment& environment) {
  require(is_light_value(environment.scale), "expected an environment scale of 0 W/m²/sr or more, got ({}, {}, {})",
          environment.scale.x, environment.scale.y, environment.scale.z);
  if (environment.sky) return check_sky(*environment.sky);
  require(environment.map != nullptr, "expected a map in the environment, got none");
  const Image& map = *environment.map;
  const bool is_complete = map.values.size() == size_t(map.nx) * size_t(map.ny) * size_t(map.channels);
  require(map.nx > 0 && map.nx == 2 * map.ny && (map.channels == 1 || map.channels == 3) && is_complete,
          "expected an environment map of all directions, twice as wide as high, with 1 or 3 channels, got {} × {} "
          "pixels with {}",
          map.nx, map.ny, map.channels);
  for (size_t i = 0; i < map.values.size(); ++i) {
    const size_t pixel = i / size_t(map.channels);
    require(std::isfinite(map.values[i]) && map.values[i] >= 0,
            "expected an environment map of finite values of 0 or more, got {} in row {}, column {}", map.values[i],
            pixel / size_t(map.nx), pixel % size_t(map.nx));
  }
  require(std::isfinite(environment.turn), "expected a finite turn of the environment, got {} rad", environment.turn);
}

}  // namespace

bool has_texture(const Material& material) {
  return material.emission_texture || material.normal_map || material.opacity_texture ||
         std::visit([](const auto& surface) { return has_texture(surface); }, material.surface);
}

void check_light_and_materials(const Scene& scene) {
  for (size_t i = 0; i < scene.lights.size(); ++i)
    std::visit([&](const auto& light) { check_light(light, i); }, scene.lights[i]);
  for (size_t i = 0; i < scene.materials.size(); ++i) check_material(scene.materials[i], i);
  for (const Medium& medium : scene.media) check_medium(medium);
  check_open_media(scene.media);
  require(scene.media.empty() || scene.points.empty(),
          "expected no luminous points in a scene with media, got {}; use small spheres that emit",
          scene.points.size());
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[size_t(mesh.material)];
    require(!has_texture(material) || !mesh.texture_coordinates.empty(),
            "expected texture coordinates in mesh \"{}\", whose material has a texture, got none; add them or use a "
            "material without a texture",
            mesh.name);
    constexpr double farthest = 1e9;  // in textures
    for (const auto* coordinates : {&mesh.texture_coordinates, &mesh.second_coordinates})
      for (const Vec2 uv : *coordinates)
        require(std::abs(uv.x) <= farthest && std::abs(uv.y) <= farthest,
                "expected texture coordinates of at most {:g} in mesh \"{}\", got ({:g}, {:g})", farthest, mesh.name,
                uv.x, uv.y);
  }
  require(is_light_value(scene.background), "expected a background of 0 W/m²/sr or more, got ({}, {}, {})",
          scene.background.x, scene.background.y, scene.background.z);
  if (scene.environment) check_environment(*scene.environment);
  if (scene.analyser)
    for (const double weight : *scene.analyser)
      require(std::abs(weight) <= 1, "expected weights of Stokes parameters from -1 to 1 for the analyser, got {}",
              weight);
}

}  // namespace holotrace
