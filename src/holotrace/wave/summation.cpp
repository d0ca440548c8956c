#include "holotrace/wave/summation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/planes/device_planes.h"
#include "holotrace/wave/planes/plane_plan.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "holotrace/wave/tiles/device_tiles.h"
#include "holotrace/wave/tiles/packed_product.h"
#include "holotrace/wave/tiles/tile_error.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {
namespace {

/// The waves of one part of the panel, split into those for `planes` (far) and for tiles (near), and both plans. The plan
/// for tiles also serves the light of far waves in tiles that they light partly.
struct PartPlan {
  PreparedWaves far{}, near{};  // of the part's waves, or of `split`
  std::shared_ptr<const std::array<std::vector<PreparedWave>, 2>>
      split{};  // shared, so that copies have the same waves
  PlanesChoice planes{};
  TileChoice tiles{};

  bool meets_tolerance() const {
    return (far.empty() || planes.meets_tolerance) && tiles.meets_tolerance;  // `planes` also uses tiles
  }
  double error() const { return std::max(far.empty() ? 0 : planes.error, near.empty() ? 0 : tiles.error); }
  double energy() const { return planes.energies.waves + (near.empty() ? 0 : tiles.energies.waves); }
};

constexpr double unmeasured = std::numeric_limits<double>::infinity();  // seconds on a device that was not measured

// For `planes`, on one thread: to compare plans, and to sort a wave.
constexpr double seconds_to_plan = 4e-3, seconds_to_sort = 2e-7;
// On a device fewer kinds of plans are compared; and a thread of the processor sorts a wave, and cuts its box.
constexpr double seconds_to_plan_for_device = 0.05, seconds_to_sort_and_cut = 6e-7;

// Seconds of one thread of the processor.
double seconds_on_processor(const PartPlan& plan, const PixelBox& bounds) {
  const double by_planes = plan.far.empty() ? 0 : plan.planes.seconds + seconds_to_sort * double(plan.far.size());
  return by_planes + predict_seconds(work_of_tiles(plan.near, plan.tiles.plan, bounds), summation_rates(), 1);
}

// What one sum on a device takes besides its work: the start of kernels, and waiting for them.
constexpr double seconds_of_start = 1e-3;

bool is_measured(const DeviceRates& rates) { return rates.multiply_adds > 0 && rates.bytes > 0; }

double seconds_on_devices(const PartPlan& plan, const PixelBox& bounds, const SumWay& way) {
  const DeviceRates rates = device_rates(*way.device());
  if (!is_measured(rates)) return unmeasured;
  const TileShape shape = plan.tiles.plan.shape;
  // The device with most rows decides; blocks of planes in which two shares meet are computed twice.
  const int rows = std::max(bounds.y1 - bounds.y0, 1), block = plan.far.empty() ? 1 : plan.planes.plan.tile;
  const double share = std::min(rows, rows_of_share(rows, way.devices.size(), shape, block));
  const double by_tiles = pixels_of_tiles(plan.near, shape, bounds) * multiply_adds_per_wave_pixel(shape) /
                          rates.multiply_adds * share / rows;
  const double by_planes =
      plan.far.empty() ? 0 : plan.planes.seconds * rows_computed_by_one(rows, way.devices.size(), shape, block) / rows;
  // Far waves are sent twice: for their whole tiles, and for what they light of others. Each device gets all waves.
  const size_t sent = way.devices.size() * (plan.near.size() + 2 * plan.far.size());
  const double sorting = seconds_to_sort_and_cut * double(plan.far.size()) / processor_threads();
  return by_tiles + by_planes + transferred_bytes(sent, way.stays ? PixelBox{} : bounds) / rates.bytes + sorting +
         seconds_of_start;
}

// Cost of plans for `planes` on a device. An edge of a box leaves about half of a tile of the plan to the sum in tiles, whose own
// tiles reach beyond it.
PlanesCost planes_cost_on_device(Device& device, TileShape shape) {
  DeviceRates rates = device_rates(device);
  // Plans of a device that was not measured are compared by the rates of an ordinary card.
  if (!(rates.multiply_adds > 0)) rates.multiply_adds = 1e12;
  if (!(rates.moved_bytes > 0)) rates.moved_bytes = 1e11;
  return {[rates, shape](const PlanesPlan& plan, const PlanesCounts& counts) {
            const double side = plan.tile, partly = counts.partial + counts.corners;
            const DevicePlanesWork work =
                device_planes_work(plan, std::max(0.0, counts.whole - partly / 2), counts.tiles);
            const double pixels = partly * side * (side + shape.columns + shape.rows) / 2;
            return (work.multiply_adds + pixels * multiply_adds_per_wave_pixel(shape)) / rates.multiply_adds +
                   work.moved_bytes / rates.moved_bytes;
          },
          false,
          {2}};
}

// Waves, pixels drawn of them (draw_pixels), and the plan that sums them by tiles.
struct WavesInTiles {
  PreparedWaves waves;
  std::vector<DrawnPixel> drawn;
  TileChoice tiles;

  WavesInTiles(PreparedWaves waves, const SumGoal& goal, const Device* device)
      : waves(waves),
        drawn(draw_pixels(waves)),
        tiles(device ? choose_device_tile(*device, drawn, goal) : choose_tile(waves, drawn, goal)) {}

  PartPlan plan() const { return {.near = waves, .tiles = tiles}; }
};

PartPlan plan_planes(const WavesInTiles& all, const SumGoal& goal, Device* device, double most_seconds) {
  const PreparedWaves waves = all.waves;
  PartPlan plan = all.plan();
  const double nearest = least_depth_for_planes(goal.wavelength, goal.grid.pitch);
  const auto suits = [&](const PreparedWave& wave) { return !wave.astigmatic && wave.depth >= nearest; };
  const auto count = size_t(std::ranges::count_if(waves, suits));
  if (count == 0) return plan;
  if (count == waves.size()) {
    plan.far = waves, plan.near = {};  // tiles sum the corners of boxes
  } else {
    std::array<std::vector<PreparedWave>, 2> split;
    for (const PreparedWave& wave : waves) split[suits(wave) ? 0 : 1].push_back(wave);
    plan.split = std::make_shared<const std::array<std::vector<PreparedWave>, 2>>(std::move(split));
    plan.far = plan.split->front(), plan.near = plan.split->back();
    plan.tiles = WavesInTiles(plan.near, goal, device).tiles;
  }
  const PlanesCost cost =
      device ? planes_cost_on_device(*device, plan.tiles.plan.shape) : planes_cost_on_processor(plan.tiles.plan);
  plan.planes =
      choose_planes(plan.far, count == waves.size() ? all.drawn : draw_pixels(plan.far), cost, goal, most_seconds);
  return plan;
}

std::string name_of(TileProducts products) {
  if (products == TileProducts::single) return "single precision on " + tile_sum_instruction_set();
  return (products == TileProducts::bf16 ? "bf16 on " : "bf16 in two parts on ") + packed_unit_name();
}

/// The plan of the approach whose expected error is below the tolerance, or the most accurate one if none is. `cheapest` is
/// that with less predicted time where the waves are to be summed. A device that was not measured sums by tiles then.
PartPlan make_part_plan(PreparedWaves waves, const SumGoal& goal, const SumWay& way) {
  const WavesInTiles all(waves, goal, way.device());
  if (way.approach == Approach::planes) return plan_planes(all, goal, way.device(), 1e300);
  PartPlan tiles = all.plan();
  if (way.approach == Approach::tiled || (way.device() && !is_measured(device_rates(*way.device())))) return tiles;
  const auto seconds = [&](const PartPlan& plan) {
    return way.device() ? seconds_on_devices(plan, goal.bounds, way) : seconds_on_processor(plan, goal.bounds);
  };
  const double by_tiles = tiles.meets_tolerance() ? seconds(tiles) : 1e300;
  const double to_plan = way.device() ? seconds_to_plan_for_device : seconds_to_plan;
  if (by_tiles < to_plan) return tiles;
  PartPlan planes = plan_planes(all, goal, way.device(), by_tiles - to_plan);
  if (planes.far.empty() || !planes.meets_tolerance()) return tiles;
  return seconds(planes) + to_plan < by_tiles ? planes : tiles;
}

/// Predicted seconds, with all threads, or on all devices of the way; infinite for devices that were not measured.
double seconds_of(const PartPlan& plan, const PixelBox& bounds, const SumWay& way) {
  if (way.device()) return seconds_on_devices(plan, bounds, way);
  return seconds_on_processor(plan, bounds) / thread_count();
}

/// How the plan sums, in words.
std::string describe(const PartPlan& plan, const std::vector<Device*>& devices) {
  std::string where;
  if (!devices.empty())
    where = fmt::format("single precision on {}{}", devices.size() > 1 ? fmt::format("{} × ", devices.size()) : "",
                        devices.front()->info().name);
  const TilePlan& tiles = plan.tiles.plan;
  std::string text;
  if (!plan.far.empty()) {
    const PlanesPlan& p = plan.planes.plan;
    text = fmt::format("tiles of {0}x{0}, {1} slab(s) of {2} nodes, kernel of {3} cells, grids {4:g} times as fine{5}",
                       p.tile, p.slabs, p.nodes, p.width, p.oversampling, p.is_corrected ? ", corrected" : "");
    if (!devices.empty())
      text += fmt::format("; where edges of boxes cut these, tiles of {}x{}; {}", tiles.shape.columns, tiles.shape.rows,
                          where);
  }
  if (!plan.near.empty())
    text +=
        fmt::format("{}tiles of {}x{} in {}", text.empty() ? "" : fmt::format("; {} near waves by ", plan.near.size()),
                    tiles.shape.columns, tiles.shape.rows, devices.empty() ? name_of(tiles.products) : where);
  return text;
}

constexpr double bytes_per_wave = 340;  // prepared, split into far and near, sorted
// Besides, on devices: the waves as all devices get them; for `planes` up to four boxes that append_rest leaves, as they are and
// as devices get them, and packets.
constexpr double bytes_per_wave_on_devices = sizeof(DeviceWave);
constexpr double bytes_of_rest =
    4 * (sizeof(PreparedWave) + sizeof(DeviceWave)) + double(sizeof(PlanePacket)) / packet_waves;

// Far waves by planes in the tiles that they light wholly, and all other light by tiles.
void run_on_devices(const PartPlan& plan, const PixelBox& bounds, const std::vector<Device*>& devices, SummedField& sum,
                    const Observer& observer) {
  const Grid& grid = sum.field.grid;
  const double wavelength = sum.field.wavelength;
  const TileShape shape = plan.tiles.plan.shape;
  const auto by_tiles = [&](PreparedWaves waves, const MoreLight& more) {
    if (sum.there) return sum_tiles_on_device(waves, shape, bounds, *sum.there, observer, more);
    sum_tiles_on_devices(devices, waves, {grid, wavelength}, shape, bounds, sum.field.samples, observer, more);
  };
  if (plan.far.empty()) return by_tiles(plan.near, {});
  const PlanesTables tables(plan.planes.plan, wavelength, grid.pitch);
  const SortedWaves far = sort_waves(plan.far, tables.plan, wavelength, grid.pitch);
  std::vector<PreparedWave> in_tiles(plan.near.begin(), plan.near.end());
  append_rest(far.waves, {grid, bounds, tables.plan.tile, tables.tangent}, in_tiles);
  const PacketedWaves packeted(far, tables, grid, bounds);
  const auto make = [&](Device& device) {
    const auto planes = std::make_shared<DevicePlanes>(device, packeted, tables);
    return LightOnDevice{[=](const auto&... band) { planes->add(band...); }, planes->least_memory()};
  };
  by_tiles(in_tiles, {make, tables.plan.tile});
}

void clear_pixels(const PixelBox& bounds, Array2D<std::complex<float>>& samples) {
  parallel_for(bounds.y0, bounds.y1, [&](int64_t j) {
    std::fill_n(samples.row(int(j)) + bounds.x0, bounds.x1 - bounds.x0, std::complex<float>());
  });
}

// Computes the pixels of `bounds`, which are dark, or on devices have any value.
void run_plan(const PartPlan& plan, const PixelBox& bounds, const std::vector<Device*>& devices, SummedField& sum,
              const Observer& observer) {
  if (!devices.empty()) return run_on_devices(plan, bounds, devices, sum, observer);
  Field& field = sum.field;
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
    sum_tiles(plan.near, {field.grid, field.wavelength}, plan.tiles.plan, bounds, field.samples,
              part_of(observer, parts - 1, parts));
}

// Energy of the field in the bounds over the sum of its waves' energies there.
double coherence_of(const SummedField& sum, const PixelBox& bounds, double energy_of_waves) {
  if (!(energy_of_waves > 0)) return 1;
  if (sum.there) return energy(*sum.there, bounds) / energy_of_waves;
  std::vector<double> of_rows(size_t(bounds.y1 - bounds.y0));  // added in order: the same on any number of threads
  parallel_for(bounds.y0, bounds.y1, [&](int64_t j) {
    double& energy = of_rows[size_t(j - bounds.y0)];
    const std::complex<float>* const u = sum.field.samples.row(int(j));
    for (int i = bounds.x0; i < bounds.x1; ++i) energy += std::norm(std::complex<double>(u[i]));
  });
  return std::accumulate(of_rows.begin(), of_rows.end(), 0.0) / energy_of_waves;
}

// A dark field where it is to be summed. It stays on a device if that has as much memory again for the sum.
SummedField dark_field(const Grid& grid, double wavelength, const SumWay& way) {
  const double bytes = double(grid.pixels()) * sizeof(std::complex<float>);
  Device* const device = way.stays ? way.device() : nullptr;
  SummedField sum;
  if (!device || 2 * bytes > device->memory_left() || bytes > device->free_memory()) {
    sum.field.samples = Array2D<std::complex<float>>::unset(grid.ny, grid.nx);
    clear_pixels({0, grid.nx, 0, grid.ny}, sum.field.samples);
    sum.field.grid = grid;
    sum.field.wavelength = wavelength;
    return sum;
  }
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

PartSum sum_part(PreparedWaves waves, SumGoal goal, const SumWay& way, bool is_whole, SummedField& field,
                 const Observer& observer) {
  const PixelBox& bounds = goal.bounds;
  // If the waves cancel, the second round knows their coherence; a field that nearly vanishes may need a third round.
  PartSum part;
  for (int round = 0; round < 3; ++round) {
    const PartPlan plan = make_part_plan(waves, goal, way);
    part = {false, 1.25 * plan.error(), plan.far.empty() ? "tiled" : "planes", describe(plan, way.devices),
            part.predicted_seconds};
    if (!plan.meets_tolerance()) return part;
    part.predicted_seconds += seconds_of(plan, bounds, way);
    if (round > 0 && !way.device()) clear_pixels(bounds, field.field.samples);
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

Field sum_tiled(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer) {
  return sum_within(sources, grid, tolerance, Approach::tiled, observer).field;
}

Field sum_planes(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer) {
  return sum_within(sources, grid, tolerance, Approach::planes, observer).field;
}

}  // namespace holotrace
