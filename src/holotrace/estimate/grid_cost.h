#pragma once

#include <vector>

#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/uniform_grid.h"

namespace holotrace {

/// The steps of a ray through a uniform grid, and their time.
struct GridCost {
  double cells = 0;    ///< cells visited by a ray
  double tests = 0;    ///< triangles tested by a ray
  double seconds = 0;  ///< T_t: cells·t_cell + tests·t_test + t_ray [s]
};

/// Time of each step of a ray through a grid on one thread of this machine [s].
struct GridRates {
  double cell = 0, test = 0, ray = 0;
};

/// The predicted cost of a ray: the paper's appendix, with the reasoning of J. G. Cleary and G. Wyvill (The
/// Visual Computer 4, 65, 1988).
///
///     σ = A/2V,   ℓ = (1 − exp(−σ·4V/S))/σ,   cells = 1 + ℓ/2·(1/sx + 1/sy + 1/sz),   tests = cells·entries/all cells
///
/// Rays are isotropic and spread evenly through the box (volume V, surface S, mean chord 4V/S by Cauchy). They meet
/// triangles of total area A with random orientations, with probability σ per length, so they end after ℓ on average. A
/// direction has mean |x|, |y|, |z| of 1/2, so ℓ crosses ℓ/2s planes of each set of spacing s. Cells have the average
/// number of triangles.
///
/// Exact for triangles that are small against the box and evenly spread, except that all chords have the mean length:
/// an error of about 10 %. In scenes of surfaces, where triangles lie together, a ray makes most of its tests at its
/// end: right within a factor of 2.
GridCost predict_grid_cost(const GridStatistics& grid, const GridRates& rates);

/// The mean cost of rays whose steps were counted.
GridCost counted_grid_cost(const GridCounts& counts, const GridRates& rates);

/// Times rays through clouds of 200 to 20000 triangles in coarse grids, where tests dominate, and in fine grids, where
/// steps between cells dominate, and solves for the three rates by least squares of relative errors. Takes 0.5 s on one
/// thread. The clouds fit into the cache, so large scenes take longer than these rates predict.
GridRates calibrate_grid();

/// `count` triangles with random orientations, spread evenly in a cube of side 1 m about (0, 0, −2 m). Their total area
/// is 2 m²: more triangles are smaller ones, as in a scene that is modelled in more detail.
Scene make_triangle_cloud(int count);

/// Isotropic rays, spread evenly through that cube.
std::vector<Ray> cloud_rays(int64_t count);

}  // namespace holotrace
