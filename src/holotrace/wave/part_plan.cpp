#include "holotrace/wave/part_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "holotrace/base/thread_count.h"
#include "holotrace/wave/planes/device_planes.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/tiles/device_tiles.h"
#include "holotrace/wave/tiles/packed_product.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {
namespace {

constexpr double unmeasured = std::numeric_limits<double>::infinity();  // seconds on a device that was not measured

constexpr double from_memory = 1.6;      // the rates hold for a tile in the caches; `planes` reads all waves per tile
constexpr double seconds_to_plan = 0.2;  // for `planes`; it pays for many waves only
// For `planes` on a device: fewer kinds of plans are compared; and a thread of the processor sorts a wave, and cuts its box.
constexpr double seconds_to_plan_for_device = 0.05, seconds_to_sort = 6e-7;

SummationWork work_of_tiles(const std::vector<PreparedWave>& waves, const TilePlan& plan) {
  double pixels = 0;
  for (const PreparedWave& wave : waves) pixels += double(wave.box.pixels());
  return pixels * tile_work(plan);
}

// Seconds of one thread of the processor.
double seconds_on_processor(const PartPlan& plan) {
  const double by_planes = plan.far.empty() ? 0 : plan.planes.seconds;
  return by_planes + predict_seconds(work_of_tiles(plan.near, plan.tiles.plan), summation_rates(), 1);
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
  // On all cores, whatever --threads says: the choice must not depend on it.
  const double sorting = seconds_to_sort * double(plan.far.size()) / std::max(1U, std::thread::hardware_concurrency());
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
          false};
}

TileChoice choose_tile_for(const std::vector<PreparedWave>& waves, const SumGoal& goal, const Device* device) {
  const std::vector<DrawnPixel> pixels = draw_pixels(waves);
  return device ? choose_device_tile(*device, pixels, goal) : choose_tile(pixels, goal);
}

PartPlan plan_tiles(std::vector<PreparedWave> waves, const SumGoal& goal, const Device* device) {
  PartPlan plan;
  plan.tiles = choose_tile_for(waves, goal, device);
  plan.near = std::move(waves);
  return plan;
}

PartPlan plan_planes(const std::vector<PreparedWave>& waves, const SumGoal& goal, Device* device, double most_seconds) {
  PartPlan plan;
  for (const PreparedWave& wave : waves)
    (suits_planes(wave, goal.wavelength, goal.grid.pitch) ? plan.far : plan.near).push_back(wave);
  const std::vector<PreparedWave>& in_tiles = plan.near.empty() ? waves : plan.near;  // or the corners of boxes
  plan.tiles = choose_tile_for(in_tiles, goal, device);
  if (plan.far.empty()) return plan;
  const PlanesCost cost =
      device ? planes_cost_on_device(*device, plan.tiles.plan.shape) : planes_cost_on_processor(plan.tiles.plan);
  plan.planes = choose_planes(plan.far, cost, goal, most_seconds);
  return plan;
}

std::string name_of(TileProducts products) {
  if (products == TileProducts::single) return "single precision on " + tile_sum_instruction_set();
  return (products == TileProducts::bf16 ? "bf16 on " : "bf16 in two parts on ") + packed_unit_name();
}

}  // namespace

PartPlan make_part_plan(const std::vector<PreparedWave>& waves, const SumGoal& goal, const SumWay& way) {
  if (way.approach == Approach::planes) return plan_planes(waves, goal, way.device(), 1e300);
  PartPlan tiles = plan_tiles(waves, goal, way.device());
  if (way.approach == Approach::tiled || (way.device() && !is_measured(device_rates(*way.device())))) return tiles;
  const auto seconds = [&](const PartPlan& plan) {
    return way.device() ? seconds_on_devices(plan, goal.bounds, way) : seconds_on_processor(plan);
  };
  const double by_tiles = tiles.meets_tolerance() ? seconds(tiles) : 1e300;
  const double to_plan = way.device() ? seconds_to_plan_for_device : seconds_to_plan;
  if (by_tiles < to_plan) return tiles;
  PartPlan planes = plan_planes(waves, goal, way.device(), by_tiles);
  if (planes.far.empty() || !planes.meets_tolerance()) return tiles;
  return (way.device() ? 1 : from_memory) * seconds(planes) + to_plan < by_tiles ? planes : tiles;
}

double seconds_of(const PartPlan& plan, const PixelBox& bounds, const SumWay& way) {
  if (way.device()) return seconds_on_devices(plan, bounds, way);
  return (plan.far.empty() ? 1 : from_memory) * seconds_on_processor(plan) / thread_count();
}

std::string describe(const PartPlan& plan, const std::vector<Device*>& devices) {
  std::string where;
  if (!devices.empty())
    where = fmt::format("single precision on {}{}", devices.size() > 1 ? fmt::format("{} × ", devices.size()) : "",
                        devices.front()->info().name);
  const TilePlan& tiles = plan.tiles.plan;
  std::string text;
  if (!plan.far.empty()) {
    const PlanesPlan& p = plan.planes.plan;
    text = fmt::format("tiles of {0}x{0}, {1} slab(s) of {2} nodes, kernel of {3} cells{4}", p.tile, p.slabs, p.nodes,
                       p.width, p.is_corrected ? ", corrected" : "");
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

}  // namespace holotrace
