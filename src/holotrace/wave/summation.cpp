#include "holotrace/wave/summation.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/thread_count.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/part_plan.h"
#include "holotrace/wave/planes/device_planes.h"
#include "holotrace/wave/tiles/device_tiles.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {
namespace {

constexpr double bytes_per_wave = 340;  // prepared, split into far and near, sorted
// Besides, on devices: the waves as all devices get them; for `planes` up to four boxes that append_rest leaves, as they are and
// as devices get them, and packets.
constexpr double bytes_per_wave_on_devices = sizeof(DeviceWave);
constexpr double bytes_of_rest =
    4 * (sizeof(PreparedWave) + sizeof(DeviceWave)) + double(sizeof(PlanePacket)) / packet_waves;

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

// Far waves by planes in the tiles that they light wholly, and all other light by tiles.
void run_on_devices(const PartPlan& plan, const PixelBox& bounds, const std::vector<Device*>& devices, SummedField& sum,
                    const Observer& observer) {
  const Grid& grid = sum.field.grid;
  const double wavelength = sum.field.wavelength;
  const TileShape shape = plan.tiles.plan.shape;
  const auto by_tiles = [&](const std::vector<PreparedWave>& waves, const MoreLight& more) {
    if (sum.there) return sum_tiles_on_device(waves, shape, bounds, *sum.there, observer, more);
    sum_tiles_on_devices(devices, waves, {grid, wavelength}, shape, bounds, sum.field.samples, observer, more);
  };
  if (plan.far.empty()) return by_tiles(plan.near, {});
  const PlanesTables tables(plan.planes.plan, wavelength, grid.pitch);
  const SortedWaves far = sort_waves(plan.far, tables.plan, wavelength, grid.pitch);
  std::vector<PreparedWave> in_tiles = plan.near;
  append_rest(far.waves, {grid, bounds, tables.plan.tile, tables.tangent}, in_tiles);
  const PacketedWaves packeted(far, tables, grid, bounds);
  const auto make = [&](Device& device) {
    const auto planes = std::make_shared<DevicePlanes>(device, packeted, tables);
    return LightOnDevice{[=](const auto&... band) { planes->add(band...); }, planes->least_memory()};
  };
  by_tiles(in_tiles, {make, tables.plan.tile});
}

// Computes the pixels of `bounds`; their old values are overwritten.
void run_plan(const PartPlan& plan, const PixelBox& bounds, const std::vector<Device*>& devices, SummedField& sum,
              const Observer& observer) {
  if (!devices.empty()) return run_on_devices(plan, bounds, devices, sum, observer);
  Field& field = sum.field;
  for (int j = bounds.y0; j < bounds.y1; ++j)
    std::fill_n(field.samples.row(j) + bounds.x0, bounds.x1 - bounds.x0, std::complex<float>());
  const int parts = !plan.far.empty() + !plan.near.empty();
  if (!plan.far.empty()) {
    const SortedWaves waves = sort_waves(plan.far, plan.planes.plan, field.wavelength, field.grid.pitch);
    const PlanesTables tables(plan.planes.plan, field.wavelength, field.grid.pitch);
    const TilePlan of_corners = plan_of_corners(plan.tiles.plan, tables.plan.tile);
    const PlanesSum sum{waves, tables, of_corners, field.grid};
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
  Device* const device = way.stays ? way.device() : nullptr;
  if (!device || 2 * bytes > device->memory_left() || bytes > device->free_memory()) return {Field(grid, wavelength)};
  SummedField sum;
  sum.field.grid = grid;
  sum.field.wavelength = wavelength;
  sum.there = make_device_field(*device, sum.field);
  clear(*sum.there);
  return sum;
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
    const PartPlan plan = make_part_plan(waves, goal, way);
    part = {false, 1.25 * plan.error(), plan.far.empty() ? "tiled" : "planes", describe(plan, way.devices),
            part.predicted_seconds};
    if (!plan.meets_tolerance()) return part;
    part.predicted_seconds += seconds_of(plan, bounds, way);
    run_plan(plan, bounds, way.devices, field, observer);
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

double host_bytes_per_wave(bool is_on_devices, Approach approach) {
  if (!is_on_devices) return bytes_per_wave;
  return bytes_per_wave + bytes_per_wave_on_devices + (approach == Approach::tiled ? 0 : bytes_of_rest);
}

double host_bytes_per_thread() { return workspace_bytes; }

std::optional<SummedField> try_sum(const Sources& sources, const Grid& grid, double tolerance, const SumWay& way,
                                   double& reachable, const Observer& observer) {
  check_grid(grid);
  check_sources_behind(sources);
  require(!way.device() || !has_astigmatic(sources),
          "expected spherical waves on a device, got astigmatic ones; sum them on the cpu");
  require_memory(sizeof(std::complex<float>) * double(grid.pixels()) +
                     host_bytes_per_wave(way.device() != nullptr, way.approach) * double(sources.waves.size()) +
                     host_bytes_per_thread() * thread_count(),
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
          way.approach == Approach::tiled ? "tiles" : "planes", reachable, tolerance);
  return std::move(*field);
}

SumForecast forecast_sum(const Sources& sources, const Grid& grid, double tolerance, const SumWay& way) {
  check_grid(grid);
  check_sources_behind(sources);
  SumForecast forecast;
  for (int part = 0; part < panel_parts(sources); ++part) {
    const std::vector<PreparedWave> waves = prepare_waves(sources, grid, part);
    if (waves.empty()) continue;
    const PixelBox bounds = panel_part(sources, grid, part);
    const PartPlan plan = make_part_plan(waves, {grid, bounds, sources.wavelength, tolerance}, way);
    if (!plan.meets_tolerance()) return {};
    forecast.seconds += seconds_of(plan, bounds, way);
    forecast.method = plan.far.empty() ? "tiled" : "planes";
  }
  return forecast;
}

}  // namespace holotrace
