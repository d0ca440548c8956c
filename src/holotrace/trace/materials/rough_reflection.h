#pragma once

#include <cmath>

#include "holotrace/base/vec.h"
#include "holotrace/trace/materials/microfacet.h"
#include "holotrace/trace/materials/microfacet_albedo.h"
#include "holotrace/trace/materials/shading_frame.h"
#include "holotrace/trace/shared/sampling.h"

namespace holotrace {

/// Energy-conserving reflection off a rough surface of GGX microfacets, for metals and coats:
///
///     f = F(o·h)·D(h)·G₂(o, i)/(4·cosθ_o·cosθ_i) + K·(1 − E(o))·(1 − E(i))/π,
///
/// The second term is the light that meets more than one microfacet (Kulla and Conty, Revisiting physically
/// based shading at Imageworks, SIGGRAPH 2017 course). E is the albedo of white microfacets, Ē its mean over the
/// hemisphere, K that of multiple_reflection. Directions are local to the surface, o.z > 0. Functions that need the
/// reflectance F take it as `reflectance(cosine)`, at the lines.
struct RoughReflection {
  double alpha = 1;           ///< α of the GGX distribution, from smooth_alpha to 1
  MicrofacetAlbedo albedo{};  ///< albedos at this α
  Vec3 multiple{};            ///< K at the lines

  /// 1 − E: the loss of single scattering.
  double loss(double cosine) const { return albedo.at(cosine).loss; }
};

/// K = F̄²·Ē/((1 − Ē)·(1 − F̄·(1 − Ē))) for microfacets with the mean reflectance F̄ = 2∫F·μ dμ. K·(1 − Ē) is the
/// albedo of multiple scattering, relative to the light that single scattering loses: 1 for F̄ = 1.
///
/// @param mean_loss  1 − Ē
inline double multiple_reflection(double mean_reflectance, double mean_loss) {
  if (mean_loss < 1e-6) return 0;
  const double f = mean_reflectance;
  return f * f * (1 - mean_loss) / (mean_loss * (1 - f * mean_loss));
}

/// f·cosθ_i; 0 below the surface.
template <class Reflectance>
Vec3 eval_reflection(const RoughReflection& r, Vec3 o, Vec3 i, const Reflectance& reflectance) {
  if (i.z <= 0) return {};
  const Vec3 h = normalize(o + i);
  const double single = ggx_density(h, r.alpha) * smith_masking_shadowing(o, i, r.alpha) / (4 * o.z);
  return reflectance(std::fmin(1, dot(o, h))) * single + r.multiple * (r.loss(o.z) * r.loss(i.z) * i.z / pi);
}

/// Density of sample_reflection [1/sr].
inline double pdf_reflection(const RoughReflection& r, Vec3 o, Vec3 i, double diffuse) {
  if (i.z <= 0) return 0;
  const double single = smith_masking(o, r.alpha) * ggx_density(normalize(o + i), r.alpha) / (4 * o.z);
  return (1 - diffuse) * single + diffuse * i.z / pi;
}

/// Draws a direction: with the probability `diffuse` by cosθ/π, for multiple scattering; else the mirror image of o
/// in a visible microfacet. A direction with z ≤ 0 means that the light is lost.
inline Vec3 sample_reflection(const RoughReflection& r, Vec3 o, double diffuse, double u_choice, Vec2 u) {
  return u_choice < diffuse ? sample_cosine({0, 0, 1}, u.x, u.y) : reflect(o, sample_visible_normal(o, r.alpha, u));
}

}  // namespace holotrace
