// Synthesis and propagation on their own, for profiling and for comparing two builds:
//   build/release/bench/holotrace_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only

#include <benchmark/benchmark.h>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/sum_tiled.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {
namespace {

using namespace literals;

const Grid full_hd{1920, 1080, 8_um};

Sources random_sources(int64_t count) {
  Sources sources;
  sources.wavelength = 532_nm;
  CounterRandom random(1, 0, 0);
  for (int64_t j = 0; j < count; ++j)
    sources.waves.push_back({{(random.uniform() - 0.5) * full_hd.width(), (random.uniform() - 0.5) * full_hd.height(),
                              -0.19_m - 0.02_m * random.uniform()},
                             1,
                             float(2 * pi * random.uniform())});
  return sources;
}

void count_waves_pixels(benchmark::State& state, const Sources& sources) {
  state.counters["waves_pixels/s"] =
      benchmark::Counter(double(waves_pixels(sources, full_hd)), benchmark::Counter::kIsIterationInvariantRate);
}

void exact(benchmark::State& state) {
  const Sources sources = random_sources(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(sum_exact(sources, full_hd));
  count_waves_pixels(state, sources);
}
BENCHMARK(exact)->Arg(16)->Unit(benchmark::kMillisecond)->UseRealTime();

void tiled(benchmark::State& state) {
  const Sources sources = random_sources(state.range(0));
  const double tolerance = 1.0 / double(state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(sum_tiled(sources, full_hd, tolerance));
  count_waves_pixels(state, sources);
}
BENCHMARK(tiled)
    ->ArgNames({"waves", "1/tolerance"})
    ->Args({1000, 1000})
    ->Args({4096, 1000})
    ->Args({10000, 1000})
    ->Args({4096, 10000})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void propagation(benchmark::State& state) {
  Field field(full_hd, 532_nm);
  for (auto& u : field.samples.values) u = 1;
  const auto propagator = make_propagator<float>(full_hd, 532_nm, 0.3_m);
  for (auto _ : state) benchmark::DoNotOptimize(propagate(field, propagator));
}
BENCHMARK(propagation)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace holotrace
