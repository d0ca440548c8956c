#include "holotrace/wave/summation.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/thread_count.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/planes/plane_plan.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/tiles/device_tiles.h"
#include "holotrace/wave/tiles/packed_product.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {
namespace {

constexpr double from_memory = 1.6;        // the rates hold for a tile in the caches; `planes` reads all waves per tile
constexpr double seconds_to_plan = 0.2;    // for `planes`; it pays for many waves only
constexpr double bytes_per_wave = 340;     // prepared, split into far and near, sorted
constexpr double bytes_per_thread = 15e6;  // grids of a tile of 240 pixels at 4 nodes, and its transforms

// The waves of one part of the panel, split into those for `planes` (far) and for tiles (near), and both plans.
struct PartPlan {
  std::vector<PreparedWave> far, near;
  PlanesChoice planes;
  TileChoice tiles;

  bool meets_tolerance() const {
    return (far.empty() || planes.meets_tolerance) && tiles.meets_tolerance;  // `planes` also uses tiles
  }
  double error() const { return std::max(far.empty() ? 0 : planes.error, near.empty() ? 0 : tiles.error); }
  double energy() const { return planes.energies.waves + (near.empty() ? 0 : tiles.energies.waves); }
};

SummationWork work_of_tiles(const std::vector<PreparedWave>& waves, const TilePlan& plan) {
  double pixels = 0;
  for (const PreparedWave& wave : waves) pixels += double(wave.box.pixels());
  return pixels * tile_work(plan);
}

SummationWork work_of(const PartPlan& plan) {
  return (plan.far.empty() ? SummationWork() : plan.planes.work) + work_of_tiles(plan.near, plan.tiles.plan);
}

PartPlan plan_tiles(std::vector<PreparedWave> waves, const SumGoal& goal) {
  PartPlan plan;
  plan.tiles = choose_tile(draw_pixels(waves), goal);
  plan.near = std::move(waves);
  return plan;
}

PartPlan plan_planes(const std::vector<PreparedWave>& waves, const SumGoal& goal, double most_seconds) {
  PartPlan plan;
  for (const PreparedWave& wave : waves)
    (suits_planes(wave, goal.wavelength, goal.grid.pitch) ? plan.far : plan.near).push_back(wave);
  const std::vector<PreparedWave>& in_tiles = plan.near.empty() ? waves : plan.near;  // or the corners of boxes
  plan.tiles = choose_tile(draw_pixels(in_tiles), goal);
  if (!plan.far.empty()) plan.planes = choose_planes(plan.far, plan.tiles.plan, goal, most_seconds);
  return plan;
}

PartPlan plan_on_device(std::vector<PreparedWave> waves, const SumGoal& goal, const Device& device) {
  PartPlan plan;
  plan.tiles = choose_device_tile(device, draw_pixels(waves), goal);
  plan.near = std::move(waves);
  return plan;
}

PartPlan make_plan(const std::vector<PreparedWave>& waves, const SumGoal& goal, const SumWay& way) {
  if (way.device) return plan_on_device(waves, goal, *way.device);
  const Approach approach = way.approach;
  if (approach == Approach::planes) return plan_planes(waves, goal, 1e300);
  PartPlan tiles = plan_tiles(waves, goal);
  if (approach == Approach::tiled) return tiles;
  const auto seconds = [](const PartPlan& plan) { return predict_seconds(work_of(plan), summation_rates(), 1); };
  const double by_tiles = tiles.meets_tolerance() ? seconds(tiles) : 1e300;
  if (by_tiles < seconds_to_plan) return tiles;
  PartPlan planes = plan_planes(waves, goal, by_tiles);
  if (planes.far.empty() || !planes.meets_tolerance()) return tiles;
  return from_memory * seconds(planes) + seconds_to_plan < by_tiles ? planes : tiles;
}

// What one sum on a device takes besides its work: the start of kernels, and waiting for them.
constexpr double seconds_of_start = 1e-3;

double seconds_on_device(const PartPlan& plan, const PixelBox& bounds, const SumWay& way) {
  const DeviceRates rates = device_rates(*way.device);
  double pixels = 0;
  for (const PreparedWave& wave : plan.near) pixels += double(wave.box.pixels());
  return pixels * multiply_adds_per_wave_pixel(plan.tiles.plan.shape) / rates.multiply_adds +
         transferred_bytes(plan.near.size(), way.stays ? PixelBox{} : bounds) / rates.bytes + seconds_of_start;
}

// Predicted seconds, with all threads; infinite for a device that was not measured.
double seconds_of(const PartPlan& plan, const PixelBox& bounds, const SumWay& way) {
  if (way.device) return seconds_on_device(plan, bounds, way);
  return (plan.far.empty() ? 1 : from_memory) * predict_seconds(work_of(plan), summation_rates(), thread_count());
}

// Calls work(box, buffers) for the tiles that cover `bounds`, from its top left corner on.
template <class Buffers, class Work>
void for_each_tile(const PixelBox& bounds, TileShape tile, const Work& work, const Observer& observer) {
  tbb::enumerable_thread_specific<Buffers> buffers;
  const int across = (bounds.x1 - bounds.x0 + tile.columns - 1) / tile.columns;
  const int down = (bounds.y1 - bounds.y0 + tile.rows - 1) / tile.rows;
  parallel_for(
      0, int64_t(across) * down,
      [&](int64_t t) {
        const int x0 = bounds.x0 + int(t % across) * tile.columns, y0 = bounds.y0 + int(t / across) * tile.rows;
        work({x0, std::min(x0 + tile.columns, bounds.x1), y0, std::min(y0 + tile.rows, bounds.y1)}, buffers.local());
      },
      observer);
}

// Computes the pixels of `bounds`; their old values are overwritten.
void run_plan(const PartPlan& plan, const PixelBox& bounds, Device* device, SummedField& sum,
              const Observer& observer) {
  if (sum.there) return sum_tiles_on_device(plan.near, plan.tiles.plan.shape, bounds, *sum.there, observer);
  Field& field = sum.field;
  if (device)
    return sum_tiles_on_device(*device, plan.near, {field.grid, field.wavelength}, plan.tiles.plan.shape, bounds,
                               field.samples, observer);
  for (int j = bounds.y0; j < bounds.y1; ++j)
    std::fill_n(field.samples.row(j) + bounds.x0, bounds.x1 - bounds.x0, std::complex<float>());
  const int parts = !plan.far.empty() + !plan.near.empty();
  if (!plan.far.empty()) {
    const SortedWaves waves = sort_waves(plan.far, plan.planes.plan, field.wavelength, field.grid.pitch);
    const PlanesTables tables(plan.planes.plan, field.wavelength, field.grid.pitch);
    const PlanesSum sum{waves, tables, plan.tiles.plan, field.grid};
    for_each_tile<PlanesWorkspace>(
        bounds, {tables.plan.tile, tables.plan.tile},
        [&](const PixelBox& box, PlanesWorkspace& own) { sum_planes_tile(sum, box, own, field.samples); },
        part_of(observer, 0, parts));
  }
  if (!plan.near.empty())
    for_each_tile<TileWorkspace>(
        bounds, plan.tiles.plan.shape,
        [&](const PixelBox& box, TileWorkspace& own) {
          sum_tile(plan.near, {field.grid, field.wavelength}, plan.tiles.plan, box, own, field.samples);
        },
        part_of(observer, parts - 1, parts));
}

// Energy of the field in the bounds over the sum of its waves' energies there.
double coherence_of(const SummedField& sum, const PixelBox& bounds, double energy_of_waves) {
  if (!(energy_of_waves > 0)) return 1;
  if (sum.there) return energy(*sum.there, bounds) / energy_of_waves;
  double energy = 0;
  for (int j = bounds.y0; j < bounds.y1; ++j)
    for (int i = bounds.x0; i < bounds.x1; ++i) energy += std::norm(std::complex<double>(sum.field.samples(j, i)));
  return energy / energy_of_waves;
}

// A dark field where it is to be summed. It stays on a device if that has as much memory again for the sum.
SummedField dark_field(const Grid& grid, double wavelength, const SumWay& way) {
  const double bytes = double(grid.pixels()) * sizeof(std::complex<float>);
  if (!way.device || !way.stays || 2 * bytes > way.device->memory_left() || bytes > way.device->free_memory())
    return {Field(grid, wavelength)};
  SummedField sum;
  sum.field.grid = grid;
  sum.field.wavelength = wavelength;
  sum.there = make_device_field(*way.device, sum.field);
  clear(*sum.there);
  return sum;
}

std::string name_of(TileProducts products) {
  if (products == TileProducts::single) return "single precision on " + tile_sum_instruction_set();
  return (products == TileProducts::bf16 ? "bf16 on " : "bf16 in two parts on ") + packed_unit_name();
}

std::string describe(const PartPlan& plan, const Device* device) {
  std::string text;
  if (!plan.far.empty()) {
    const PlanesPlan& p = plan.planes.plan;
    text = fmt::format("tiles of {0}x{0}, {1} slab(s) of {2} nodes, kernel of {3} cells{4}", p.tile, p.slabs, p.nodes,
                       p.width, p.is_corrected ? ", corrected" : "");
  }
  if (!plan.near.empty()) {
    const TilePlan& p = plan.tiles.plan;
    text += fmt::format("{}tiles of {}x{} in {}",
                        text.empty() ? "" : fmt::format("; {} near waves by ", plan.near.size()), p.shape.columns,
                        p.shape.rows, device ? "single precision on " + device->info().name : name_of(p.products));
  }
  return text;
}

// The result for one part of the panel: how it was summed, or which tolerance could be met.
struct PartSum {
  bool meets_tolerance = false;
  double reachable = 0;
  std::string method, how;
  double predicted_seconds = 0;  // sum over all rounds
};

PartSum sum_part(const std::vector<PreparedWave>& waves, SumGoal goal, const SumWay& way, bool is_whole,
                 SummedField& field, const Observer& observer) {
  const PixelBox& bounds = goal.bounds;
  // If the waves cancel, the second round knows their coherence; a field that nearly vanishes may need a third round.
  PartSum part;
  for (int round = 0; round < 3; ++round) {
    const PartPlan plan = make_plan(waves, goal, way);
    part = {false, 1.25 * plan.error(), plan.far.empty() ? "tiled" : "planes", describe(plan, way.device),
            part.predicted_seconds};
    if (!plan.meets_tolerance()) return part;
    part.predicted_seconds += seconds_of(plan, bounds, way);
    run_plan(plan, bounds, way.device, field, observer);
    // A part of a few pixels may be dark by chance. It has little weight in the whole, to which the tolerance applies.
    const double least = is_whole ? 0 : 1 / std::sqrt(double(bounds.pixels()));
    const double met = std::clamp(coherence_of(field, bounds, plan.energy()), least, 1.0);
    part.reachable = 1.25 * plan.error() * std::sqrt(goal.coherence / met);
    if (part.reachable <= goal.tolerance) {
      part.meets_tolerance = true;
      return part;
    }
    goal.coherence = met;
  }
  return part;
}

}  // namespace

std::optional<SummedField> try_sum(const Sources& sources, const Grid& grid, double tolerance, const SumWay& way,
                                   double& reachable, const Observer& observer) {
  check_grid(grid);
  check_sources(sources);
  require_memory(sizeof(std::complex<float>) * double(grid.pixels()) + bytes_per_wave * double(sources.waves.size()) +
                     bytes_per_thread * thread_count(),
                 fmt::format("a field of {} × {} samples", grid.nx, grid.ny));
  SummedField field = dark_field(grid, sources.wavelength, way);
  // If every part has an error of at most the tolerance times its own energy, so has the whole.
  PartSum worst;
  double predicted = 0;
  const int parts = panel_parts(sources);
  for (int part = 0; part < parts; ++part) {
    const std::vector<PreparedWave> waves = prepare_waves(sources, grid, part);
    if (waves.empty()) continue;
    const PartSum done = sum_part(waves, {grid, panel_part(sources, grid, part), sources.wavelength, tolerance}, way,
                                  parts == 1, field, part_of(observer, part, parts));
    if (!(done.reachable < worst.reachable)) worst = done;
    predicted += done.predicted_seconds;
    reachable = worst.reachable;
    if (!done.meets_tolerance) return std::nullopt;
  }
  if (worst.reachable == 0) return field;
  observer.fact("method", worst.method);
  observer.fact("how", worst.how);
  if (std::isfinite(predicted)) observer.fact("predicted_seconds", predicted);
  observer.fact("expected_error", worst.reachable / 1.25);
  return field;
}

SummedField sum_within(const Sources& sources, const Grid& grid, double tolerance, const SumWay& way,
                       const Observer& observer) {
  double reachable = 0;
  std::optional<SummedField> field = try_sum(sources, grid, tolerance, way, reachable, observer);
  require(field.has_value(),
          "expected a tolerance that {} can meet, {:.1e} or more for these sources, got {:.1e}; use the method exact",
          way.device || way.approach == Approach::tiled ? "tiles" : "planes", reachable, tolerance);
  return std::move(*field);
}

SumForecast forecast_sum(const Sources& sources, const Grid& grid, double tolerance, const SumWay& way) {
  check_grid(grid);
  check_sources(sources);
  SumForecast forecast;
  for (int part = 0; part < panel_parts(sources); ++part) {
    const std::vector<PreparedWave> waves = prepare_waves(sources, grid, part);
    if (waves.empty()) continue;
    const PixelBox bounds = panel_part(sources, grid, part);
    const PartPlan plan = make_plan(waves, {grid, bounds, sources.wavelength, tolerance}, way);
    if (!plan.meets_tolerance()) return {};
    forecast.seconds += seconds_of(plan, bounds, way);
    forecast.method = plan.far.empty() ? "tiled" : "planes";
  }
  return forecast;
}

}  // namespace holotrace
