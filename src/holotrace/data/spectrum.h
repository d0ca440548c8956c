#pragma once

#include "holotrace/base/vec.h"

namespace holotrace {

/// Weights of red, green and blue at a wavelength [m]: they sum to 1 and run straight between
/// blue at 460 nm, green at 532 nm and red at 630 nm; outside that span the end channel has it all.
/// Colours of scenes are thus what a laser of each of those three lines would see.
inline Vec3 channel_weights(double wavelength) {
  constexpr double blue = 460e-9, green = 532e-9, red = 630e-9;
  if (wavelength <= blue) return {0, 0, 1};
  if (wavelength >= red) return {1, 0, 0};
  if (wavelength <= green) {
    const double t = (wavelength - blue) / (green - blue);
    return {0, t, 1 - t};
  }
  const double t = (wavelength - green) / (red - green);
  return {t, 1 - t, 0};
}

/// Radiance at a wavelength [m] from radiance in red, green and blue, in the unit of `rgb`.
inline double radiance_at(double wavelength, Vec3 rgb) { return dot(channel_weights(wavelength), rgb); }

}  // namespace holotrace
