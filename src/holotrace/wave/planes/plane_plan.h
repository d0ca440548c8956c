#pragma once

#include <functional>
#include <vector>

#include "holotrace/wave/planes/plane_tile.h"
#include "holotrace/wave/tiles/tile_error.h"

namespace holotrace {

/// Depths of a set of waves [m].
struct WaveDepths {
  double nearest, farthest;
};

/// @param waves  at least one wave
WaveDepths depths_of(PreparedWaves waves);

/// Slabs of equal steps of 1/depth, from the nearest wave to the farthest.
struct Slabs {
  WaveDepths depths;
  int count;

  int of(double depth) const;

  /// The curvatures of slab `index` in the tiles that its waves light; the range of its waves is set later.
  Slab slab(int index, double wavelength, double pitch) const;

 private:
  double step() const { return (1 / depths.nearest - 1 / depths.farthest) / count; }
};

/// Sorts the waves for a plan: by depth into its slabs, and within a slab by position.
SortedWaves sort_waves(PreparedWaves waves, const PlanesPlan& plan, double wavelength, double pitch);

/// The error of the expansion of waves in the tiles of a plan (summation.h), without the error of gridding. It is
/// measured at pixels that the waves light, as in measure_split.
SplitEnergies measure_planes(const std::vector<DrawnPixel>& pixels, const WaveDepths& depths, const Grid& grid,
                             const PixelBox& bounds, double wavelength, const PlanesPlan& plan);

/// Relative L2 error of rounding, over all of the panel's acceptance: products in single precision, and frequencies of up to
/// `tile` cells that are floats, too. Measured.
double rounding_error_of_planes(const PlanesPlan& plan);

/// Relative L2 error of the gridding of a plane wave, over both axes. Of the last tiles in a row or column `bounds` may have a part,
/// which errs more than a whole one.
double gridding_error_of_planes(const PlanesPlan& plan, const PixelBox& bounds);

/// What a plan has to sum: numbers of pairs of a wave and a tile, and of tiles.
struct PlanesCounts {
  double whole = 0;    ///< the area of the waves' boxes in tiles
  double partial = 0;  ///< tiles that edges of boxes cut
  double corners = 0;  ///< tiles that contain corners of boxes
  double tiles = 0;    ///< of the panel
};

/// Where plans are carried out: the seconds that they are expected to take there, whether strips are known there, and the
/// oversampling of grids.
struct PlanesCost {
  std::function<double(const PlanesPlan& plan, const PlanesCounts& counts)> seconds;
  bool has_strips = true;
  std::vector<double> oversamplings{2, 1.5};
};

/// A plan, the relative L2 error expected of it and the work that it needs.
struct PlanesChoice {
  PlanesPlan plan;
  double error = 0;
  double seconds = 0;  ///< predicted; on the processor for one thread
  SplitEnergies energies;
  bool meets_tolerance = false;
};

/// The depth from which spherical waves suit `planes` [m]: their boxes are at least four of the smallest tiles wide, so that
/// fewer than half of their tiles are partly lit. Infinite for panels whose acceptance is 14 degrees or more (pixels of two
/// wavelengths): beyond it the expansion in summation.h is not valid in tiles of that size. Astigmatic waves do not suit it.
double least_depth_for_planes(double wavelength, double pitch);

/// The fastest plan whose expected error, with a margin of 25 %, is below the
/// tolerance; the most accurate one if none is.
/// @param waves      waves that suit the method (least_depth_for_planes), at least one
/// @param drawn      pixels drawn of them (draw_pixels)
/// @param most_seconds  plans that take longer than this are skipped [s]
PlanesChoice choose_planes(PreparedWaves waves, const std::vector<DrawnPixel>& drawn, const PlanesCost& cost,
                           const SumGoal& goal, double most_seconds = 1e300);

/// Complex numbers of the grids to which plane_spread.h adds one wave (SummationWork::spreads): those of all nodes' slots in
/// the kernel's cells, each line rounded up to vectors of 8 floats, whatever the instruction set.
double spreads_per_wave(const PlanesPlan& plan);

/// How the waves are summed that light a part of a tile of `tile` pixels which contains a corner of their box. A part that is
/// lit needs only small tiles of the direct sum, so it is the fastest for a corner anywhere in the tile.
/// @param direct  a plan that is accurate enough; smaller shapes are more accurate
TilePlan plan_of_corners(const TilePlan& direct, int tile);

/// One thread of the processor (cost_model.h).
/// @param direct  plan for the direct sum, from which that of corners follows
PlanesCost planes_cost_on_processor(const TilePlan& direct);

}  // namespace holotrace
