// The steps of holotrace bench that sum waves: exact, tiled on each instruction set, planes, auto.

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench.h"
#include "holotrace/base/instruction_set.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/estimate/multiply_add_peak.h"
#include "holotrace/wave/sample_error.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/sum_tiled.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {
namespace {

using namespace literals;

const Grid full_hd{1920, 1080, 8_um}, ultra_hd{3840, 2160, 3.74_um};

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

Sources make_sources(const WaveJob& job) {
  Sources sources;
  sources.wavelength = 532_nm;
  CounterRandom random(1, 0, 0);
  for (int j = 0; j < job.waves; ++j)
    sources.waves.push_back(
        {{(random.uniform() - 0.5) * job.panel.width(), (random.uniform() - 0.5) * job.panel.height(),
          -job.nearest - (job.farthest - job.nearest) * random.uniform()},
         1,
         float(2 * pi * random.uniform())});
  return sources;
}

// As many pixels as the exact sum does in about a second.
int compared_pixels(const WaveJob& job) { return std::clamp(int(3e7 / job.waves), 100, 2000); }

// A sum of complex products takes four real ones for each wave and pixel: the most that a tile by tile sum by the
// schoolbook could reach.
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
  const Sources sources = make_sources(job);
  const double amount = double(waves_pixels(sources, job.panel));
  Field field;
  Facts facts;
  const Timing timing = time_work(
      options, [&] { field = sum(sources, keep_facts(facts)); }, amount, tile_ceiling);
  const std::string name = fmt::format("{}, {:g}", job.name(), tolerance);
  BenchRow row =
      make_row(stage, name, timing, amount, "waves·pixels", "multiply-adds " + sum_tiled_instruction_set() + " / 4");
  row.error = sampled_error(field, sources, compared_pixels(job));
  row.facts = facts;
  return row;
}

BenchRow bench_exact(const BenchOptions& options, const WaveJob& job) {
  const Sources sources = make_sources(job);
  const double amount = double(waves_pixels(sources, job.panel));
  const Timing timing = time_work(
      options, [&] { sum_exact(sources, job.panel); }, amount);
  return make_row("exact", job.name(), timing, amount, "waves·pixels");
}

BenchStep tiled_step(const BenchOptions& options, const std::string& instruction_set, const WaveJob& job,
                     double tolerance) {
  return {"tiled " + instruction_set, [=] {
            const OnInstructionSet alone(instruction_set);
            return bench_sum(options, "tiled " + instruction_set, job, tolerance,
                             [&](const Sources& sources, const Observer& observer) {
                               return sum_tiled(sources, job.panel, tolerance, observer);
                             });
          }};
}

// Seconds for a wave and pixel by a method, the least of all jobs so far: whether a larger job takes too long is then
// known before it runs.
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
  steps.push_back({"exact", [=] { return bench_exact(options, narrow(full_hd, 16)); }});
  if (!options.is_quick) steps.push_back({"exact", [=] { return bench_exact(options, narrow(ultra_hd, 4)); }});
  return steps;
}

std::vector<BenchStep> tiled_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  const int many = options.is_quick ? 1000 : 10000;
  for (const std::string& name : instruction_sets())
    steps.push_back(tiled_step(options, name, narrow(full_hd, many), 1e-3));
  if (options.is_quick) return steps;
  const std::string best = instruction_sets().front();
  for (const WaveJob& job : {narrow(full_hd, 1000), narrow(full_hd, 100000), wide(full_hd, 10000),
                             narrow(ultra_hd, 1000), narrow(ultra_hd, 10000), wide(ultra_hd, 10000)})
    steps.push_back(tiled_step(options, best, job, 1e-3));
  for (const double tolerance : {1e-2, 1e-4})
    steps.push_back(tiled_step(options, best, narrow(full_hd, 1000), tolerance));
  return steps;
}

std::vector<BenchStep> planes_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  const auto known = std::make_shared<double>(0);
  const auto add = [&](const WaveJob& job, double tolerance) {
    steps.push_back(method_step(options, "planes", SynthesisMethod::planes, job, tolerance, known));
  };
  if (options.is_quick) {
    add(narrow(full_hd, 10000), 1e-3);
    return steps;
  }
  for (const double tolerance : {1e-3, 3e-3})
    for (const int waves : {100000, 500000}) add(narrow(full_hd, waves), tolerance);
  add(wide(full_hd, 100000), 1e-3);
  add(narrow(ultra_hd, 100000), 3e-3);
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
  for (const Grid& panel : options.is_quick ? std::vector{full_hd} : std::vector{full_hd, ultra_hd})
    for (const int waves : counts) {
      add(narrow(panel, waves), 1e-3);
      add(wide(panel, waves), 1e-3);
      if (waves >= 100000) add(narrow(panel, waves), 3e-3);
    }
  return steps;
}

}  // namespace holotrace
