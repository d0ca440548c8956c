#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

}  // namespace holotrace
