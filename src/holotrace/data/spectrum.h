#pragma once

#include <vector>

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

/// Luminance of linear red, green and blue of ITU-R BT.709 (sRGB's primaries and white), in their unit.
inline double luminance(double red, double green, double blue) { return 0.2126 * red + 0.7152 * green + 0.0722 * blue; }

/// Red, green and blue of light that is seen at N wavelengths:
///
///     rgb = Σₙ Mₙ·Iₙ,   M = W⁺ (3 × N),   W (N × 3) with the rows channel_weights(λₙ)
///
/// W makes wavelengths of a scene's colours, I = W·rgb, and its Moore–Penrose inverse makes colours again. Where W has
/// rank 3 (as for 638, 520 and 450 nm), M·W is the identity: every colour comes back, and equal light at all
/// wavelengths is white, (1, 1, 1). Two wavelengths, or more that tell no three colours apart, give the nearest that
/// they can: M·W·rgb is the part of rgb in the span of the rows of W, so a white is not white. Pictures of one
/// wavelength are left monochrome instead (view/combine_views.h).
///
/// Singular values below 1e-5 of the largest count as 0: wavelengths that near are one colour.
///
/// @param wavelengths  [m], at least one
/// @return             Mₙ, one per wavelength; its parts may be negative
/// @throws Error       for no wavelength, or one that is not above 0
std::vector<Vec3> colour_matrix(const std::vector<double>& wavelengths);

/// Radiance at a wavelength [m] from radiance in red, green and blue, in the unit of `rgb`.
inline double radiance_at(double wavelength, Vec3 rgb) { return dot(channel_weights(wavelength), rgb); }

}  // namespace holotrace
