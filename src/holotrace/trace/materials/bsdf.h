#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <variant>

#include "holotrace/base/vec.h"
#include "holotrace/data/image.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/materials/conductor_bsdf.h"
#include "holotrace/trace/materials/dielectric_bsdf.h"
#include "holotrace/trace/materials/diffuse_bsdf.h"
#include "holotrace/trace/materials/filter_bsdf.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/materials/measured_bsdf.h"
#include "holotrace/trace/materials/metallic_roughness_bsdf.h"
#include "holotrace/trace/materials/principled_bsdf.h"
#include "holotrace/trace/materials/scattering_bsdf.h"
#include "holotrace/trace/shared/ray.h"
#include "holotrace/trace/shared/texture.h"

// What surfaces do to light at one point. Textures are looked up; colours and indices are taken at the path's lines.
// Directions are unit vectors away from the surface: `outgoing` points to where the path came from (the viewer's side),
// `incoming` to where it continues (the light's side). Each kind of surface has a file with its functions and a type in
// the variant.

namespace holotrace {

using Bsdf = std::variant<DiffuseBsdf, ConductorBsdf, DielectricBsdf, MetallicRoughnessBsdf, PrincipledBsdf,
                          MeasuredBsdf, ScatteringBsdf, FilterBsdf>;

/// The BSDF of a material at a point whose normal map has been applied (shading_point).
///
/// - Textures and the vertices' colour multiply colours; a product above 1 counts as 1.
/// - A one-sided surface seen from behind is black. A solid dielectric has two sides: its back is its inside.
/// - Metals and coats are in air. A dielectric has air outside. It refracts by its index at the hero of the
///   lines, so a path through a dispersive one has that line alone (Hero).
///
/// @throws Error for a refractive index without samples
/// Cost: some 30 ns, 200 ns for a rough conductor at three lines; the first rough lobe computes a table (30
/// ms).
Bsdf make_bsdf(const Material& material, const SurfacePoint& point, const Lines& lines);

/// The lobes that `eval_bsdf` can evaluate: all but the specular one.
inline LobeSet lobes_of(const Bsdf& bsdf) {
  return std::visit([](const auto& b) { return lobes(b); }, bsdf);
}

/// f·|cosθ_incoming| of one lobe [1/sr]; 0 for a specular lobe.
inline Vec3 eval_bsdf(const Bsdf& bsdf, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  return std::visit([&](const auto& b) { return eval(b, outgoing, incoming, lobe); }, bsdf);
}

/// Density with which sample_bsdf draws this direction in this lobe [1/sr], including the probability of the lobe. Over
/// all lobes and directions it integrates to 1, less the specular part and directions drawn into the surface.
inline double pdf_bsdf(const Bsdf& bsdf, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  return std::visit([&](const auto& b) { return pdf(b, outgoing, incoming, lobe); }, bsdf);
}

/// Draws a lobe by `u_lobe` and a direction in it by `u`, each in [0, 1). No result means that the path is absorbed.
inline std::optional<BsdfSample> sample_bsdf(const Bsdf& bsdf, Vec3 outgoing, double u_lobe, Vec2 u) {
  return std::visit([&](const auto& b) { return sample(b, outgoing, u_lobe, u); }, bsdf);
}

/// The branches of the specular lobe, at most a reflection and a refraction, each with its full weight. For callers
/// that follow both instead of drawing one.
inline SpecularBranches specular_branches(const Bsdf& bsdf, Vec3 outgoing) {
  return std::visit([&](const auto& b) { return branches(b, outgoing); }, bsdf);
}

/// The point with its shading normal: the normal is turned by the material's normal map, if it has one and the mesh has
/// texture coordinates, and then made to face the viewer's side of the triangle.
///
///     normal = normalize(s·x·T + s·y·B + z·N),  (x, y, z) = 2·map − 1,  s = normal_scale
///
/// T is ∂position/∂u without its part along the normal N; B = ±N × T points toward ∂position/∂v. Seen from behind, the
/// turned normal is that of the front, negated (glTF 2.0, 3.7.2.1).
SurfacePoint shading_point(const Material& material, const SurfacePoint& point);

/// The reflectance at the lines of a surface that is diffuse and only reflects; none for any other. make_bsdf makes a
/// DiffuseBsdf of it.
std::optional<Vec3> diffuse_reflectance(const Material& material, const SurfacePoint& point, const Lines& lines);

/// Whether a surface is thin glass or a filter, which transmits light straight on.
bool is_pane(const Material& material);

/// The refractive index of a solid that light enters by this surface; nullptr for any other surface.
const RefractiveIndex* solid_index(const Material& material);

/// Whether a material is a solid that bends light of different wavelengths differently.
bool is_dispersive(const Material& material);

/// The material of a surface; black for the surface of a light, whose emission belongs to the light itself.
const Material& material_at(const Scene& scene, const SurfacePoint& point);

/// The emission of a material at the lines, times a colour; without its texture [W/m²/sr].
inline Vec3 emission_of(const Material& material, Vec3 colour, const Lines& lines) {
  const Vec3 emission = lines.from_rgb(material.emission * colour);
  return material.emission_spectrum ? emission * lines.values_of(*material.emission_spectrum) : emission;
}

/// Whether particles emit by their temperature.
inline bool is_hot(const Material& material) {
  const auto* particles = std::get_if<ScatteringMaterial>(&material.surface);
  return particles && particles->blackbody > 0;
}

/// Radiance that a material emits toward where the path came from, at the lines [W/m²/sr].
Vec3 emitted_radiance(const Material& material, const SurfacePoint& point, const Lines& lines);

/// Refractive indices on the side of the surface that the path came from (near) and on the other side (far), at one
/// wavelength. Both are 1 unless the surface is that of a solid. The index of air is 1.
struct MediumIndices {
  double near = 1, far = 1;
};
MediumIndices media_at(const Material& material, const SurfacePoint& point, double wavelength);

}  // namespace holotrace
