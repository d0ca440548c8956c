#pragma once

#include <algorithm>
#include <cmath>

#include "holotrace/data/acceptance.h"
#include "holotrace/data/grid.h"

namespace holotrace {

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
