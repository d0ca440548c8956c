#pragma once

#include <vector>

#include "holotrace/base/vec.h"

// Colours as the CIE defines them, and the spectra of its illuminants.

namespace holotrace {

/// Wavelengths of the visible range, beyond which colour-matching functions and tables of daylight are 0 [m].
inline constexpr double shortest_visible = 380e-9, longest_visible = 780e-9;

/// The colour-matching functions x̄, ȳ, z̄ of the CIE 1931 standard observer, by cubic interpolation of the table of CIE 015:2018
/// at steps of 10 nm. 0 outside of the visible range. Chromaticities of daylight are right to 2·10⁻⁴.
Vec3 colour_matching(double wavelength);

/// Luminous efficacy of radiation: 683 lm/W times ȳ.
inline constexpr double lumens_per_watt = 683;

/// XYZ of light with a spectral radiance of spectrum(λ) at the wavelength λ [m] per nanometre: Σ spectrum·(x̄, ȳ, z̄), in steps of
/// 5 nm over the visible range.
template <class Spectrum>
Vec3 xyz_of(const Spectrum& spectrum) {
  constexpr int step = 5, first = 380, last = 780;  // nm
  Vec3 sum;
  for (int nm = first; nm <= last; nm += step) sum += colour_matching(nm * 1e-9) * (step * spectrum(nm * 1e-9));
  return sum;
}

/// Linear red, green and blue of sRGB (IEC 61966-2-1) from XYZ with Y = 1 for white, and the reverse.
Vec3 srgb_from_xyz(Vec3 xyz);
Vec3 xyz_from_srgb(Vec3 rgb);

/// The chromaticity (x, y) of D65.
inline constexpr Vec2 d65_chromaticity{0.3127, 0.3290};

/// Planck's law: radiance of a black body per wavelength [W/m²/sr/m].
double planck(double wavelength, double temperature);

/// The components S₀, S₁, S₂ of daylight (CIE 015:2018, table 6; linear between steps of 10 nm), 0 outside of the visible range.
Vec3 daylight_components(double wavelength);

/// The factors (1, M₁, M₂) of the components of daylight with the chromaticity (x, y):
///
///     M₁ = (−1.3515 − 1.7703x + 5.9114y)/M,  M₂ = (0.0300 − 31.4424x + 30.0717y)/M,  M = 0.0241 + 0.2562x − 0.7341y
Vec3 daylight_factors(Vec2 chromaticity);

/// The chromaticity of daylight of a correlated colour temperature from 4000 to 25000 K (CIE 015:2018, 4.1.2).
Vec2 daylight_chromaticity(double temperature);

/// Red, green and blue of light that is measured at N wavelengths, as the CIE 1931 standard observer sees it on a screen of sRGB:
///
///     rgb = Σₙ Iₙ·gₙ·A·(x̄, ȳ, z̄)(λₙ)
///
/// A is the matrix from XYZ to linear sRGB. The factors gₙ, the white balance, are the least in the sense of squares of gₙ − g,
/// with their mean g, that make equal light at all wavelengths the white (1, 1, 1); with three wavelengths there is one solution.
/// If none is exact, or a factor would be below 0, all are equal and equal light has the luminance 1.
/// @throws Error  as colour_matrix does, and if no wavelength is visible
std::vector<Vec3> cie_colour_matrix(const std::vector<double>& wavelengths);

/// A colour outside of sRGB mixed with white of its luminance until no component is below 0.
Vec3 within_gamut(Vec3 rgb);

}  // namespace holotrace
