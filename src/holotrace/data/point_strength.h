#pragma once

#include <cmath>

#include "holotrace/data/grid.h"

namespace holotrace {

/// Amplitude on the panel, head-on, of the wave of a luminous point whose radiance is 1 W/m²/sr [√(W/m²)].
///
/// A point stands for a patch of that radiance as large as the smallest spot that the panel can show at its depth d:
/// λd/W by λd/H, for a panel of W × H. Its solid angle is Ω = λ²/(W·H) at every depth, and so
///
///     |U|² = L·Ω = L·λ²/(W·H)                              (L·dΩ, as every patch of a surface brings)
///
/// In a view in focus the spot of such a point is as bright at its peak, |U|²·(W·H)²/(λd)² = L·W·H/d², as a surface of
/// the radiance L, whose image has the irradiance L·W·H/d². Points nearer to each other than that spot add up.
///
/// @param panel       W × H [m]
/// @param wavelength  λ [m]; of several, the first of the scene: a point has one strength for all of them
inline double point_amplitude(const Grid& panel, double wavelength) {
  return wavelength / std::sqrt(panel.width() * panel.height());
}

}  // namespace holotrace
