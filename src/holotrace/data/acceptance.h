#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "holotrace/data/grid.h"

namespace holotrace {

/// Sine of the largest angle to the panel's normal, along one axis, at which a panel of this pitch can
/// show the fringes of a wave: λ/2p, from the grating equation (Eq. 14) for the period 2p; at most 1.
inline double acceptance_sine(double wavelength, double pitch) { return std::fmin(wavelength / (2 * pitch), 1.0); }

/// Tangent of that angle; infinite if the pitch is half a wavelength or less.
inline double acceptance_tangent(double wavelength, double pitch) {
  const double sine = acceptance_sine(wavelength, pitch);
  return sine < 1 ? sine / std::sqrt((1 - sine) * (1 + sine)) : std::numeric_limits<double>::infinity();
}

/// The wavelength whose acceptance cone bounds a view of all colours of a job: the shortest one, if all colours share a
/// common cone; else the first one, and the view then shows the cone of that colour.
inline double view_wavelength(const std::vector<double>& wavelengths, bool has_common_cone) {
  return has_common_cone ? *std::min_element(wavelengths.begin(), wavelengths.end()) : wavelengths.front();
}

/// Half-side R of the square on the panel that a source at this depth lights: R = d·tan(asin(λ/2p)).
inline double box_radius(double depth, double wavelength, double pitch) {
  return depth * acceptance_tangent(wavelength, pitch);
}

/// Amplitude on the panel, at normal incidence, of the wave of a luminous point with a radiance of 1 W/m²/sr [√(W/m²)].
///
/// A point stands for a patch of that radiance as large as the smallest spot that the panel can show at its depth d:
/// λd/W' by λd/H'. W' × H' is the part of the panel that the point's wave lights, W' = min(W, 2R) (box_radius). The
/// solid angle of the patch is Ω = λ²/(W'·H'), and so
///
///     |U|² = L·Ω = L·λ²/(W'·H')                            (L·dΩ, as for every patch of a surface)
///
/// In a view in focus the peak of the spot of such a point, |U|²·(W'·H')²/(λd)² = L·W'·H'/d², is as bright as a surface
/// of the radiance L at that place. Points that are closer together than that spot add up.
///
/// @param panel       panel of the size W × H [m]
/// @param wavelength  λ of the wave [m]: points are white, of one radiance at all wavelengths
/// @param cone        acceptance wavelength of the wave (Sources::acceptance_wavelength) [m]
/// @param depth       d of the point [m], above 0
inline double point_amplitude(const Grid& panel, double wavelength, double cone, double depth) {
  const double box = 2 * box_radius(depth, cone, panel.pitch);
  return wavelength / std::sqrt(std::min(panel.width(), box) * std::min(panel.height(), box));
}

}  // namespace holotrace
