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
///
/// And snow, whose grains of ice have the radius a = 3·volume/surface and fill the fraction c of its volume:
///
///     σ_s′ = (1 − g)·3c/(2a),   σ_a = B·c·4πk/λ,   g = 0.76, B = 1.84   (irregular grains),
///
/// k from S. G. Warren and R. E. Brandt, J. Geophys. Res. 113, 2008. Fresh snow: 100 kg/m³, a = 65 µm; firn: 400 kg/m³, a = 0.5 mm.
/// It has no surface that bends light. Reference: A. A. Kokhanovsky and E. P. Zege, Scattering Optics of Snow, Appl. Opt. 43, 2004.
const std::vector<NamedMedium>& named_media();

/// The substance of that name. @throws Error for an unknown name, suggesting the nearest
const NamedMedium& medium_named(const std::string& name);

}  // namespace holotrace
