#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/wave/shared/gridding_kernel.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {

/// How sum_planes brings waves to a tile of the panel.
struct PlanesPlan {
  int tile = 120;             ///< side of a tile [pixels]
  int width = 5;              ///< of the gridding kernel [cells]
  int nodes = 3;              ///< curvatures per slab of depth
  int slabs = 1;              ///< that the waves are sorted into by 1/depth
  bool is_corrected = false;  ///< for what the plane waves neglect: see sum_planes.h
  bool has_strips = true;     ///< where a box's edge cuts a tile; else the waves there are summed directly
  bool operator==(const PlanesPlan&) const = default;
};

/// Lines of 16 pixels at a tile's edge that is not lit as a whole.
inline constexpr int strip_width = 16;

/// Numbers that all tiles of a plan share.
struct PlanesTables {
  PlanesPlan plan;
  GriddingKernel kernel;
  double wavelength, pitch, tangent;  ///< the last of the panel's acceptance, and a little more for rounding
  int transform;                      ///< length of the FFTs: twice the tile
  int cells;                          ///< of a grid along one axis: the transform's and a margin on either side
  std::vector<float> inverse_phi;     ///< 1/φ̂ of each of the tile's pixels along an axis
  /// ∫xⁿφ·exp(2πiξx)dx/φ̂ of each, n = 1, 2 [cyclesⁿ/mⁿ]: how far cells lie from the waves that are spread over them.
  std::vector<float> first, second;
  std::vector<double> nodes;        ///< Chebyshev points in (−1, 1)
  std::vector<float> denominators;  ///< Π (τ_q − τ_m), m ≠ q

  PlanesTables(const PlanesPlan& plan, double wavelength, double pitch);
  static constexpr int margin = 8;          ///< cells
  int stride() const { return cells + 8; }  ///< of a grid's lines: no power of two, which caches dislike
};

/// Waves of similar depth. Curvatures κ = (1 − ρ²/2r₀²)/λr₀ of their waves in any tile lie within `half` of `centre`
/// [cycles/m²].
struct Slab {
  size_t first, last;  ///< in the list of waves
  double centre, half;
};

/// Part of a wave in a tile: the lines [first, last) of one strip, to be added or taken away.
struct StripEntry {
  uint32_t wave;
  int8_t first, last, sign;
};

/// Buffers of one thread, kept from tile to tile.
struct PlanesWorkspace {
  AlignedVector<float> grids;              ///< [node][line][cell], complex
  AlignedVector<float> strip;              ///< [node][cell][16 real, 16 imaginary]
  std::vector<StripEntry> entries[2][16];  ///< [across columns, across rows][strip]
  std::vector<PreparedWave> direct;        ///< waves that are left for sum_tile, cut to the tile
  TileWorkspace of_direct;                 ///< of sum_tile
  AlignedVector<std::complex<float>> folded, turned, terms, tile;  ///< of the transforms
};

/// A tile of the panel, and the place of its reference pixel (tile/2, tile/2) [m].
struct TilePlace {
  PixelBox box;
  double x, y;
};

/// Spreads the slab's waves that light the tile over the grids of the workspace; those that light a part of it go
/// to its strips, or to `direct`.
/// @return  whether the grids hold anything
bool spread_waves(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& tables,
                  const TilePlace& tile, PlanesWorkspace& workspace);

/// A strip of a tile: of rows (is_across_rows) or of columns, counted from the tile's first.
struct Strip {
  bool is_across_rows;
  int index;
};

/// Spreads the entries of one strip (workspace.entries) over workspace.strip: each line by itself along the other axis.
void spread_strip(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& tables,
                  const TilePlace& tile, const Strip& strip, PlanesWorkspace& workspace);

}  // namespace holotrace
