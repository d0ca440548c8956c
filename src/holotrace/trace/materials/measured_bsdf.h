#pragma once

#include <optional>

#include "holotrace/data/rgl_brdf.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/materials/microfacet.h"

namespace holotrace {

/// The BRDF at the lines for unit vectors to viewer and light in the coordinates of the surface, z > 0 [1/sr].
///
/// - A table of MERL is linear between the middles of its cells and constant beyond the outermost. Its red, green and blue are
///   colours of the scene (Lines::from_rgb).
/// - Of a file of RGL, the half vector h is mapped to the unit square by the density of visible half vectors, and
///
///       f·cosθ = S(φ_o, θ_o, λ; square)·D(h)/(4·σ(o))
///
///   linear between the entries of the tables. If the surface is brushed, x is along the tangent.
Vec3 eval_measured(const MeasuredBrdf& brdf, Vec3 outgoing, Vec3 incoming, const Lines& lines);

/// A measured surface (data/measured_brdf.h): all of its light counts as glossy. Directions are drawn by a GGX lobe and by cosθ/π,
/// in the shares that the table asks for; both densities are exact.
struct MeasuredBsdf {
  Vec3 normal, geometric_normal;
  const MeasuredBrdf* brdf;
  Lines lines;
  RoughReflection lobe;
  Vec3 tangent;  ///< 0 if the surface is the same in all directions along it
};

inline MeasuredBsdf make_measured_bsdf(const SurfacePoint& point, const MeasuredBrdf& brdf, const Lines& lines) {
  const Vec3 tangent = is_brushed(brdf) ? surface_tangent(point).along : Vec3{};
  return {point.normal, point.geometric_normal, &brdf, lines, {brdf.alpha}, tangent};
}

inline LobeSet lobes(const MeasuredBsdf&) { return {.has_glossy = true}; }

/// f·cosθ_i of directions in the coordinates of the surface.
inline Vec3 eval_local(const MeasuredBsdf& b, Vec3 outgoing, Vec3 incoming) {
  if (incoming.z <= 0) return {};
  return eval_measured(*b.brdf, outgoing, incoming, b.lines) * incoming.z;
}

inline Vec3 eval(const MeasuredBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::glossy || dot(b.geometric_normal, incoming) <= 0) return {};
  const ShadingView view(b.normal, outgoing, b.tangent);
  return eval_local(b, view.outgoing, view.local(incoming));
}

inline double pdf(const MeasuredBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::glossy || dot(b.geometric_normal, incoming) <= 0) return 0;
  const ShadingView view(b.normal, outgoing, b.tangent);
  return pdf_reflection(b.lobe, view.outgoing, view.local(incoming), b.brdf->diffuse_share);
}

inline std::optional<BsdfSample> sample(const MeasuredBsdf& b, Vec3 outgoing, double u_lobe, Vec2 u) {
  const ShadingView view(b.normal, outgoing, b.tangent);
  const Vec3 i = sample_reflection(b.lobe, view.outgoing, b.brdf->diffuse_share, u_lobe, u), direction = view.world(i);
  const double probability = pdf_reflection(b.lobe, view.outgoing, i, b.brdf->diffuse_share);
  if (!(probability > 0) || dot(b.geometric_normal, direction) <= 0) return std::nullopt;
  return BsdfSample{direction, eval_local(b, view.outgoing, i) / probability, probability, Lobe::glossy, false, {}};
}

inline SpecularBranches branches(const MeasuredBsdf&, Vec3) { return {}; }

}  // namespace holotrace
