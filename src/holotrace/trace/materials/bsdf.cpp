#include "holotrace/trace/materials/bsdf.h"

#include <algorithm>
#include <array>
#include <complex>

#include "holotrace/trace/materials/microfacet.h"

namespace holotrace {

namespace {

double clip(double x) { return std::clamp(x, 0.0, 1.0); }
Vec3 clip(Vec3 v) { return {clip(v.x), clip(v.y), clip(v.z)}; }

Vec3 textured(const std::shared_ptr<const Image>& texture, const SurfacePoint& point) {
  return texture ? eval_texture(*texture, point.uv) * point.colour : point.colour;
}

bool transmits(const DiffuseMaterial& material) { return max_component(material.transmittance) > 0; }

Bsdf make(const DiffuseMaterial& material, const SurfacePoint& point, const Lines& lines) {
  const Vec3 colour = textured(material.texture, point);
  DiffuseBsdf b{point.normal, point.geometric_normal, lines.reflectance_of(clip(material.reflectance * colour)), {}};
  if (!transmits(material)) return b;
  b.transmittance = lines.reflectance_of(clip(material.transmittance * colour));
  b.transmittance = {std::min(b.transmittance.x, 1 - b.reflectance.x),  // at most what is not reflected
                     std::min(b.transmittance.y, 1 - b.reflectance.y),
                     std::min(b.transmittance.z, 1 - b.reflectance.z)};
  const double reflected = max_component(b.reflectance), transmitted = max_component(b.transmittance);
  if (transmitted > 0) b.transmission_probability = transmitted / (reflected + transmitted);
  return b;
}

Bsdf make(const ConductorMaterial& material, const SurfacePoint& point, const Lines& lines) {
  std::array<std::complex<double>, 3> index;
  for (size_t line = 0; line < 3; ++line)
    index[line] = line > 0 && lines.wavelengths[line] == lines.wavelengths[0]
                      ? index[0]
                      : index_at(material.index, lines.wavelengths[line]);
  const double roughness = clip(material.roughness);
  return make_conductor_bsdf(point.normal, point.geometric_normal, index, roughness * roughness);
}

Bsdf make(const DielectricMaterial& material, const SurfacePoint& point, const Lines& lines) {
  const double roughness = clip(material.roughness);
  return make_dielectric_bsdf(point, material.index, lines, roughness * roughness, material.is_thin);
}

Bsdf make(const MetallicRoughnessMaterial& material, const SurfacePoint& point, const Lines& lines) {
  double metallic = material.metallic, roughness = material.roughness;
  if (material.metallic_texture) {
    const Vec3 texel = eval_texture(*material.metallic_texture, point.uv);
    roughness *= texel.y;
    metallic *= texel.z;
  }
  metallic = clip(metallic);
  roughness = clip(roughness);
  const Vec3 colour = clip(material.base_color * textured(material.base_texture, point));
  return make_metallic_roughness_bsdf(point.normal, point.geometric_normal, lines.reflectance_of(colour), metallic,
                                      roughness * roughness);
}

Bsdf make(const PrincipledMaterial& material, const SurfacePoint& point, const Lines& lines) {
  return make_principled_bsdf(material, point, lines);
}

Bsdf make(const ScatteringMaterial& material, const SurfacePoint&, const Lines& lines) {
  // Not a colour of a surface, which smooth spectra are for.
  ScatteringBsdf b{lines.from_rgb(material.albedo), material.anisotropy, {}};
  for (size_t i = 0; i < 3 && material.droplet_radius > 0; ++i)
    b.droplets[i] = &droplet_phase(material.droplet_radius, lines.wavelengths[i]);
  return b;
}

Bsdf make(const MeasuredMaterial& material, const SurfacePoint& point, const Lines& lines) {
  return make_measured_bsdf(point, *material.brdf, lines);
}

Bsdf make(const FilterMaterial& material, const SurfacePoint& point, const Lines& lines) {
  FilterBsdf b{point.normal, point.geometric_normal, material.axis, material.transmittance, material.leakage, {}};
  for (size_t i = 0; i < 3; ++i) b.delay[i] = material.delay + 2 * pi * material.path_difference / lines.wavelengths[i];
  return b;
}

/// Whether a one-sided surface is seen from behind.
bool is_black_back(const Material& material, const SurfacePoint& point) {
  return !material.two_sided && !point.is_front && !solid_index(material);
}

}  // namespace

std::optional<Vec3> diffuse_reflectance(const Material& material, const SurfacePoint& point, const Lines& lines) {
  if (is_black_back(material, point)) return Vec3{};
  const auto* diffuse = std::get_if<DiffuseMaterial>(&material.surface);
  if (!diffuse || transmits(*diffuse)) return std::nullopt;
  return lines.reflectance_of(clip(diffuse->reflectance * textured(diffuse->texture, point)));
}

Bsdf make_bsdf(const Material& material, const SurfacePoint& point, const Lines& lines) {
  if (is_black_back(material, point)) return DiffuseBsdf{point.normal, point.geometric_normal, {}, {}};
  return std::visit([&](const auto& surface) { return make(surface, point, lines); }, material.surface);
}

SurfacePoint shading_point(const Material& material, const SurfacePoint& point) {
  SurfacePoint shaded = point;
  const auto mapped = [&](Vec3 texel, double scale) {
    const Vec3 front = point.is_front ? point.normal : -point.normal;
    const Vec3 along = point.tangent_u - front * dot(front, point.tangent_u);
    const double side = dot(cross(front, along), point.tangent_v);
    if (!(length(along) > 0) || side == 0) return point.normal;
    const Vec3 tangent = normalize(along), bitangent = cross(front, tangent) * std::copysign(1.0, side);
    const Vec3 map = texel * 2 - Vec3{1, 1, 1};
    const Vec3 turned = tangent * (scale * map.x) + bitangent * (scale * map.y) + front * map.z;
    return length(turned) > 0 ? normalize(point.is_front ? turned : -turned) : point.normal;
  };
  if (material.normal_map) shaded.normal = mapped(eval_texture(*material.normal_map, point.uv), material.normal_scale);
  shaded.normal = facing_normal(shaded.normal, point.geometric_normal);
  if (const auto* layers = std::get_if<PrincipledMaterial>(&material.surface); layers && layers->has_coat_normals) {
    const PlacedTexture& map = layers->clearcoat_normals;
    shaded.coat_normal = facing_normal(
        map.image ? mapped(eval_texture(map, point.uv, point.second_uv), layers->clearcoat_normal_scale) : point.normal,
        point.geometric_normal);
  }
  return shaded;
}

bool is_pane(const Material& material) {
  if (std::holds_alternative<FilterMaterial>(material.surface)) return true;
  if (const auto* layers = std::get_if<PrincipledMaterial>(&material.surface)) {
    const double roughness = layers->roughness.value;
    return layers->is_thin && layers->transmission.value > 0 && roughness * roughness < smooth_alpha;
  }
  const auto* glass = std::get_if<DielectricMaterial>(&material.surface);
  return glass && glass->is_thin;
}

const RefractiveIndex* solid_index(const Material& material) {
  if (const auto* glass = std::get_if<DielectricMaterial>(&material.surface))
    return glass->is_thin ? nullptr : &glass->index;
  const auto* layers = std::get_if<PrincipledMaterial>(&material.surface);
  return layers && layers->transmission.value > 0 && !layers->is_thin ? &layers->index : nullptr;
}

bool is_dispersive(const Material& material) {
  const RefractiveIndex* index = solid_index(material);
  return index && is_dispersive(*index);
}

const Material& material_at(const Scene& scene, const SurfacePoint& point) {
  static const Material black{DiffuseMaterial{.reflectance = {0, 0, 0}}};
  return point.material < 0 ? black : scene.materials[size_t(point.material)];
}

Vec3 emitted_radiance(const Material& material, const SurfacePoint& point, const Lines& lines) {
  if (!material.two_sided && !point.is_front) return {};
  if (is_hot(material)) {
    const auto& particles = std::get<ScatteringMaterial>(material.surface);
    const Vec3 absorbed = Vec3{1, 1, 1} - lines.from_rgb(particles.albedo);
    return emission_of(material, {1, 1, 1}, lines) + absorbed * point.colour * particles.blackbody;
  }
  return emission_of(
      material, material.emission_texture ? eval_texture(*material.emission_texture, point.uv) : Vec3{1, 1, 1}, lines);
}

MediumIndices media_at(const Material& material, const SurfacePoint& point, double wavelength) {
  const RefractiveIndex* index = solid_index(material);
  if (!index) return {};
  const double n = index_at(*index, wavelength).real();
  return point.is_front ? MediumIndices{1, n} : MediumIndices{n, 1};
}

}  // namespace holotrace
