#pragma once

#include <vector>

#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/uniform_grid.h"

namespace holotrace {

/// Inputs of the cost estimate of a hologram. Times and ρ are measured by a probe of the scene.
struct CostInputs {
  double pixels = 0;             ///< P, pixels of the panel
  double samples_per_pixel = 0;  ///< S, paths per pixel
  double frames = 1;             ///< F, number of holograms
  double reflectance = 0;        ///< ρ, the probability that a path continues at a surface, in [0, 1)
  double trace_seconds = 0;      ///< T_t, time of one ray through the scene [s]
  double waves = 0;              ///< waves that reach the panel, each of them every pixel
  double wave_rate = 1;          ///< waves·pixels that the synthesis sums per second [1/s]
};

/// The paper's estimate (Eq. 16–23), and the synthesis time, which the paper leaves out. Times are of all frames.
struct Cost {
  double paths = 0;              ///< N = P·S, paths of one frame
  double mean_path_length = 0;   ///< l_avg = 1/(1−ρ)
  double rays = 0;               ///< N_B = l_avg·N (Eq. 21), rays of one frame
  double trace_seconds = 0;      ///< F·N·(1 + l_avg)·T_t (Eq. 17, 23), the rays and the shadow ray of each path [s]
  double synthesis_seconds = 0;  ///< F·waves·P/rate [s]
  double seconds = 0;            ///< the sum of both [s]
};

/// Mean number of surfaces on a path that continues with probability ρ: 1/(1−ρ) (Eq. 20), or (1−ρᵏ⁺¹)/(1−ρ) if it
/// ends after k bounces. (Eq. 19 is this sum of k+1 terms; the paper's closed form has ρᵏ.) Negative k: no end.
/// @throws Error  unless ρ is in [0, 1)
double mean_path_length(double reflectance, int bounces = -1);

/// @throws Error  for an input that is negative or not finite, ρ outside [0, 1), or a wave rate of 0
Cost estimate_cost(const CostInputs& inputs);

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
