#include "holotrace/wave/sum_tiled.h"

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/tile_error.h"
#include "holotrace/wave/tile_sum.h"

namespace holotrace {
Field sum_tiled(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer) {
  check_grid(grid);
  check_sources(sources);
  check_field_fits(grid, sizeof(std::complex<float>));
  Field field(grid, sources.wavelength);
  const std::vector<PreparedWave> waves = prepare_waves(sources, grid);
  if (waves.empty()) return field;

  const auto [tile, error, meets_tolerance] = choose_tile(waves, grid, sources.wavelength, tolerance);
  require(
      meets_tolerance,
      "expected a tolerance that tiles can meet, {:.1e} or more for these sources, got {:.1e}; use the method exact",
      1.25 * error, tolerance);
  observer.fact("tile", fmt::format("{}x{}", tile.columns, tile.rows));
  observer.fact("expected_error", error);
  const int across = (grid.nx + tile.columns - 1) / tile.columns, down = (grid.ny + tile.rows - 1) / tile.rows;
  parallel_for(
      0, int64_t(across) * down,
      [&](int64_t t) {
        const int x0 = int(t % across) * tile.columns, y0 = int(t / across) * tile.rows;
        const PixelBox box{x0, std::min(x0 + tile.columns, grid.nx), y0, std::min(y0 + tile.rows, grid.ny)};
        sum_tile(waves, grid, sources.wavelength, tile, box, field.samples);
      },
      observer);
  return field;
}

}  // namespace holotrace
