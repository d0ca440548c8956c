#pragma once

#include <string>
#include <vector>

#include "holotrace/base/vec.h"

namespace holotrace {

/// Coefficients of a substance in red, green and blue [1/m]. Scattering is the reduced one, σ_s′ = (1 − g)·σ_s, to be used with
/// g = 0.
struct NamedMedium {
  std::string name;
  Vec3 scattering, absorption;
};

/// The substances measured by H. W. Jensen, S. Marschner, M. Levoy and P. Hanrahan, A Practical Model for Subsurface Light
/// Transport, SIGGRAPH 2001, figure 5. Their refractive index there is 1.3, that of marble 1.5.
const std::vector<NamedMedium>& named_media();

/// The substance of that name. @throws Error for an unknown name, suggesting the nearest
const NamedMedium& medium_named(const std::string& name);

}  // namespace holotrace
