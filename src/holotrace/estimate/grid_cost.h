#pragma once

#include <vector>

#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/uniform_grid.h"

namespace holotrace {

/// What a ray through a uniform grid has to do, and how long that takes.
struct GridCost {
  double cells = 0;    ///< visited by a ray
  double tests = 0;    ///< of triangles, by a ray
  double seconds = 0;  ///< T_t: cells·t_cell + tests·t_test + t_ray [s]
};

/// How long each step of a ray through a grid takes on one thread of this machine [s].
struct GridRates {
  double cell = 0, test = 0, ray = 0;
};

/// The cost of a ray before it is shot: the paper's appendix, by the reasoning of J. G. Cleary and G. Wyvill (The
/// Visual Computer 4, 65, 1988).
///
///     σ = A/2V,   ℓ = (1 − exp(−σ·4V/S))/σ,   cells = 1 + ℓ/2·(1/sx + 1/sy + 1/sz),   tests = cells·entries/all cells
///
/// Rays come from all around and evenly through the box (volume V, surface S, mean chord 4V/S by Cauchy), and meet
/// triangles of area A in all, turned every way, with probability σ per length: they end after ℓ on the average. A
/// direction has |x|, |y|, |z| of 1/2 on the average, so ℓ crosses ℓ/2s planes of each set of spacing s. Cells are
/// tested as full as they are on the average.
///
/// Exact for triangles small against the box and evenly spread but for the law of chords, which is put at its mean:
/// some 10 %. For surfaces, whose triangles lie together, a ray meets most of its tests at its end: within a factor
/// of 2.
GridCost predict_grid_cost(const GridStatistics& grid, const GridRates& rates);

/// The mean cost of rays that were counted.
GridCost counted_grid_cost(const GridCounts& counts, const GridRates& rates);

/// Times rays through clouds of 200 to 20000 triangles in coarse grids, where tests dominate, and fine ones, where
/// steps from cell to cell do, and solves for the three rates by least squares of relative errors. Some 0.5 s, on one
/// thread; in cache, so that large scenes take longer than these rates say.
GridRates calibrate_grid();

/// `count` triangles evenly spread in a cube of side 1 m about (0, 0, −2 m) and turned every way, whose areas together
/// are 2 m²: the finer, the more of them, as a scene that is modelled more and more closely.
Scene make_triangle_cloud(int count);

/// Rays from all around and evenly through that cube.
std::vector<Ray> cloud_rays(int64_t count);

}  // namespace holotrace
