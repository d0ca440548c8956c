#pragma once

#include <optional>

#include "holotrace/trace/materials/fresnel.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/materials/microfacet.h"
#include "holotrace/trace/shared/sampling.h"

namespace holotrace {

/// The metallic-roughness model of glTF 2.0 (Khronos, 2021, appendix B). With `metallic` m it mixes a metal whose F₀ is
/// the base colour c, and a dielectric coat of F₀ = 0.04 over a diffuse base of that colour,
///
///     f = (1 − m)·(f_coat + c/π · (1 − A(o))·(1 − A(i))/(1 − Ā)) + m·f_metal.
///
/// Metal and coat are GGX microfacets with Schlick's reflectance (glossy, microfacet.h; specular when smooth). A
/// is the albedo of the coat and Ā its mean: the reciprocal coupling of Kelemen and Szirmay-Kalos (Eurographics 2001).
/// A white metal and a white dielectric reflect everything at every roughness. The example in the appendix has single
/// scattering only, so rough metals are darker than their colour; it couples by 1 − F(o·h), which reflects more than it
/// receives at grazing angles.
struct MetallicRoughnessBsdf {
  static constexpr double coat = 0.04;  ///< F₀ of the dielectric, index 1.5

  Vec3 normal, geometric_normal;
  Vec3 base;                      ///< (1 − m)·c/(1 − Ā)
  Vec3 f0;                        ///< F₀ of the mixture
  RoughReflection rough{};        ///< glossy lobe of the mixture; specular if its α is below smooth_alpha
  double multiple_coat = 0;       ///< K of the coat
  double mean_loss = 0;           ///< 1 − Ē
  double brightest_base = 0;      ///< largest of (1 − m)·c
  double brightest_f0 = 0;        ///< largest of F₀
  double brightest_multiple = 0;  ///< largest of K

  bool is_smooth() const { return rough.alpha < smooth_alpha; }

  /// Albedos of single microfacets, or of the smooth surface.
  MicrofacetAlbedo::Value at(double cosine) const {
    return is_smooth() ? MicrofacetAlbedo::Value{0, schlick_weight(cosine)} : rough.albedo.at(cosine);
  }

  /// 1 − A: the fraction that the coat transmits.
  double through_coat(const MicrofacetAlbedo::Value& albedo) const {
    return 1 - albedo.reflected(coat) - multiple_coat * mean_loss * albedo.loss;
  }

  Vec3 reflectance(double cosine) const { return f0 + (Vec3{1, 1, 1} - f0) * schlick_weight(cosine); }
};

/// @param colour    base colour c at the lines, each in [0, 1]
/// @param metallic  fraction of metal m, in [0, 1]
/// @param alpha     α of the GGX distribution, at most 1
inline MetallicRoughnessBsdf make_metallic_roughness_bsdf(Vec3 normal, Vec3 geometric_normal, Vec3 colour,
                                                          double metallic, double alpha) {
  constexpr double coat = MetallicRoughnessBsdf::coat;
  MetallicRoughnessBsdf b{
      normal, geometric_normal, {}, Vec3{coat, coat, coat} * (1 - metallic) + colour * metallic, {alpha}};
  MicrofacetAlbedo::Value mean{0, 1.0 / 21};  // for a smooth surface: 2∫(1 − μ)⁵·μ dμ
  if (!b.is_smooth()) {
    b.rough.albedo = MicrofacetAlbedo(alpha);
    mean = b.rough.albedo.mean();
    b.mean_loss = mean.loss;
    const auto multiple = [&](double f0) { return multiple_reflection(f0 + (1 - f0) / 21, mean.loss); };
    b.multiple_coat = multiple(coat);
    b.rough.multiple = Vec3{1, 1, 1} * (b.multiple_coat * (1 - metallic)) +
                       Vec3{multiple(colour.x), multiple(colour.y), multiple(colour.z)} * metallic;
  }
  b.base = colour * ((1 - metallic) / b.through_coat(mean));
  b.brightest_base = max_component(colour) * (1 - metallic);
  b.brightest_f0 = max_component(b.f0);
  b.brightest_multiple = max_component(b.rough.multiple);
  return b;
}

inline LobeSet lobes(const MetallicRoughnessBsdf& b) {
  return {.has_diffuse = max_component(b.base) > 0, .has_glossy = !b.is_smooth()};
}

/// Probabilities of the lobes that `sample` draws, in proportion to the albedos in the brightest lines.
struct MetallicRoughnessChoice {
  double base = 1;      ///< probability of the diffuse lobe
  double multiple = 0;  ///< probability of drawing by cosθ/π inside the glossy lobe
};

inline MetallicRoughnessChoice choose(const MetallicRoughnessBsdf& b, const MicrofacetAlbedo::Value& albedo) {
  const double base = b.brightest_base * b.through_coat(albedo), single = albedo.reflected(b.brightest_f0);
  const double multiple = b.brightest_multiple * b.mean_loss * albedo.loss, glossy = single + multiple;
  if (!(glossy > 0)) return {};
  return {base / (base + glossy), multiple / glossy};
}

inline Vec3 eval(const MetallicRoughnessBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe == Lobe::specular || dot(b.geometric_normal, incoming) <= 0) return {};
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing, i = view.local(incoming);
  if (i.z <= 0) return {};
  if (lobe == Lobe::diffuse) return b.base * (b.through_coat(b.at(o.z)) * b.through_coat(b.at(i.z)) * i.z / pi);
  if (b.is_smooth()) return {};
  return eval_reflection(b.rough, o, i, [&](double cosine) { return b.reflectance(cosine); });
}

inline double pdf(const MetallicRoughnessBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe == Lobe::specular || dot(b.geometric_normal, incoming) <= 0) return 0;
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing, i = view.local(incoming);
  if (i.z <= 0) return 0;
  const MetallicRoughnessChoice choice = choose(b, b.at(o.z));
  if (lobe == Lobe::diffuse) return choice.base * i.z / pi;
  return b.is_smooth() ? 0 : (1 - choice.base) * pdf_reflection(b.rough, o, i, choice.multiple);
}

/// The branch of a smooth coat or metal, with its full weight. Its phase is π: reflection off a denser medium.
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
  const MetallicRoughnessChoice choice = choose(b, albedo);
  const double glossy = 1 - choice.base;
  if (u_lobe < choice.base) {
    const Vec3 i = sample_cosine({0, 0, 1}, u.x, u.y), direction = view.world(i);
    if (i.z <= 0 || dot(b.geometric_normal, direction) <= 0) return std::nullopt;
    const Vec3 weight = b.base * (b.through_coat(albedo) * b.through_coat(b.at(i.z)) / choice.base);
    return BsdfSample{direction, weight, choice.base * i.z / pi, Lobe::diffuse, false, {}};
  }
  if (b.is_smooth()) {
    SpecularBranches way = branches(b, outgoing);
    if (way.count == 0) return std::nullopt;
    way.ways[0].pdf = glossy;
    way.ways[0].weight = way.ways[0].weight / glossy;
    return way.ways[0];
  }
  const Vec3 i = sample_reflection(b.rough, o, choice.multiple, (u_lobe - choice.base) / glossy, u);
  const Vec3 direction = view.world(i);
  const double probability = glossy * pdf_reflection(b.rough, o, i, choice.multiple);
  if (!(probability > 0) || dot(b.geometric_normal, direction) <= 0) return std::nullopt;
  const Vec3 value = eval_reflection(b.rough, o, i, [&](double cosine) { return b.reflectance(cosine); });
  return BsdfSample{direction, value / probability, probability, Lobe::glossy, false, {}};
}

}  // namespace holotrace
