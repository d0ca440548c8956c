#pragma once

#include <cmath>
#include <numbers>

#include "holotrace/slm/panel/level_kernel.h"

// The response of one pixel: level → light and light → level. The loops over pixels are elsewhere.

namespace holotrace {

/// Complex amplitude that a pixel transmits, for light of amplitude 1.
struct Transmittance {
  double real, imaginary;
};

/// exp(2πi·stretch·ℓ/M): a phase pixel at level ℓ of M. `stretch` is the design wavelength over the
/// wavelength of the light. The pixel delays light by a length, so shorter waves get a larger phase.
inline Transmittance phase_transmittance(int level, int levels, double stretch) {
  const double cycles = stretch * level / levels;
  const double angle = 2 * std::numbers::pi * (cycles - std::floor(cycles));
  return {std::cos(angle), std::sin(angle)};
}

/// ℓ/(M−1): an amplitude pixel at level ℓ of M.
inline Transmittance amplitude_transmittance(int level, int levels) { return {double(level) / (levels - 1), 0}; }

/// The level of M whose phase 2π·stretch·ℓ/M is nearest, around the circle, to the phase of (real, imaginary), among
/// the levels of the first turn; level 0 for 0. Levels beyond 2π (stretch > 1) are not
/// used. If the levels do not reach 2π, phases in the gap get the nearer end.
inline int phase_level(double real, double imaginary, int levels, double stretch = 1) {
  const bool is_dark = real == 0 && imaginary == 0;  // atan2(0, −0) is π
  double cycles = is_dark ? 0 : std::atan2(imaginary, real) / (2 * std::numbers::pi);
  if (cycles < 0) cycles += 1;
  return level_kernel::nearest_phase_level(cycles, levels, stretch);
}

/// The level of M whose transmittance ℓ/(M−1) is nearest; transmittances beyond [0, 1] are clipped.
inline int amplitude_level(double transmittance, int levels) {
  return level_kernel::nearest_amplitude_level(transmittance, levels);
}

/// Spectrum w·sinc(w·f) of a pixel lit over the fraction w of its side, along one axis, at f cycles
/// per pixel; sinc(x) = sin(πx)/(πx).
inline double aperture_spectrum(double f, double w) {
  const double x = std::numbers::pi * w * f;
  return x == 0 ? w : w * std::sin(x) / x;
}

}  // namespace holotrace
