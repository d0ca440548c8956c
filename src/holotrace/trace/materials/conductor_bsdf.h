#pragma once

#include <array>
#include <complex>
#include <optional>

#include "holotrace/trace/materials/fresnel.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/materials/microfacet.h"

namespace holotrace {

/// A metal in air: a mirror (specular), or GGX microfacets with Fresnel's reflectance (glossy, microfacet.h). A
/// white rough metal reflects everything. Only mirrors add a phase.
struct ConductorBsdf {
  Vec3 normal, geometric_normal;
  std::array<std::complex<double>, 3> index;  ///< n + ik at the lines
  bool is_grey = false;                       ///< whether all three indices are equal
  RoughReflection rough{};                    ///< a mirror if its α is below smooth_alpha

  bool is_smooth() const { return rough.alpha < smooth_alpha; }
};

inline Vec3 reflectance(const ConductorBsdf& b, double cosine) {
  const double first = reflectance_conductor(cosine, b.index[0]);
  if (b.is_grey) return {first, first, first};
  return {first, reflectance_conductor(cosine, b.index[1]), reflectance_conductor(cosine, b.index[2])};
}

/// @param index  n + ik at the lines
/// @param alpha  α of the GGX distribution, at most 1
inline ConductorBsdf make_conductor_bsdf(Vec3 normal, Vec3 geometric_normal,
                                         const std::array<std::complex<double>, 3>& index, double alpha) {
  ConductorBsdf b{normal, geometric_normal, index, index[0] == index[1] && index[1] == index[2], {alpha}};
  if (b.is_smooth()) return b;
  b.rough.albedo = MicrofacetAlbedo(alpha);
  const double loss = b.rough.albedo.mean().loss;
  // F̄ = 2∫F·μ dμ by three-point Gauss–Jacobi quadrature. It is exact for Schlick's reflectance (degree 5).
  constexpr double nodes[] = {0.2123405382391529, 0.5905331355592653, 0.9114120404872961};
  constexpr double weights[] = {0.1396539598029080, 0.4584822127191740, 0.4018638274779180};
  Vec3 mean;
  for (int i = 0; i < 3; ++i) mean += reflectance(b, nodes[i]) * weights[i];
  b.rough.multiple = {multiple_reflection(mean.x, loss), multiple_reflection(mean.y, loss),
                      multiple_reflection(mean.z, loss)};
  return b;
}

inline LobeSet lobes(const ConductorBsdf& b) { return {.has_glossy = !b.is_smooth()}; }

inline Vec3 eval(const ConductorBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::glossy || b.is_smooth() || dot(b.geometric_normal, incoming) <= 0) return {};
  const ShadingView view(b.normal, outgoing);
  return eval_reflection(b.rough, view.outgoing, view.local(incoming),
                         [&](double cosine) { return reflectance(b, cosine); });
}

inline double pdf(const ConductorBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::glossy || b.is_smooth() || dot(b.geometric_normal, incoming) <= 0) return 0;
  const ShadingView view(b.normal, outgoing);
  return pdf_reflection(b.rough, view.outgoing, view.local(incoming), b.rough.loss(view.outgoing.z));
}

/// The branch of a mirror, with its full weight.
inline SpecularBranches branches(const ConductorBsdf& b, Vec3 outgoing) {
  if (!b.is_smooth()) return {};
  const Vec3 normal = facing_normal(b.normal, outgoing), direction = reflect(outgoing, normal);
  if (dot(b.geometric_normal, direction) <= 0) return {};
  const double cosine = std::fmin(1, dot(outgoing, normal));
  const double first = reflection_phase(cosine, b.index[0]);
  const Vec3 phase = b.is_grey
                         ? Vec3{first, first, first}
                         : Vec3{first, reflection_phase(cosine, b.index[1]), reflection_phase(cosine, b.index[2])};
  return {{BsdfSample{direction, reflectance(b, cosine), 1, Lobe::specular, false, phase}}, 1};
}

/// Draws a visible microfacet, or, for the light of multiple scattering, a direction by cosθ/π.
inline std::optional<BsdfSample> sample(const ConductorBsdf& b, Vec3 outgoing, double u_lobe, Vec2 u) {
  if (b.is_smooth()) {
    const SpecularBranches mirror = branches(b, outgoing);
    return mirror.count ? std::optional(mirror.ways[0]) : std::nullopt;
  }
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing;
  const double loss = b.rough.loss(o.z);
  const Vec3 i = sample_reflection(b.rough, o, loss, u_lobe, u), direction = view.world(i);
  const double probability = pdf_reflection(b.rough, o, i, loss);
  if (!(probability > 0) || dot(b.geometric_normal, direction) <= 0) return std::nullopt;
  const Vec3 value = eval_reflection(b.rough, o, i, [&](double cosine) { return reflectance(b, cosine); });
  return BsdfSample{direction, value / probability, probability, Lobe::glossy, false, {}};
}

}  // namespace holotrace
