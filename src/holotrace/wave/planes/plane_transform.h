#pragma once

#include "holotrace/wave/planes/plane_spread.h"

// From grids of frequencies to the pixels of a tile.

namespace holotrace {

/// A wave times functions of its frequency (f, g), in the order of workspace.terms; all but the first are for the
/// correction (plane_correction_kernel.h).
enum class Term { wave, cross, difference, along_x, along_y };
inline constexpr int corrected_terms = 5;

/// The grid of one node, transformed to the tile's pixels: workspace.terms, [term][column][row]. Cells are weighted by 1,
/// f·g, f² − g², f and g, the frequencies of the cells [cycles/m]; without correction there is only the first term.
void transform_grid(const float* grid, const PlanesTables& tables, PlanesWorkspace& workspace);

/// One node of a strip (workspace.strip), transformed to the pixels along its lines.
/// @return  [pixel][line of the strip], in a buffer of the workspace
const std::complex<float>* transform_strip(const float* node, const PlanesTables& tables, PlanesWorkspace& workspace);

}  // namespace holotrace
