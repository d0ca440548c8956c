#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/column_fft.h"
#include "holotrace/wave/shared/gridding_kernel.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {

/// How sum_planes computes waves in a tile of the panel.
struct PlanesPlan {
  int tile = 120;             ///< side of a tile, a multiple of 4 [pixels]
  int width = 5;              ///< width of the gridding kernel [cells]
  int nodes = 3;              ///< curvatures per slab of depth
  int slabs = 1;              ///< number of slabs into which the waves are sorted by 1/depth
  bool is_corrected = false;  ///< whether the terms that plane waves neglect are corrected: see summation.h
  bool has_strips = true;     ///< whether strips are used where a box's edge cuts a tile; else direct sums
  double oversampling = 2;    ///< cells of a grid per pixel of the tile, along an axis: 2 or 1.5

  /// Length of the FFTs.
  int transform() const { return int(tile * oversampling); }
  bool operator==(const PlanesPlan&) const = default;
};

/// Number of lines in a strip, used at edges of boxes that cut a tile.
inline constexpr int strip_width = 16;

/// A plan, and the curvatures between which it interpolates. Its error follows from them (plane_plan.h).
struct PlanesModel {
  PlanesPlan plan;
  double wavelength, pitch, tangent;  ///< tangent: of the panel's acceptance, with a margin for rounding
  std::vector<double> nodes;          ///< Chebyshev points in (−1, 1)
  std::vector<float> denominators;    ///< Π (τ_q − τ_m), m ≠ q

  PlanesModel(const PlanesPlan& plan, double wavelength, double pitch);
};

/// The same with the constants of its kernel, shared by all tiles. They take milliseconds to compute.
struct PlanesTables : PlanesModel {
  GriddingKernel kernel;
  int transform;                   ///< length of the FFTs
  int cells;                       ///< cells of a grid along one axis: the transform's and a margin on either side
  ColumnFft<float> along_columns;  ///< of that length
  std::vector<float> inverse_phi;  ///< 1/φ̂ for each of the tile's pixels along an axis
  /// ∫xⁿφ·exp(2πiξx)dx/φ̂ for each, n = 1, 2 [cyclesⁿ/mⁿ]: moments of the distance from a wave to the cells that it is
  /// spread over.
  std::vector<float> first, second;

  PlanesTables(const PlanesPlan& plan, double wavelength, double pitch);
  static constexpr int margin = 8;          ///< cells on either side
  int stride() const { return cells + 8; }  ///< cells per line, not a power of two, to avoid cache conflicts
  /// Nodes for which a cell has room: the next power of two, so that the nodes of a cell fill vectors.
  int slots() const { return int(std::bit_ceil(unsigned(plan.nodes))); }
  /// Floats of the grids of all nodes.
  size_t grid_size() const { return 2 * size_t(slots()) * size_t(cells) * size_t(stride()); }
};

/// Waves [first, last) that are neighbours: what they light together, and where they are [m]. A tile takes or leaves
/// them as a whole if it can.
struct WavePacket {
  size_t first, last;
  PixelBox lit_by_any, lit_by_all;
  double x0, x1, y0, y1, nearest;  ///< nearest: the least depth
};

/// @param waves  [first, last) of them, at least one
WavePacket packet_of_waves(PreparedWaves waves, size_t first, size_t last);

/// Waves of similar depth. Their curvatures κ = (1 − ρ²/2r₀²)/λr₀ in any tile lie within `half` of `centre`
/// [cycles/m²].
struct Slab {
  size_t first, last;  ///< range in the list of waves
  double centre, half;
  std::vector<WavePacket> packets{};  ///< of that range
};

/// Waves of a packet at most.
inline constexpr size_t waves_of_packet = 64;

/// Most entries of a strip's list, and most waves left for direct sums: their lists take little memory however many waves
/// an edge cuts, and a strip's are in the cache.
inline constexpr size_t most_entries = size_t(1) << 14;

/// Part of a wave in a tile: the lines [first, last) of one strip, to be added or subtracted.
struct StripEntry {
  uint32_t wave;
  int8_t first, last, sign;
};

/// An entry as its strip uses it: the first of the cells that it is spread over and the fraction of a cell (gridding_kernel.h),
/// its phase [cycles] and modulus on the strip's middle line, what gives them on others (wave_lanes-inl.h), its lines, and the
/// weights of the nodes.
struct StripWave {
  int32_t cell;
  float fraction, phase, scale, twice_x, inverse_r0_squared, r0_over_wavelength;
  int8_t first, last;
  float weights[8];
};

/// Buffers of one thread, reused from tile to tile.
struct PlanesWorkspace {
  AlignedVector<float> grids;              ///< [line][cell][slot of a node], complex
  AlignedVector<float> strip;              ///< [cell][node][16 real, 16 imaginary]
  std::vector<StripEntry> entries[2][16];  ///< [across columns, across rows][strip], most_entries or fewer in each
  std::vector<StripWave> of_strip;         ///< one for each entry of a strip
  std::vector<uint32_t> order, ends;       ///< their order by cells, and its end for each cell
  std::vector<PreparedWave> direct;        ///< waves left for sum_tile, cut to the tile; most_entries or fewer
  TileWorkspace of_direct;                 ///< buffers for sum_tile
  AlignedVector<std::complex<float>> folded, unfolded, spare, columns, turned, terms, tile;  ///< for the transforms

  /// Whether another packet may have more entries than a list has room for.
  bool is_full() const;
};

/// Memory of a workspace at most: the grids of a tile of 240 pixels at 4 nodes and their transforms (21 MB, measured), and
/// the lists of its 30 strips [bytes].
inline constexpr double workspace_bytes = 21e6 + double(most_entries) * (30 * sizeof(StripEntry) + sizeof(StripWave) +
                                                                         sizeof(uint32_t) + sizeof(PreparedWave));

/// A tile of the panel, and the position of its reference pixel (tile/2, tile/2) [m].
struct TilePlace {
  PixelBox box;
  double x, y;
};

/// Spreads the slab's waves that light the whole tile over the grids of the workspace. Waves that light a part of it go
/// to its strips or to `direct`. It ends early if the workspace is full.
/// @param packet  of the slab, the first that is spread; then the first that is left, slab.packets.size() if none is
/// @return        whether any wave was spread over the grids
bool spread_waves(PreparedWaves waves, const Slab& slab, const PlanesTables& tables, const TilePlace& tile,
                  size_t& packet, PlanesWorkspace& workspace);

/// A strip of a tile, of rows (is_across_rows) or of columns, counted from the tile's first strip.
struct Strip {
  bool is_across_rows;
  int index;
};

/// Spreads the entries of one strip (workspace.entries) over workspace.strip; each line is spread along the other axis.
void spread_strip(PreparedWaves waves, const Slab& slab, const PlanesTables& tables, const TilePlace& tile,
                  const Strip& strip, PlanesWorkspace& workspace);

}  // namespace holotrace
