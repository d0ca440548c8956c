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

/// Waves in the order of their use in sum_planes: by slab, and neighbours one after the other within a slab.
struct SortedWaves {
  std::vector<PreparedWave> waves;
  std::vector<Slab> slabs;
};

/// Data shared by all tiles of a panel.
struct PlanesSum {
  const SortedWaves& waves;
  const PlanesTables& tables;
  const TilePlan& direct;  ///< plan for waves that light only a corner of the tile (tile_sum.h)
  const Grid& grid;
};

/// exp(iπκu²)/φ̂ at the tile's pixels along an axis: the curvature κ of a node [cycles/m²], and the correction of the
/// gridding kernel.
std::vector<std::complex<float>> plane_chirp(const PlanesTables& tables, double kappa);

/// Adds the waves to the samples of the tile `box` of the panel.
void sum_planes_tile(const PlanesSum& sum, const PixelBox& box, PlanesWorkspace& workspace,
                     Array2D<std::complex<float>>& samples);

}  // namespace holotrace
