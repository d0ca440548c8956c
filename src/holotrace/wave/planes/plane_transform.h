#pragma once

#include "holotrace/wave/planes/plane_spread.h"

// From grids of frequencies to the pixels of a tile.

namespace holotrace {

/// A wave times functions of its frequency (f, g), in the order of workspace.terms; all but the first are for the
/// correction (plane_correction_kernel.h).
enum class Term { wave, cross, difference, along_x, along_y };
inline constexpr int corrected_terms = 5;

/// The grids of all nodes (workspace.grids), transformed along their columns: workspace.columns, cells weighted by 1 and, for
/// the correction, by g and g², their frequencies down the tile [cycles/m].
void transform_columns(const PlanesTables& tables, PlanesWorkspace& workspace);

/// The same for rows [first, first + 16) of the tile, turned for transform_rows: workspace.turned.
void turn_rows(int first, const PlanesTables& tables, PlanesWorkspace& workspace);

/// One node's rows after turn_rows, transformed to the tile's pixels: workspace.terms, [term][column of the tile][row]. Cells
/// are weighted by 1, f·g, f² − g², f and g, the frequencies of the cells; without correction there is only the first term.
void transform_rows(int node, const PlanesTables& tables, PlanesWorkspace& workspace);

/// One node of a strip (workspace.strip), transformed to the pixels along its lines.
/// @return  [pixel][line of the strip], in a buffer of the workspace
const std::complex<float>* transform_strip(int node, const PlanesTables& tables, PlanesWorkspace& workspace);

}  // namespace holotrace
