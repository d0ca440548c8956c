#include "holotrace/wave/sum_tiled.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/packed_product.h"
#include "holotrace/wave/tile_error.h"
#include "holotrace/wave/tile_sum.h"

namespace holotrace {
namespace {

// Sums the waves into the pixels of `bounds`, tile by tile from its top left corner on; overwrites them.
void sum_tiles(const std::vector<PreparedWave>& waves, const PixelBox& bounds, const TilePlan& plan, Field& field,
               const Observer& observer) {
  const TileShape tile = plan.shape;
  tbb::enumerable_thread_specific<TileWorkspace> workspaces;
  const int across = (bounds.x1 - bounds.x0 + tile.columns - 1) / tile.columns;
  const int down = (bounds.y1 - bounds.y0 + tile.rows - 1) / tile.rows;
  parallel_for(
      0, int64_t(across) * down,
      [&](int64_t t) {
        const int x0 = bounds.x0 + int(t % across) * tile.columns, y0 = bounds.y0 + int(t / across) * tile.rows;
        const PixelBox box{x0, std::min(x0 + tile.columns, bounds.x1), y0, std::min(y0 + tile.rows, bounds.y1)};
        sum_tile(waves, field.grid, field.wavelength, plan, box, workspaces.local(), field.samples);
      },
      observer);
}

// Energy of the field in the bounds over the sum of its waves' energies there.
double coherence_of(const Field& field, const PixelBox& bounds, const SplitEnergies& energies) {
  double sum = 0;
  for (int j = bounds.y0; j < bounds.y1; ++j)
    for (int i = bounds.x0; i < bounds.x1; ++i) sum += std::norm(std::complex<double>(field.samples(j, i)));
  return energies.waves > 0 ? sum / energies.waves : 1;
}

// One part of the panel: the tile that was taken and the error expected of it, or no tile that meets the tolerance.
struct PartSum {
  bool meets_tolerance = false;
  TilePlan plan{};
  double reachable = 0;  // a tolerance that is met
};

PartSum sum_part(const std::vector<PreparedWave>& waves, const PixelBox& bounds, double tolerance, Field& field,
                 const Observer& observer) {
  // The second round, where the waves cancel, knows their coherence; a field that is nearly nothing may need a third.
  PartSum part;
  double coherence = 1;
  for (int round = 0; round < 3; ++round) {
    const TileChoice choice = choose_tile(waves, field.grid, bounds, field.wavelength, tolerance, coherence);
    part = {false, choice.plan, 1.25 * choice.error};
    if (!choice.meets_tolerance) return part;
    sum_tiles(waves, bounds, choice.plan, field, observer);
    const double met = std::min(1.0, coherence_of(field, bounds, choice.energies));
    part.reachable = 1.25 * choice.error * std::sqrt(coherence / met);
    if (part.reachable <= tolerance) {
      part.meets_tolerance = true;
      return part;
    }
    coherence = met;
  }
  return part;
}

std::string products_name(TileProducts products) {
  if (products == TileProducts::single) return "single precision on " + sum_tiled_instruction_set();
  return (products == TileProducts::bf16 ? "bf16 on " : "bf16 in two parts on ") + packed_unit_name();
}

}  // namespace

std::optional<Field> try_sum_tiled(const Sources& sources, const Grid& grid, double tolerance, double& reachable,
                                   const Observer& observer) {
  check_grid(grid);
  check_sources(sources);
  check_field_fits(grid, sizeof(std::complex<float>));
  Field field(grid, sources.wavelength);
  // Parts whose error is at most the tolerance times their own energy make a whole of which the same holds.
  PartSum worst;
  const int parts = panel_parts(sources);
  for (int part = 0; part < parts; ++part) {
    const std::vector<PreparedWave> waves = prepare_waves(sources, grid, part);
    if (waves.empty()) continue;
    const PartSum done =
        sum_part(waves, panel_part(sources, grid, part), tolerance, field, part_of(observer, part, parts));
    if (done.reachable >= worst.reachable) worst = done;
    reachable = worst.reachable;
    if (!done.meets_tolerance) return std::nullopt;
  }
  if (worst.reachable == 0) return field;
  observer.fact("tile", fmt::format("{}x{}", worst.plan.shape.columns, worst.plan.shape.rows));
  observer.fact("products", products_name(worst.plan.products));
  observer.fact("expected_error", worst.reachable / 1.25);
  return field;
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
