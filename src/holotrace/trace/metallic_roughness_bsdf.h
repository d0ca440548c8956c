#pragma once

#include <optional>

#include "holotrace/trace/fresnel.h"
#include "holotrace/trace/lobe.h"
#include "holotrace/trace/microfacet.h"
#include "holotrace/trace/microfacet_albedo.h"
#include "holotrace/trace/sampling.h"
#include "holotrace/trace/shading_frame.h"

namespace holotrace {

/// The metallic-roughness model of glTF 2.0 (Khronos, 2021, appendix B): a glossy lobe of GGX microfacets, specular
/// when smooth, with Schlick's reflectance from F₀ = 0.04 to the base colour c by `metallic` m, over a diffuse base,
///
///     f = F·D·G₂/(4·cosθ_o·cosθ_i) + (1 − m)·c/π · (1 − E(o))·(1 − E(i))/(1 − Ē),   F = F₀ + (1 − F₀)(1 − o·h)⁵.
///
/// E is the albedo of a coat of F₀ = 0.04, Ē its mean: the reciprocal coupling of Kelemen and Szirmay-Kalos
/// (Eurographics 2001), with which a white dielectric reflects exactly everything. The appendix's own example, 1 −
/// F(o·h), reflects more than it receives at grazing angles. As there, microfacets scatter once: a rough metal is
/// darker than its base colour.
struct MetallicRoughnessBsdf {
  static constexpr double coat = 0.04;  ///< F₀ of the dielectric, index 1.5

  Vec3 normal, geometric_normal;
  Vec3 base;                  ///< (1 − m)·c/(1 − Ē)
  Vec3 f0;                    ///< F₀ of the mix
  double alpha = 0;           ///< below smooth_alpha: specular
  double brightest_base = 0;  ///< largest of (1 − m)·c
  double brightest_f0 = 0;    ///< largest of F₀
  MicrofacetAlbedo albedo{};  ///< of a rough one

  bool is_smooth() const { return alpha < smooth_alpha; }

  /// Albedos of single microfacets, or of the smooth surface.
  MicrofacetAlbedo::Value at(double cosine) const {
    return is_smooth() ? MicrofacetAlbedo::Value{0, schlick_weight(cosine)} : albedo.at(cosine);
  }

  Vec3 reflectance(double cosine) const { return f0 + (Vec3{1, 1, 1} - f0) * schlick_weight(cosine); }
};

/// @param colour    base colour c at the lines, each in [0, 1]
/// @param metallic  in [0, 1]
/// @param alpha     of the GGX distribution, at most 1
inline MetallicRoughnessBsdf make_metallic_roughness_bsdf(Vec3 normal, Vec3 geometric_normal, Vec3 colour,
                                                          double metallic, double alpha) {
  constexpr double coat = MetallicRoughnessBsdf::coat;
  MetallicRoughnessBsdf b{
      normal, geometric_normal, {}, Vec3{coat, coat, coat} * (1 - metallic) + colour * metallic, alpha};
  if (!b.is_smooth()) b.albedo = MicrofacetAlbedo(alpha);
  // 2∫(1 − μ)⁵·μ dμ = 1/21
  const MicrofacetAlbedo::Value mean = b.is_smooth() ? MicrofacetAlbedo::Value{0, 1.0 / 21} : b.albedo.mean();
  b.base = colour * ((1 - metallic) / (1 - mean.reflected(coat)));
  b.brightest_base = max_component(colour) * (1 - metallic);
  b.brightest_f0 = max_component(b.f0);
  return b;
}

inline LobeSet lobes(const MetallicRoughnessBsdf& b) {
  return {.has_diffuse = max_component(b.base) > 0, .has_glossy = !b.is_smooth()};
}

/// Probability to draw the diffuse lobe: its albedo over that of both, in the brightest lines.
inline double diffuse_probability(const MetallicRoughnessBsdf& b, const MicrofacetAlbedo::Value& albedo) {
  const double diffuse = b.brightest_base * (1 - albedo.reflected(MetallicRoughnessBsdf::coat));
  const double sum = diffuse + albedo.reflected(b.brightest_f0);
  return sum > 0 ? diffuse / sum : 1;
}

inline Vec3 eval(const MetallicRoughnessBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe == Lobe::specular || dot(b.geometric_normal, incoming) <= 0) return {};
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing, i = view.local(incoming);
  if (i.z <= 0) return {};
  if (lobe == Lobe::diffuse) {
    constexpr double coat = MetallicRoughnessBsdf::coat;
    return b.base * ((1 - b.at(o.z).reflected(coat)) * (1 - b.at(i.z).reflected(coat)) * i.z / pi);
  }
  if (b.is_smooth()) return {};
  const Vec3 h = normalize(o + i);
  return b.reflectance(std::fmin(1, dot(o, h))) *
         (ggx_density(h, b.alpha) * smith_masking_shadowing(o, i, b.alpha) / (4 * o.z));
}

inline double pdf(const MetallicRoughnessBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe == Lobe::specular || dot(b.geometric_normal, incoming) <= 0) return 0;
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing, i = view.local(incoming);
  if (i.z <= 0) return 0;
  const double diffuse = diffuse_probability(b, b.at(o.z));
  if (lobe == Lobe::diffuse) return diffuse * i.z / pi;
  if (b.is_smooth()) return 0;
  return (1 - diffuse) * smith_masking(o, b.alpha) * ggx_density(normalize(o + i), b.alpha) / (4 * o.z);
}

/// The way of a smooth coat or metal, with its whole weight. Its phase is π: that of air to a denser medium.
inline SpecularBranches branches(const MetallicRoughnessBsdf& b, Vec3 outgoing) {
  if (!b.is_smooth()) return {};
  const Vec3 normal = facing_normal(b.normal, outgoing), direction = reflect(outgoing, normal);
  if (dot(b.geometric_normal, direction) <= 0) return {};
  const Vec3 weight = b.reflectance(std::fmin(1, dot(outgoing, normal)));
  return {{BsdfSample{direction, weight, 1, Lobe::specular, false, {pi, pi, pi}}}, 1};
}

inline std::optional<BsdfSample> sample(const MetallicRoughnessBsdf& b, Vec3 outgoing, double u_lobe, Vec2 u) {
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing;
  const MicrofacetAlbedo::Value albedo = b.at(o.z);
  const double diffuse = diffuse_probability(b, albedo);
  if (u_lobe >= diffuse && b.is_smooth()) {
    SpecularBranches way = branches(b, outgoing);
    if (way.count == 0) return std::nullopt;
    way.ways[0].pdf = 1 - diffuse;
    way.ways[0].weight = way.ways[0].weight / way.ways[0].pdf;
    return way.ways[0];
  }
  const bool is_diffuse = u_lobe < diffuse;
  const Vec3 i = is_diffuse ? sample_cosine({0, 0, 1}, u.x, u.y) : reflect(o, sample_visible_normal(o, b.alpha, u));
  if (i.z <= 0) return std::nullopt;
  const Vec3 direction = view.world(i);
  if (dot(b.geometric_normal, direction) <= 0) return std::nullopt;
  if (is_diffuse) {
    constexpr double coat = MetallicRoughnessBsdf::coat;
    const Vec3 weight = b.base * ((1 - albedo.reflected(coat)) * (1 - b.at(i.z).reflected(coat)) / diffuse);
    return BsdfSample{direction, weight, diffuse * i.z / pi, Lobe::diffuse, false, {}};
  }
  const Vec3 h = normalize(o + i);
  const double masking = smith_masking(o, b.alpha);
  const double probability = (1 - diffuse) * masking * ggx_density(h, b.alpha) / (4 * o.z);
  if (!(probability > 0)) return std::nullopt;
  const Vec3 weight =
      b.reflectance(std::fmin(1, dot(o, h))) * (smith_masking_shadowing(o, i, b.alpha) / (masking * (1 - diffuse)));
  return BsdfSample{direction, weight, probability, Lobe::glossy, false, {}};
}

}  // namespace holotrace
