#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/rates.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"

namespace holotrace {

/// Draws waves at random, with probability proportional to a weight, from the running sums of the weights.
class WaveDraw {
 public:
  template <class Weight>
  WaveDraw(PreparedWaves waves, const Weight& weight) {
    double sum = 0;
    sums_.reserve(waves.size());
    for (const PreparedWave& wave : waves) sums_.push_back(sum += weight(wave));
  }
  double total() const { return sums_.empty() ? 0 : sums_.back(); }
  size_t wave_at(double u) const {  // u in [0, 1)
    const auto found = std::upper_bound(sums_.begin(), sums_.end(), u * total());
    return std::min(size_t(found - sums_.begin()), sums_.size() - 1);
  }

 private:
  std::vector<double> sums_;
};

/// Approximate energy that a wave brings to the panel [W/m² times the pixel's area].
inline double energy_of(const PreparedWave& w) { return w.amplitude * w.amplitude * double(w.box.pixels()); }

inline double nearness_of(const PreparedWave& w) { return energy_of(w) / (w.depth * w.depth); }

/// A pixel that a wave lights. The sum of energy/density over drawn pixels estimates the energy of all waves.
struct DrawnPixel {
  PreparedWave wave;
  int column, row;
  double density;
};

/// 8192 pixels of the waves' boxes, drawn from a fixed seed. Half of the draws choose waves by their energy. The other
/// half choose by energy over depth squared, which favours near waves: their errors are larger, and even a few of them
/// among many far ones are then found. Empty if the waves have no light.
inline std::vector<DrawnPixel> draw_pixels(PreparedWaves waves) {
  constexpr int draws = 8192;
  std::vector<DrawnPixel> pixels;
  const WaveDraw by_energy(waves, energy_of), by_nearness(waves, nearness_of);
  if (waves.empty() || by_energy.total() == 0) return pixels;
  CounterRandom random(0, 0, 0);
  for (int s = 0; s < draws; ++s) {
    const WaveDraw& draw = s % 2 == 0 ? by_energy : by_nearness;
    const PreparedWave& w = waves[draw.wave_at((s / 2 + random.uniform()) / (draws / 2))];
    const int column = w.box.x0 + int(random.uniform() * (w.box.x1 - w.box.x0));
    const int row = w.box.y0 + int(random.uniform() * (w.box.y1 - w.box.y0));
    const double share = energy_of(w) / by_energy.total() + nearness_of(w) / by_nearness.total();
    pixels.push_back({w, column, row, draws / 2 * share / double(w.box.pixels())});
  }
  return pixels;
}

/// One in `share` of the drawn pixels, of all waves alike, for a rougher estimate. A pair has one draw of each kind.
inline std::vector<DrawnPixel> some_of(const std::vector<DrawnPixel>& drawn, size_t share) {
  std::vector<DrawnPixel> pixels;
  for (size_t i = 0; i < drawn.size(); ++i)
    if (i % (2 * share) < 2) {
      pixels.push_back(drawn[i]);
      pixels.back().density /= double(share);
    }
  return pixels;
}

/// Errors above the goal by this factor in a rough estimate, at a thousand pixels or a hundred, are not measured again.
constexpr double beyond_doubt = 2;

/// The panel's pixels and the wavelength of their light.
struct LitGrid {
  const Grid& grid;
  double wavelength;  ///< [m]
};

/// Size of a tile of the tile-separable sum [pixels].
struct TileShape {
  int columns, rows;
  bool operator==(const TileShape&) const = default;
};

/// Precision of the products in a tile: single; two bf16 parts per number, with three of the four products; bf16.
enum class TileProducts { single, split_bf16, bf16 };

/// How a tile is summed.
struct TilePlan {
  TileShape shape;
  TileProducts products = TileProducts::single;
  bool operator==(const TilePlan&) const = default;
};

/// The shapes that sum_tiled knows, from fast to accurate. The neglected phase grows with columns·rows. 32 columns suit
/// every vector width, 6 rows suit the block of the product, and most shapes divide 1080p and 4K panels. In one row there is
/// no split.
inline constexpr std::array<TileShape, 11> tile_shapes{
    {{128, 120}, {128, 60}, {64, 60}, {64, 30}, {32, 30}, {32, 18}, {32, 12}, {32, 6}, {32, 4}, {32, 2}, {32, 1}}};

/// Relative error of the products for tiles of any size; it is independent of the error of the split.
double rounding_error(TileProducts products);

/// The sphere whose path along an axis through a tile's centre has the slope and the curvature of an astigmatic wave's there.
struct AxisSphere {
  double x = 0;   ///< from its centre to the tile's, along the axis [m]
  double r0 = 0;  ///< from its centre to the tile's [m]; < 0: it converges

  /// @param slope, second  first and second derivative of the path along the axis [1], [1/m]
  AxisSphere(double slope, double second) {
    constexpr double flattest = 1e-9;  // [1/m]: 10⁻⁷ of a wavelength across a tile
    const double curvature = second / (1 - slope * slope);
    r0 = 1 / (std::abs(curvature) < flattest ? std::copysign(flattest, curvature) : curvature);
    x = slope * r0;
  }
};

/// Effect of the split r ≈ r₀ + Δr(column) + Δr(row) inside tiles on a set of waves: the energies
/// of the error and of the waves, Σⱼ Σ over the pixels of j of |error|² and |Uⱼ|² [W/m²].
struct SplitEnergies {
  double error = 0, waves = 0;

  /// The relative L2 error.
  double relative_error() const { return waves > 0 ? std::sqrt(error / waves) : 0; }
};

/// The sum of of_pixel(pixel) over drawn pixels, on all threads; in the same order on any number of them.
template <class OfPixel>
SplitEnergies sum_energies(const std::vector<DrawnPixel>& pixels, const OfPixel& of_pixel) {
  constexpr size_t part = 64;
  std::vector<SplitEnergies> parts((pixels.size() + part - 1) / part);
  parallel_for(0, int64_t(parts.size()), [&](int64_t p) {
    SplitEnergies sum;
    for (size_t i = size_t(p) * part; i < std::min(size_t(p + 1) * part, pixels.size()); ++i) {
      const SplitEnergies of_one = of_pixel(pixels[i]);
      sum.error += of_one.error;
      sum.waves += of_one.waves;
    }
    parts[size_t(p)] = sum;
  });
  SplitEnergies all;
  for (const SplitEnergies& of_part : parts) {
    all.error += of_part.error;
    all.waves += of_part.waves;
  }
  return all;
}

/// Where and how accurately waves are summed.
struct SumGoal {
  Grid grid;
  PixelBox bounds;        ///< pixels to sum; tiles cover them from the top left corner on
  double wavelength = 0;  ///< [m]
  double tolerance = 0;   ///< relative L2 error
  double coherence = 1;   ///< energy of the field over the sum of its waves' energies: 1 for random phases, less
                          ///< if the waves partly cancel, so that relative errors grow
};

/// The split neglects about k·x₀·y₀·u·v/r₀³ for a pixel at (u, v) from the tile's centre, which lies at
/// (x₀, y₀) from the source; for astigmatic waves, what two spheres (AxisSphere) leave out. Its error is measured: at pixels that the waves light (draw_pixels), the split is compared
/// with the wave itself.
///
/// @param bounds  pixels that the tiles cover, from the top left corner on
SplitEnergies measure_split(const std::vector<DrawnPixel>& pixels, const Grid& grid, const PixelBox& bounds,
                            double wavelength, TileShape tile);

/// A way to sum tiles, and its expected relative L2 error: that of the split, √(error/waves), and the
/// rounding, over √coherence.
struct TileChoice {
  TilePlan plan;
  double error = 0;
  SplitEnergies energies;
  bool meets_tolerance = false;
};

/// Tiles that are summed one after the other, so that they share a list of the waves that meet one of them [pixels].
TileShape group_of_tiles(TileShape tile);

/// Pixels of the tiles that the waves meet, added up over the waves: a tile that a wave lights partly counts as a whole.
double pixels_of_tiles(PreparedWaves waves, TileShape shape, const PixelBox& bounds);

/// Work of a sum of waves in tiles.
SummationWork work_of_tiles(PreparedWaves waves, const TilePlan& plan, const PixelBox& bounds);

/// The fastest plan on this machine (cost_model.h) whose expected error, with a margin of 25 %, is below the
/// tolerance; the most accurate one if none is.
/// @param pixels  drawn from the waves
TileChoice choose_tile(PreparedWaves waves, const std::vector<DrawnPixel>& pixels, const SumGoal& goal);

/// Whether this processor has the units of the plan's products, and these suit its shape.
bool can_run(const TilePlan& plan);

/// Work of a plan for one wave and pixel: its products plus, spread over the tile, the work per column, per row
/// and per tile.
SummationWork tile_work(const TilePlan& plan);

/// The same for tiles over the whole grid.
inline TileChoice choose_tile(PreparedWaves waves, const Grid& grid, double wavelength, double tolerance,
                              double coherence = 1) {
  return choose_tile(waves, draw_pixels(waves), {grid, {0, grid.nx, 0, grid.ny}, wavelength, tolerance, coherence});
}

}  // namespace holotrace
