// The steps of holotrace bench that sum waves (exact, each kernel of tiled, planes, auto), slices and triangles.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/bench.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/wave/layers/sum_layers.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/tiles/packed_product.h"
#include "holotrace/wave/tiles/tile_error.h"
#include "holotrace/wave/tiles/tile_sum.h"
#include "holotrace/wave/triangles/sum_triangles.h"

namespace holotrace {
namespace {

using namespace literals;

/// Waves of random phase, spread over the panel and over a range of depths.
struct WaveJob {
  Grid panel;
  int waves;
  double nearest, farthest;  // depths [m]

  std::string name() const {
    return fmt::format("{}x{}, {} waves, {:g}-{:g} m", panel.nx, panel.ny, short_count(waves), nearest, farthest);
  }
};

WaveJob narrow(const Grid& panel, int waves) { return {panel, waves, 0.19_m, 0.21_m}; }
WaveJob wide(const Grid& panel, int waves) { return {panel, waves, 0.15_m, 0.25_m}; }

// Number of pixels that the exact sum computes in about a second.
int compared_pixels(const WaveJob& job) { return std::clamp(int(3e7 / job.waves), 100, 2000); }

// A sum of complex products takes four real multiply-adds for each wave and pixel: the highest rate of a direct
// (schoolbook) sum by tiles.
double tile_ceiling() { return measure_multiply_add_peak() / 4; }

using Facts = nlohmann::ordered_json;

Observer keep_facts(Facts& facts) {
  Observer observer;
  observer.on_fact = [&facts](const std::string& name, const Fact& value) {
    std::visit([&](const auto& v) { facts[name] = v; }, value);
  };
  return observer;
}

BenchRow bench_sum(const BenchOptions& options, const std::string& stage, const WaveJob& job, double tolerance,
                   const std::function<Field(const Sources&, const Observer&)>& sum) {
  const Sources sources = timed_waves(job.panel, job.waves, job.nearest, job.farthest);
  const double amount = double(waves_pixels(sources, job.panel));
  Field field;
  Facts facts;
  const Timing timing = time_work(
      options, [&] { field = sum(sources, keep_facts(facts)); }, amount, tile_ceiling);
  const std::string name = fmt::format("{}, {:g}", job.name(), tolerance);
  BenchRow row =
      make_row(stage, name, timing, amount, "waves·pixels", "multiply-adds " + tile_sum_instruction_set() + " / 4");
  row.error = sampled_error(field, sources, compared_pixels(job));
  row.facts = facts;
  return row;
}

BenchRow bench_exact(const BenchOptions& options, const WaveJob& job) {
  const Sources sources = timed_waves(job.panel, job.waves, job.nearest, job.farthest);
  const double amount = double(waves_pixels(sources, job.panel));
  const Timing timing = time_work(
      options, [&] { sum_exact(sources, job.panel); }, amount);
  return make_row("exact", job.name(), timing, amount, "waves·pixels");
}

// A kernel of the tiled sum: an instruction set and a precision of its products.
struct TiledKernel {
  std::string instruction_set;
  TileProducts products;

  std::string name() const {
    if (products == TileProducts::single) return "tiled " + instruction_set;
    return (products == TileProducts::bf16 ? "tiled bf16 " : "tiled 2 bf16 ") + packed_unit_name();
  }
  std::string ceiling_name() const {
    return products == TileProducts::single ? "multiply-adds " + instruction_set + " / 4"
                                            : "multiply-adds " + packed_unit_name() + " / 4";
  }
  double ceiling() const {
    if (products == TileProducts::single) return tile_ceiling();
    return (packed_unit() == PackedUnit::amx ? measure_bf16_tile_peak() : measure_bf16_vector_peak()) / 4;
  }
};

// The largest tile shape that keeps the tolerance with these products.
TilePlan plan_for(const TiledKernel& kernel, const std::vector<PreparedWave>& waves, const Grid& panel,
                  double wavelength, double tolerance) {
  const std::vector<DrawnPixel> pixels = draw_pixels(waves);
  for (const TileShape& shape : tile_shapes) {
    const SplitEnergies split = measure_split(pixels, panel, {0, panel.nx, 0, panel.ny}, wavelength, shape);
    const double error = std::hypot(std::sqrt(split.error / split.waves), rounding_error(kernel.products));
    if (1.25 * error <= tolerance) return {shape, kernel.products};
  }
  fail("expected a tolerance that {} meets, got {:g}", kernel.name(), tolerance);
}

Field sum_by(const TilePlan& plan, PreparedWaves waves, const Grid& panel, double wavelength) {
  Field field(panel, wavelength);
  sum_tiles(waves, {panel, wavelength}, plan, {0, panel.nx, 0, panel.ny}, field.samples);
  return field;
}

BenchRow bench_kernel(const BenchOptions& options, const TiledKernel& kernel, const WaveJob& job, double tolerance) {
  const OnInstructionSet alone(kernel.instruction_set);
  const Sources sources = timed_waves(job.panel, job.waves, job.nearest, job.farthest);
  const std::vector<PreparedWave> waves = prepare_waves(sources, job.panel);
  const TilePlan plan = plan_for(kernel, waves, job.panel, sources.wavelength, tolerance);
  const double amount = double(waves_pixels(sources, job.panel));
  Field field;
  const Timing timing = time_work(
      options, [&] { field = sum_by(plan, waves, job.panel, sources.wavelength); }, amount,
      [&] { return kernel.ceiling(); });
  BenchRow row = make_row(kernel.name(), fmt::format("{}, {:g}", job.name(), tolerance), timing, amount, "waves·pixels",
                          kernel.ceiling_name());
  row.error = sampled_error(field, sources, compared_pixels(job));
  row.facts["tile"] = fmt::format("{}x{}", plan.shape.columns, plan.shape.rows);
  return row;
}

BenchStep tiled_step(const BenchOptions& options, const TiledKernel& kernel, const WaveJob& job, double tolerance) {
  return {kernel.name(), [=] { return bench_kernel(options, kernel, job, tolerance); }};
}

// Least time per wave and pixel of a method in all jobs so far [s]: it tells before a larger job runs whether it would
// take too long.
using Expectation = std::shared_ptr<double>;

BenchStep method_step(const BenchOptions& options, const std::string& stage, SynthesisMethod method, const WaveJob& job,
                      double tolerance, const Expectation& least) {
  return {stage, [=] {
            const double expected = *least * job.waves * double(job.panel.pixels());
            if (expected > options.longest_seconds)
              return BenchRow{.stage = stage,
                              .job = fmt::format("{}, {:g}", job.name(), tolerance),
                              .left_out = fmt::format("about {:.0f} s; see --full", expected)};
            const SynthesizeParams params{.method = method, .tolerance = tolerance};
            BenchRow row =
                bench_sum(options, stage, job, tolerance, [&](const Sources& sources, const Observer& observer) {
                  return synthesize(sources, job.panel, params, observer);
                });
            const double found = row.seconds / job.waves / double(job.panel.pixels());
            *least = *least > 0 ? std::min(*least, found) : found;
            if (method == SynthesisMethod::automatic && row.facts.contains("method"))
              row.stage += " (" + row.facts["method"].get<std::string>() + ")";
            return row;
          }};
}

}  // namespace

std::vector<BenchStep> exact_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  steps.push_back({"exact", [=] { return bench_exact(options, narrow(timed_full_hd, 16)); }});
  if (!options.is_quick) steps.push_back({"exact", [=] { return bench_exact(options, narrow(timed_ultra_hd, 4)); }});
  return steps;
}

std::vector<BenchStep> tiled_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  const std::string best = instruction_sets().front();
  const auto add = [&](const TiledKernel& kernel, const WaveJob& job, double tolerance) {
    steps.push_back(tiled_step(options, kernel, job, tolerance));
  };
  const WaveJob usual = narrow(timed_full_hd, options.is_quick ? 1000 : 10000);
  for (const std::string& name : instruction_sets()) add({name, TileProducts::single}, usual, 1e-3);
  const bool is_packed = packed_unit() != PackedUnit::none;
  if (is_packed) {
    add({best, TileProducts::split_bf16}, usual, 1e-3);
    add({best, TileProducts::bf16}, usual, 5e-3);
  }
  if (options.is_quick) return steps;
  const TiledKernel kernel{best, is_packed ? TileProducts::split_bf16 : TileProducts::single};
  for (const WaveJob& job : {narrow(timed_full_hd, 1000), narrow(timed_full_hd, 100000), wide(timed_full_hd, 10000),
                             narrow(timed_ultra_hd, 1000), narrow(timed_ultra_hd, 10000), wide(timed_ultra_hd, 10000)})
    add(kernel, job, 1e-3);
  add({best, TileProducts::single}, narrow(timed_full_hd, 1000), 1e-4);
  return steps;
}

std::vector<BenchStep> planes_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  const auto known = std::make_shared<double>(0);
  const auto add = [&](const WaveJob& job, double tolerance) {
    steps.push_back(method_step(options, "planes", SynthesisMethod::planes, job, tolerance, known));
  };
  if (options.is_quick) {
    add(narrow(timed_full_hd, 10000), 1e-3);
    return steps;
  }
  for (const double tolerance : {1e-3, 3e-3})
    for (const int waves : {100000, 500000}) add(narrow(timed_full_hd, waves), tolerance);
  add(wide(timed_full_hd, 100000), 1e-3);
  add(narrow(timed_ultra_hd, 100000), 3e-3);
  return steps;
}

std::vector<BenchStep> auto_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  const auto known = std::make_shared<double>(0);
  const std::vector<int> counts =
      options.is_quick ? std::vector{1000, 10000} : std::vector{1000, 10000, 100000, 500000};
  const auto add = [&](const WaveJob& job, double tolerance) {
    steps.push_back(method_step(options, "auto", SynthesisMethod::automatic, job, tolerance, known));
  };
  for (const Grid& panel : options.is_quick ? std::vector{timed_full_hd} : std::vector{timed_full_hd, timed_ultra_hd})
    for (const int waves : counts) {
      add(narrow(panel, waves), 1e-3);
      add(wide(panel, waves), 1e-3);
      if (waves >= 100000) add(narrow(panel, waves), 3e-3);
    }
  return steps;
}

// --- slices and triangles ---

namespace {

// Waves spread over the whole panel, in 20 mm of depth around 0.2 m.
BenchRow bench_layers(const BenchOptions& options, int count, int slices) {
  const Sources sources = timed_waves(timed_full_hd, count, 0.19, 0.21);
  SynthesizeParams params;
  params.slices = slices;
  const Timing timing = time_work(
      options, [&] { sum_layers(sources, timed_full_hd, params); }, slices);
  return make_row("layers", fmt::format("1920x1080, {} waves, 0.19-0.21 m", short_count(count)), timing, slices,
                  "slices");
}

BenchRow bench_triangles(const BenchOptions& options, int count, double tolerance) {
  const Triangles triangles = timed_half_sphere(count);
  const double amount = double(triangles.triangles.size());
  const Timing timing = time_work(
      options, [&] { sum_triangles(triangles, timed_full_hd, tolerance); }, amount);
  return make_row("triangles", fmt::format("1920x1080, {} triangles, {:g}", short_count(count), tolerance), timing,
                  amount, "triangles");
}

}  // namespace

std::vector<BenchStep> layers_steps(const BenchOptions& options) {
  return {
      {"layers", [=] { return bench_layers(options, options.is_quick ? 10000 : 100000, options.is_quick ? 5 : 20); }}};
}

std::vector<BenchStep> triangles_steps(const BenchOptions& options) {
  if (options.is_quick) return {{"triangles", [=] { return bench_triangles(options, 100, 1e-2); }}};
  return {{"triangles", [=] { return bench_triangles(options, 10000, 1e-2); }},
          {"triangles", [=] { return bench_triangles(options, 10000, 1e-3); }}};
}

}  // namespace holotrace
