#pragma once

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"

// Microfacets of the GGX distribution with Smith's masking, in the local frame whose z is the surface normal.
// α scales the slopes: half of the microfacets (by projected area) are less steep than α. α = roughness².
// Walter et al., Microfacet models for refraction, EGSR 2007; Heitz, JCGT 3(2), 2014.

namespace holotrace {

/// Below this α a surface is smooth and has a specular lobe. A glossy lobe would be about 2α = 0.01° wide, less than
/// the diffraction of visible light at the pupil of an eye (3 mm).
inline constexpr double smooth_alpha = 1e-4;

/// Density of microfacet normals over projected area [1/sr]: ∫D(h)·cosθ_h dω = 1,
///
///     D = 1/(π·α²·cos⁴θ·(1 + tan²θ/α²)²).
inline double ggx_density(Vec3 h, double alpha) {
  if (h.z <= 0) return 0;
  const double cosine_squared = h.z * h.z, tangent_squared = (h.x * h.x + h.y * h.y) / cosine_squared;
  const double t = alpha * cosine_squared * (1 + tangent_squared / (alpha * alpha));
  return 1 / (pi * t * t);
}

/// Smith's Λ of a direction on either side, (−1 + √(1 + α²·tan²θ))/2: ratio of hidden area to visible area.
inline double smith_lambda(Vec3 w, double alpha) {
  const double cosine_squared = w.z * w.z;
  if (cosine_squared == 0) return HUGE_VAL;
  const double x = alpha * alpha * (w.x * w.x + w.y * w.y) / cosine_squared;
  return 0.5 * x / (1 + std::sqrt(1 + x));  // avoids the cancellation of −1 + √
}

/// Masking G₁ = 1/(1 + Λ): the fraction of the microfacets that is visible from a direction.
inline double smith_masking(Vec3 w, double alpha) { return 1 / (1 + smith_lambda(w, alpha)); }

/// Masking and shadowing of a reflection with correlated heights, G₂ = 1/(1 + Λ_o + Λ_i) (Heitz 2014, eq. 99).
inline double smith_masking_shadowing(Vec3 outgoing, Vec3 incoming, double alpha) {
  return 1 / (1 + smith_lambda(outgoing, alpha) + smith_lambda(incoming, alpha));
}

/// Draws a microfacet normal h among those visible from `outgoing` (z > 0), with density
/// D_o(h) = G₁(o)·max(0, o·h)·D(h)/o.z (Dupuy and Benyoub, Sampling visible GGX normals with spherical
/// caps, HPG 2023).
inline Vec3 sample_visible_normal(Vec3 outgoing, double alpha, Vec2 u) {
  const Vec3 o = normalize({alpha * outgoing.x, alpha * outgoing.y, outgoing.z});
  const double angle = 2 * pi * u.x, z = (1 - u.y) * (1 + o.z) - o.z, sine = std::sqrt(std::fmax(0, 1 - z * z));
  const Vec3 h = Vec3{sine * std::cos(angle), sine * std::sin(angle), z} + o;
  return normalize({alpha * h.x, alpha * h.y, std::fmax(1e-300, h.z)});
}

/// Density of sample_visible_normal [1/sr].
inline double pdf_visible_normal(Vec3 outgoing, Vec3 h, double alpha) {
  return smith_masking(outgoing, alpha) * std::fmax(0, dot(outgoing, h)) * ggx_density(h, alpha) / outgoing.z;
}

/// The mean of f(h) over the microfacet normals h visible to a viewer; f must be symmetric to its left and right. It is
/// a midpoint rule. In the height it uses v = 1 − (1 − t)³, because the loss comes from the few steep microfacets at
/// v near 1.
template <int azimuths, class Function>
auto mean_over_visible_normals(Vec3 outgoing, double alpha, const Function& f) {
  constexpr int heights = 96;
  decltype(f(outgoing)) sum{};
  for (int j = 0; j < heights; ++j) {
    const double s = 1 - (j + 0.5) / heights, measure = 3 * s * s / (azimuths * heights);
    for (int i = 0; i < azimuths; ++i)
      sum += f(sample_visible_normal(outgoing, alpha, {0.5 * (i + 0.5) / azimuths, 1 - s * s * s})) * measure;
  }
  return sum;
}

}  // namespace holotrace
