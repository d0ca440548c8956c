#pragma once

#include <optional>

#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/shared/ray.h"
#include "holotrace/trace/shared/sampling.h"

namespace holotrace {

/// Lambertian reflection and transmission: f = ρ/π on the viewer's side, τ/π on the other.
struct DiffuseBsdf {
  Vec3 normal, geometric_normal;
  Vec3 reflectance, transmittance;  ///< ρ and τ at the lines, ρ + τ ≤ 1
  double transmission_probability = 0;
};

inline LobeSet lobes(const DiffuseBsdf&) { return {.has_diffuse = true}; }

inline Vec3 eval(const DiffuseBsdf& b, Vec3, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::diffuse) return {};
  const bool is_transmission = dot(b.geometric_normal, incoming) < 0;
  const Vec3 normal = is_transmission ? -b.normal : b.normal;
  return (is_transmission ? b.transmittance : b.reflectance) * pdf_cosine(normal, incoming);
}

inline double pdf(const DiffuseBsdf& b, Vec3, Vec3 incoming, Lobe lobe) {
  if (lobe != Lobe::diffuse) return 0;
  const bool is_transmission = dot(b.geometric_normal, incoming) < 0;
  return is_transmission ? b.transmission_probability * pdf_cosine(-b.normal, incoming)
                         : (1 - b.transmission_probability) * pdf_cosine(b.normal, incoming);
}

/// Draws a side, then a direction by cosθ/π.
inline std::optional<BsdfSample> sample(const DiffuseBsdf& b, Vec3, double u_lobe, Vec2 u) {
  const bool is_transmission = u_lobe < b.transmission_probability;
  const Vec3 normal = is_transmission ? -b.normal : b.normal;
  const Vec3 direction = sample_cosine(normal, u.x, u.y);
  if ((dot(b.geometric_normal, direction) < 0) != is_transmission) return std::nullopt;
  const double probability = is_transmission ? b.transmission_probability : 1 - b.transmission_probability;
  return BsdfSample{direction,
                    (is_transmission ? b.transmittance : b.reflectance) / probability,
                    probability * pdf_cosine(normal, direction),
                    Lobe::diffuse,
                    is_transmission,
                    {}};
}

inline SpecularBranches branches(const DiffuseBsdf&, Vec3) { return {}; }

}  // namespace holotrace
