#include "holotrace/wave/sum_tiled.h"

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/tile_error.h"
#include "holotrace/wave/tile_sum.h"

namespace holotrace {
namespace {

Field sum_tiles(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength, TileShape tile,
                const Observer& observer) {
  Field field(grid, wavelength);
  const int across = (grid.nx + tile.columns - 1) / tile.columns, down = (grid.ny + tile.rows - 1) / tile.rows;
  parallel_for(
      0, int64_t(across) * down,
      [&](int64_t t) {
        const int x0 = int(t % across) * tile.columns, y0 = int(t / across) * tile.rows;
        const PixelBox box{x0, std::min(x0 + tile.columns, grid.nx), y0, std::min(y0 + tile.rows, grid.ny)};
        sum_tile(waves, grid, wavelength, tile, box, field.samples);
      },
      observer);
  return field;
}

// Energy of the field over the sum of its waves' energies.
double coherence_of(const Field& field, const SplitEnergies& energies) {
  const double pixel = field.grid.pitch * field.grid.pitch;
  return energies.waves > 0 ? power(field) / pixel / energies.waves : 1;
}

}  // namespace

std::optional<Field> try_sum_tiled(const Sources& sources, const Grid& grid, double tolerance, double& reachable,
                                   const Observer& observer) {
  check_grid(grid);
  check_sources(sources);
  check_field_fits(grid, sizeof(std::complex<float>));
  const std::vector<PreparedWave> waves = prepare_waves(sources, grid);
  if (waves.empty()) return Field(grid, sources.wavelength);

  // The second round, where the waves cancel, knows their coherence; a field that is nearly nothing may need a third.
  double coherence = 1;
  for (int round = 0; round < 3; ++round) {
    const TileChoice choice = choose_tile(waves, grid, sources.wavelength, tolerance, coherence);
    reachable = 1.25 * choice.error;
    if (!choice.meets_tolerance) return std::nullopt;
    Field field = sum_tiles(waves, grid, sources.wavelength, choice.tile, observer);
    const double met = std::min(1.0, coherence_of(field, choice.energies));
    reachable = 1.25 * choice.error * std::sqrt(coherence / met);
    if (reachable <= tolerance) {
      observer.fact("tile", fmt::format("{}x{}", choice.tile.columns, choice.tile.rows));
      observer.fact("expected_error", reachable / 1.25);
      return field;
    }
    coherence = met;
  }
  return std::nullopt;
}

Field sum_tiled(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer) {
  double reachable = 0;
  std::optional<Field> field = try_sum_tiled(sources, grid, tolerance, reachable, observer);
  require(
      field.has_value(),
      "expected a tolerance that tiles can meet, {:.1e} or more for these sources, got {:.1e}; use the method exact",
      reachable, tolerance);
  return std::move(*field);
}

}  // namespace holotrace
