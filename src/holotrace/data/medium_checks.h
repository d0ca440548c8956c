#pragma once

#include <vector>

#include "holotrace/data/scene.h"

namespace holotrace {

/// Largest |g| of the phase function of Henyey and Greenstein: the peak of a larger one is finer than 0.05°.
inline constexpr double most_anisotropy = 0.999;

/// Largest extinction [1/m]: a mean free path of 1 nm.
inline constexpr double most_extinction = 1e9;

/// Optical thickness of a cell of a medium's grid, along its longest side and where colours are dimmed most, for a density of 1.
double cell_thickness(const Medium& medium);

/// @throws Error, naming the medium, for an extinction below 0 or above most_extinction; a box without volume or through the panel;
///         and densities without a box, not finite, below 0, or so large that rays would take too many steps in a cell
void check_medium(const Medium& medium);

/// @throws Error, naming them, for two media that fill the whole scene
void check_open_media(const std::vector<Medium>& media);

}  // namespace holotrace
