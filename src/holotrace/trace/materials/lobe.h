#pragma once

#include <array>
#include <cstdint>

#include "holotrace/base/vec.h"

namespace holotrace {

/// A lobe of a BSDF, as named in light path expressions: diffuse D, glossy G, specular S.
enum class Lobe : uint8_t { diffuse, glossy, specular };

/// The lobes with a density that a BSDF has.
struct LobeSet {
  bool has_diffuse = false, has_glossy = false;
};

/// A direction that a BSDF draws.
struct BsdfSample {
  Vec3 direction;  ///< unit, away from the surface
  Vec3 weight;     ///< f·|cosθ|/pdf of the lobe drawn; the pdf includes the lobe's probability
  double pdf = 0;  ///< [1/sr], with the lobe's probability; for a specular branch that probability alone
  Lobe lobe = Lobe::diffuse;
  bool is_transmission = false;
  Vec3 phase;  ///< phase that the surface adds at the lines [rad]: Fresnel's for a specular branch, else 0
  /// The factor (n_near/n_far)² in the weight of a refraction, 1 for everything else. It is not a loss: leaving the
  /// medium undoes it. Russian roulette divides it out.
  double squared_index_ratio = 1;
};

/// The directions in which a specular lobe sends light.
struct SpecularBranches {
  std::array<BsdfSample, 2> ways;
  int count = 0;
};

}  // namespace holotrace
