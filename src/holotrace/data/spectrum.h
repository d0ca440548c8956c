#pragma once

#include "holotrace/base/vec.h"

namespace holotrace {

/// Where the red, green and blue of scenes stand in the spectrum [m].
inline constexpr double red_line = 630e-9, green_line = 532e-9, blue_line = 460e-9;

/// Weights of red, green and blue at a wavelength [m]: they sum to 1 and run straight between the three lines;
/// outside that span the end channel has it all. Colours of scenes are thus what a laser of each of those
/// three lines would see, and a white is 1 at every wavelength.
inline Vec3 channel_weights(double wavelength) {
  if (wavelength <= blue_line) return {0, 0, 1};
  if (wavelength >= red_line) return {1, 0, 0};
  if (wavelength <= green_line) {
    const double t = (wavelength - blue_line) / (green_line - blue_line);
    return {0, t, 1 - t};
  }
  const double t = (wavelength - green_line) / (red_line - green_line);
  return {t, 1 - t, 0};
}

/// Radiance at a wavelength [m] from radiance in red, green and blue, in the unit of `rgb`.
inline double radiance_at(double wavelength, Vec3 rgb) { return dot(channel_weights(wavelength), rgb); }

}  // namespace holotrace
