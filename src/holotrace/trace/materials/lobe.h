#pragma once

#include <array>
#include <cstdint>

#include "holotrace/base/vec.h"

namespace holotrace {

/// A part of a BSDF, an event of light path expressions: diffuse D, glossy G, specular S.
enum class Lobe : uint8_t { diffuse, glossy, specular };

/// Which of the lobes that have a density a BSDF has.
struct LobeSet {
  bool has_diffuse = false, has_glossy = false;
};

/// A direction that a BSDF draws.
struct BsdfSample {
  Vec3 direction;  ///< unit, away from the surface
  Vec3 weight;     ///< f·|cosθ|/pdf of the lobe drawn, the lobe's probability in the pdf
  double pdf = 0;  ///< [1/sr], with the lobe's probability; of a specular way that probability alone
  Lobe lobe = Lobe::diffuse;
  bool is_transmission = false;
  Vec3 phase;  ///< that the surface adds [rad] at the lines: Fresnel's of a specular way, else 0
  /// The part (n_near/n_far)² of the weight of a refraction, 1 of all else. It is no loss, and undone when the
  /// path leaves the medium: Russian roulette divides it out.
  double squared_index_ratio = 1;
};

/// The ways that a specular lobe sends light.
struct SpecularBranches {
  std::array<BsdfSample, 2> ways;
  int count = 0;
};

}  // namespace holotrace
