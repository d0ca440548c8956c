#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <complex>
#include <span>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/tiles/tile_error.h"

namespace holotrace {

/// Waves of an array.
using WaveList = std::span<const PreparedWave* const>;

/// Buffers of one thread, reused from tile to tile.
struct TileWorkspace {
  AlignedVector<float> columns, rows, sums;
  AlignedVector<uint32_t> packed_columns, packed_rows;
  std::vector<const PreparedWave*> waves;  // of a group of tiles
};

/// Those of the waves whose boxes meet `box`, in their order.
void list_waves(PreparedWaves waves, const PixelBox& box, std::vector<const PreparedWave*>& list);

/// Adds the waves whose boxes meet `box`, the part of a tile on the grid, to the samples
/// there. The tile starts at (box.x0, box.y0) and may extend past the grid. This is the hot loop of
/// sum_tiled, compiled once for every instruction set and chosen at run time.
void sum_tile(WaveList waves, const LitGrid& panel, const TilePlan& plan, const PixelBox& box, TileWorkspace& workspace,
              Array2D<std::complex<float>>& samples);

/// Calls work(box, workspace) for the tiles that cover `bounds`, from its top left corner on, on all threads.
template <class Workspace, class Work>
void for_each_tile(const PixelBox& bounds, TileShape tile, const Work& work, const Observer& observer) {
  tbb::enumerable_thread_specific<Workspace> workspaces;
  const int across = (bounds.x1 - bounds.x0 + tile.columns - 1) / tile.columns;
  const int down = (bounds.y1 - bounds.y0 + tile.rows - 1) / tile.rows;
  parallel_for(
      0, int64_t(across) * down,
      [&](int64_t t) {
        const int x0 = bounds.x0 + int(t % across) * tile.columns, y0 = bounds.y0 + int(t / across) * tile.rows;
        work(PixelBox{x0, std::min(x0 + tile.columns, bounds.x1), y0, std::min(y0 + tile.rows, bounds.y1)},
             workspaces.local());
      },
      observer);
}

/// Adds the waves to the samples of `bounds`, in tiles from its top left corner on, on all threads.
void sum_tiles(PreparedWaves waves, const LitGrid& panel, const TilePlan& plan, const PixelBox& bounds,
               Array2D<std::complex<float>>& samples, const Observer& observer = {});

/// Name of the instruction set that sum_tile uses on this machine: "AVX3", "AVX2", "SSE4", …
std::string tile_sum_instruction_set();

}  // namespace holotrace
