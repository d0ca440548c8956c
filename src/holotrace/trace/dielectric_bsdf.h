#pragma once

#include <optional>

#include "holotrace/trace/fresnel.h"
#include "holotrace/trace/lobe.h"
#include "holotrace/trace/microfacet.h"
#include "holotrace/trace/sampling.h"
#include "holotrace/trace/shading_frame.h"

namespace holotrace {

/// The boundary of glass, water or crystal with air: smooth (specular), or of GGX microfacets (glossy; Walter et al.,
/// EGSR 2007, with the heights of a reflection correlated); or a thin pane.
///
/// Radiance is traced from the viewer, and L/n² is what a lossless boundary keeps: refraction brings
/// (1 − F)·(n_near/n_far)²·L, as a given flux fills n² as much solid angle. Into glass and out again the factors
/// cancel; lights inside glass are seen with theirs. In equilibrium the radiance is n², and the two ways bring
/// F·n_near² + (1 − F)·(n_near/n_far)²·n_far² = n_near².
///
/// Rough boundaries scatter once: light that meets a second microfacet is lost. Of a furnace, n = 1.5, up to 60° from
/// the normal, roughness 0.2, 0.5 and 1 keep 0.998, 0.95 and 0.67 seen from air, 0.99, 0.82 and 0.41 seen from inside,
/// where total reflection sends light onto its neighbours; at grazing angles 0.90, 0.79 and 0.36.
///
/// A pane (Born & Wolf 1.5) is smooth and without a thickness: the light goes straight through, and the many
/// reflections between its faces add up by their power, R' = R + T²R/(1 − R²) = 2R/(1 + R), T' = 1 − R'. Its phases are
/// those of the first face.
struct DielectricBsdf {
  Vec3 normal, geometric_normal;
  double index = 1;  ///< of the far medium over that of the near one, at the first line
  double alpha = 0;  ///< below smooth_alpha: smooth
  bool is_thin = false;

  /// Equal media have no boundary to be rough.
  bool is_smooth() const { return is_thin || alpha < smooth_alpha || std::fabs(index - 1) < 1e-6; }
};

inline LobeSet lobes(const DielectricBsdf& b) { return {.has_glossy = !b.is_smooth()}; }

/// The microfacet normal that turns `o` into `i`, both local, on the near side; 0 if there is none.
inline Vec3 half_vector(const DielectricBsdf& b, Vec3 o, Vec3 i) {
  if (i.z == 0) return {};
  if (i.z > 0) return normalize(o + i);
  const Vec3 sum = o + i * b.index;
  if (sum.z == 0) return {};
  const Vec3 h = normalize(sum.z > 0 ? sum : -sum);
  return dot(o, h) > 0 && dot(i, h) < 0 ? h : Vec3{};
}

/// dω_h/dω_i of refraction about h: index²·|i·h|/(o·h + index·i·h)² (Walter et al., eq. 17).
inline double refraction_jacobian(const DielectricBsdf& b, Vec3 o, Vec3 i, Vec3 h) {
  const double sum = dot(o, h) + b.index * dot(i, h);
  return b.index * b.index * std::fabs(dot(i, h)) / (sum * sum);
}

inline Vec3 eval(const DielectricBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::glossy || b.is_smooth()) return {};
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing, i = view.local(incoming);
  if ((dot(b.geometric_normal, incoming) > 0) != (i.z > 0)) return {};
  const Vec3 h = half_vector(b, o, i);
  if (h.z <= 0) return {};
  const double cosine = std::fmin(1, dot(o, h)), density = ggx_density(h, b.alpha);
  const double reflected = reflectance_dielectric(cosine, b.index);
  const double value = i.z > 0 ? reflected * density * smith_masking_shadowing(o, i, b.alpha) / (4 * o.z)
                               : (1 - reflected) * density * smith_masking(o, b.alpha) * smith_masking(i, b.alpha) *
                                     cosine / o.z * refraction_jacobian(b, o, i, h) / (b.index * b.index);
  return {value, value, value};
}

inline double pdf(const DielectricBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::glossy || b.is_smooth()) return 0;
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing, i = view.local(incoming);
  if ((dot(b.geometric_normal, incoming) > 0) != (i.z > 0)) return 0;
  const Vec3 h = half_vector(b, o, i);
  if (h.z <= 0) return 0;
  const double cosine = std::fmin(1, dot(o, h)), reflected = reflectance_dielectric(cosine, b.index);
  const double normals = pdf_visible_normal(o, h, b.alpha);
  return i.z > 0 ? reflected * normals / (4 * cosine) : (1 - reflected) * normals * refraction_jacobian(b, o, i, h);
}

/// Reflection, then refraction where there is one, each with its whole weight.
inline SpecularBranches branches(const DielectricBsdf& b, Vec3 outgoing) {
  SpecularBranches result;
  if (!b.is_smooth()) return result;
  const Vec3 normal = facing_normal(b.normal, outgoing);
  const double cosine = std::fmin(1, dot(outgoing, normal));
  double reflected = reflectance_dielectric(cosine, b.index), scale = 1 / (b.index * b.index);
  if (b.is_thin) {
    reflected = 2 * reflected / (1 + reflected);
    scale = 1;
  }
  const auto add = [&](Vec3 direction, double weight, double squared_index_ratio, bool is_transmission, double phase) {
    if (weight <= 0 || (dot(b.geometric_normal, direction) < 0) != is_transmission) return;
    weight *= squared_index_ratio;
    result.ways[size_t(result.count++)] = {direction,          {weight, weight, weight}, 1,
                                           Lobe::specular,     is_transmission,          {phase, phase, phase},
                                           squared_index_ratio};
  };
  if (reflected > 0) add(reflect(outgoing, normal), reflected, 1, false, reflection_phase(cosine, b.index));
  if (reflected < 1) add(b.is_thin ? -outgoing : refract(outgoing, normal, b.index), 1 - reflected, scale, true, 0);
  return result;
}

/// Draws reflection or refraction by Fresnel's reflectance, of the surface or of a visible microfacet.
inline std::optional<BsdfSample> sample(const DielectricBsdf& b, Vec3 outgoing, double u_lobe, Vec2 u) {
  if (b.is_smooth()) {
    const SpecularBranches both = branches(b, outgoing);
    double passed = 0;
    for (int k = 0; k < both.count; ++k) {
      BsdfSample way = both.ways[size_t(k)];
      way.pdf = way.weight.x / way.squared_index_ratio;
      passed += way.pdf;
      if (u_lobe >= passed && !(k + 1 == both.count && passed > 1 - 1e-9)) continue;
      way.weight = way.weight / way.pdf;
      return way;
    }
    return std::nullopt;
  }
  const ShadingView view(b.normal, outgoing);
  const Vec3 o = view.outgoing, h = sample_visible_normal(o, b.alpha, u);
  const double cosine = std::fmin(1, dot(o, h));
  if (cosine <= 0) return std::nullopt;
  const double reflected = reflectance_dielectric(cosine, b.index);
  const bool is_transmission = u_lobe >= reflected;
  const Vec3 i = is_transmission ? refract(o, h, b.index) : reflect(o, h);
  if ((i.z < 0) != is_transmission || i.z == 0) return std::nullopt;
  const Vec3 direction = view.world(i);
  if ((dot(b.geometric_normal, direction) < 0) != is_transmission) return std::nullopt;
  const double normals = pdf_visible_normal(o, h, b.alpha);
  const double scale = is_transmission ? 1 / (b.index * b.index) : 1;
  const double probability = is_transmission ? (1 - reflected) * normals * refraction_jacobian(b, o, i, h)
                                             : reflected * normals / (4 * cosine);
  if (!(probability > 0)) return std::nullopt;
  const double weight = is_transmission ? scale * smith_masking(i, b.alpha)
                                        : smith_masking_shadowing(o, i, b.alpha) / smith_masking(o, b.alpha);
  return BsdfSample{direction, {weight, weight, weight}, probability, Lobe::glossy, is_transmission, {}, scale};
}

}  // namespace holotrace
