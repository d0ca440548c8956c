#pragma once

#include <array>
#include <complex>
#include <optional>

#include "holotrace/trace/fresnel.h"
#include "holotrace/trace/lobe.h"
#include "holotrace/trace/microfacet.h"
#include "holotrace/trace/microfacet_albedo.h"
#include "holotrace/trace/sampling.h"
#include "holotrace/trace/shading_frame.h"

namespace holotrace {

/// A metal in air: a mirror (specular), or GGX microfacets (glossy),
///
///     f = F(o·h)·D(h)·G₂(o, i)/(4·cosθ_o·cosθ_i) + K·(1 − E(o))·(1 − E(i))/π,
///
/// whose second term is the light that meets more than one microfacet (Kulla and Conty, Revisiting physically
/// based shading at Imageworks, SIGGRAPH 2017 course): E the albedo of white microfacets, Ē and F̄ means over the
/// hemisphere, K = F̄²·Ē/((1 − Ē)·(1 − F̄·(1 − Ē))). A white rough metal then reflects everything; phases follow
/// only mirrors.
struct ConductorBsdf {
  Vec3 normal, geometric_normal;
  std::array<std::complex<double>, 3> index;  ///< at the lines
  bool is_grey = false;                       ///< the same index at all three
  double alpha = 0;                           ///< below smooth_alpha: a mirror
  MicrofacetAlbedo albedo{};                  ///< of a rough one
  Vec3 multiple{};                            ///< K at the lines

  bool is_smooth() const { return alpha < smooth_alpha; }
};

inline Vec3 reflectance(const ConductorBsdf& b, double cosine) {
  const double first = reflectance_conductor(cosine, b.index[0]);
  if (b.is_grey) return {first, first, first};
  return {first, reflectance_conductor(cosine, b.index[1]), reflectance_conductor(cosine, b.index[2])};
}

/// @param index  n + ik at the lines
/// @param alpha  of the GGX distribution, at most 1
inline ConductorBsdf make_conductor_bsdf(Vec3 normal, Vec3 geometric_normal,
                                         const std::array<std::complex<double>, 3>& index, double alpha) {
  ConductorBsdf b{normal, geometric_normal, index, index[0] == index[1] && index[1] == index[2], alpha};
  if (b.is_smooth()) return b;
  b.albedo = MicrofacetAlbedo(alpha);
  const double loss = b.albedo.mean().loss;
  if (loss < 1e-6) return b;
  // F̄ = 2∫F·μ dμ by the three points of Gauss and Jacobi, exact to the fifth power: Schlick's.
  constexpr double nodes[] = {0.2123405382391529, 0.5905331355592653, 0.9114120404872961};
  constexpr double weights[] = {0.1396539598029080, 0.4584822127191740, 0.4018638274779180};
  Vec3 mean;
  for (int i = 0; i < 3; ++i) mean += reflectance(b, nodes[i]) * weights[i];
  const auto factor = [&](double f) { return f * f * (1 - loss) / (loss * (1 - f * loss)); };
  b.multiple = {factor(mean.x), factor(mean.y), factor(mean.z)};
  return b;
}

inline LobeSet lobes(const ConductorBsdf& b) { return {.has_glossy = !b.is_smooth()}; }

inline Vec3 eval(const ConductorBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::glossy || b.is_smooth() || dot(b.geometric_normal, incoming) <= 0) return {};
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing, i = view.local(incoming);
  if (i.z <= 0) return {};
  const Vec3 h = normalize(o + i);
  const double single = ggx_density(h, b.alpha) * smith_masking_shadowing(o, i, b.alpha) / (4 * o.z);
  return reflectance(b, std::fmin(1, dot(o, h))) * single +
         b.multiple * (b.albedo.at(o.z).loss * b.albedo.at(i.z).loss * i.z / pi);
}

inline double pdf(const ConductorBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::glossy || b.is_smooth() || dot(b.geometric_normal, incoming) <= 0) return 0;
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing, i = view.local(incoming);
  if (i.z <= 0) return 0;
  const double single = smith_masking(o, b.alpha) * ggx_density(normalize(o + i), b.alpha) / (4 * o.z);
  const double loss = b.albedo.at(o.z).loss;
  return (1 - loss) * single + loss * i.z / pi;
}

/// The way of a mirror, with its whole weight.
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

/// Draws a visible microfacet, or by cosθ/π for the part of the light that single scattering leaves out.
inline std::optional<BsdfSample> sample(const ConductorBsdf& b, Vec3 outgoing, double u_lobe, Vec2 u) {
  if (b.is_smooth()) {
    const SpecularBranches mirror = branches(b, outgoing);
    return mirror.count ? std::optional(mirror.ways[0]) : std::nullopt;
  }
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing;
  const double loss = b.albedo.at(o.z).loss;
  const Vec3 i = u_lobe < loss ? sample_cosine({0, 0, 1}, u.x, u.y) : reflect(o, sample_visible_normal(o, b.alpha, u));
  if (i.z <= 0) return std::nullopt;
  const Vec3 direction = view.world(i);
  if (dot(b.geometric_normal, direction) <= 0) return std::nullopt;
  const Vec3 h = normalize(o + i);
  const double density = ggx_density(h, b.alpha) / (4 * o.z);
  const double probability = (1 - loss) * density * smith_masking(o, b.alpha) + loss * i.z / pi;
  if (!(probability > 0)) return std::nullopt;
  const Vec3 value = reflectance(b, std::fmin(1, dot(o, h))) * (density * smith_masking_shadowing(o, i, b.alpha)) +
                     b.multiple * (loss * b.albedo.at(i.z).loss * i.z / pi);
  return BsdfSample{direction, value / probability, probability, Lobe::glossy, false, {}};
}

}  // namespace holotrace
