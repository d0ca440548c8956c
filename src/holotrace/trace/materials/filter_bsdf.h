#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "holotrace/base/vec.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/shared/sampling.h"

namespace holotrace {

/// A sheet that light passes straight on (FilterMaterial). Of unpolarised light it passes the mean of the transmittances along
/// its axis and across it; polarization.h has what it does to polarised light.
struct FilterBsdf {
  Vec3 normal, geometric_normal;
  Vec3 axis;                      ///< in the scene
  double along = 1, across = 0;   ///< transmittances
  std::array<double, 3> delay{};  ///< of the light along the axis, at the lines [rad]
};

inline LobeSet lobes(const FilterBsdf&) { return {}; }
inline Vec3 eval(const FilterBsdf&, Vec3, Vec3, Lobe) { return {}; }
inline double pdf(const FilterBsdf&, Vec3, Vec3, Lobe) { return 0; }

inline SpecularBranches branches(const FilterBsdf& b, Vec3 outgoing) {
  const double mean = 0.5 * (b.along + b.across);
  if (!(mean > 0)) return {};
  return {{BsdfSample{-outgoing, {mean, mean, mean}, 1, Lobe::specular, true, {}}}, 1};
}

inline std::optional<BsdfSample> sample(const FilterBsdf& b, Vec3 outgoing, double, Vec2) {
  const SpecularBranches straight = branches(b, outgoing);
  return straight.count ? std::optional(straight.ways[0]) : std::nullopt;
}

}  // namespace holotrace
