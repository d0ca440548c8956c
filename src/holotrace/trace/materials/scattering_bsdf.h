#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/trace/materials/droplets.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/shared/sampling.h"

namespace holotrace {

/// Scattering by a particle of a medium: a phase function p times the albedo. There is no surface and no cosine. It counts as a
/// glossy lobe (G), because light differs from direction to direction. The phase function of Henyey and Greenstein (Astrophysical
/// Journal 93, 70, 1941) is
///
///     p(cosθ) = (1 − g²)/(4π·(1 + g² − 2g·cosθ)^(3/2)),   ∫p dω = 1,   ∫p·cosθ dω = g,
///
/// θ being the angle by which light is turned. Those of droplets (droplets.h) differ from line to line; directions are drawn with
/// the mean of the three.
struct ScatteringBsdf {
  Vec3 albedo;  ///< at the lines
  double g = 0;
  std::array<const PhaseTable*, 3> droplets{};  ///< at the lines, in place of g; nullptr: g
};

/// Density of directions turned by an angle of this cosine [1/sr]. 1 + g² − 2g·cosθ is the sum of two parts of 0 or more, because its
/// own terms cancel in the peak.
inline double phase_function(double g, double cosine) {
  const double size = std::abs(g), rest = 1 - size;
  const double squared = rest * rest + 2 * size * std::fmax(0, 1 - std::copysign(1.0, g) * cosine);
  return rest * (1 + size) / (4 * pi * squared * std::sqrt(squared));
}

/// The same at the lines.
inline Vec3 phase_functions(const ScatteringBsdf& b, double cosine) {
  if (!b.droplets[0]) return Vec3{1, 1, 1} * phase_function(b.g, cosine);
  return {b.droplets[0]->at(cosine), b.droplets[1]->at(cosine), b.droplets[2]->at(cosine)};
}

inline double mean_of_lines(Vec3 v) { return (v.x + v.y + v.z) / 3; }

inline LobeSet lobes(const ScatteringBsdf&) { return {.has_glossy = true}; }

inline double pdf(const ScatteringBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  return lobe == Lobe::glossy ? mean_of_lines(phase_functions(b, -dot(outgoing, incoming))) : 0;
}

inline Vec3 eval(const ScatteringBsdf& b, Vec3 outgoing, Vec3 incoming, Lobe lobe) {
  return lobe == Lobe::glossy ? b.albedo * phase_functions(b, -dot(outgoing, incoming)) : Vec3{};
}

/// Draws a direction by the phase function, whose integral over cosθ is inverted; that of a line which `u_lobe` draws.
inline std::optional<BsdfSample> sample(const ScatteringBsdf& b, Vec3 outgoing, double u_lobe, Vec2 u) {
  double cosine = 2 * u.x - 1;
  if (b.droplets[0]) {
    cosine = b.droplets[std::min<size_t>(2, size_t(3 * u_lobe))]->sample(u.x);
  } else if (std::abs(b.g) > 1e-4) {
    const double part = (1 - b.g * b.g) / (1 + b.g * cosine);
    cosine = std::fmin(1, std::fmax(-1, (1 + b.g * b.g - part * part) / (2 * b.g)));
  }
  const double sine = std::sqrt(std::fmax(0, 1 - cosine * cosine));
  const Vec2 around = point_on_circle(u.y);
  const Vec3 direction = transform_vector(frame_from_normal(-outgoing), {sine * around.x, sine * around.y, cosine});
  const double density = pdf(b, outgoing, direction, Lobe::glossy);
  return BsdfSample{direction, eval(b, outgoing, direction, Lobe::glossy) / density, density, Lobe::glossy, false, {}};
}

inline SpecularBranches branches(const ScatteringBsdf&, Vec3) { return {}; }

}  // namespace holotrace
