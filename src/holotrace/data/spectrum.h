#pragma once

#include <vector>

#include "holotrace/base/vec.h"

namespace holotrace {

/// Wavelengths that represent the red, green and blue of scenes [m].
inline constexpr double red_line = 630e-9, green_line = 532e-9, blue_line = 460e-9;

/// Weights of red, green and blue at a wavelength [m]: they sum to 1 and are linear between the three lines. Outside
/// that span the end channel has the weight 1. Colours of scenes are thus what a laser at each of the three
/// lines would measure, and white is 1 at every wavelength.
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

/// Luminance of linear red, green and blue with the weights of ITU-R BT.709 (primaries of sRGB), in their unit.
inline double luminance(double red, double green, double blue) { return 0.2126 * red + 0.7152 * green + 0.0722 * blue; }

/// What colours of surfaces reflect at a wavelength. `linear`: channel_weights. `smooth`: a smooth spectrum that has the colour
/// in daylight (data/smooth_reflectance.h).
enum class Reflectances { linear, smooth };

/// A function of the wavelength: linear between its samples, 0 beyond them (data/light_spectrum.h makes those of lamps).
struct Spectrum {
  std::vector<double> wavelengths;  ///< [m], ascending
  std::vector<double> values;       ///< one for each

  double at(double wavelength) const;
};

/// Red, green and blue of light that is measured at N wavelengths:
///
///     rgb = Σₙ Mₙ·Iₙ,   M = W⁺ (3 × N),   W (N × 3) with the rows channel_weights(λₙ)
///
/// W gives the light at the wavelengths for a scene's colour, I = W·rgb; its Moore–Penrose inverse gives the colour
/// back. If W has rank 3 (as for 638, 520 and 450 nm), M·W is the identity: every colour is recovered, and equal light
/// at all wavelengths is white, (1, 1, 1). Two wavelengths, or more with a rank below 3, give the nearest possible
/// colour: M·W·rgb is the projection of rgb on the span of the rows of W, so white is not white. Pictures of one
/// wavelength are left monochrome instead (view/combine_views.h).
///
/// Singular values below 1e-5 of the largest count as 0: wavelengths so close together count as one colour.
///
/// @param wavelengths  wavelengths [m], at least one
/// @return             Mₙ, one vector per wavelength; its components may be negative
/// @throws Error       if there is no wavelength, or one is not above 0
std::vector<Vec3> colour_matrix(const std::vector<double>& wavelengths);

/// Radiance at a wavelength [m] from radiance in red, green and blue, in the unit of `rgb`.
inline double radiance_at(double wavelength, Vec3 rgb) { return dot(channel_weights(wavelength), rgb); }

}  // namespace holotrace
