// Summation of waves by itself, for profiling and for comparing two builds:
//   build/release/bench/holotrace_bench --benchmark_filter=tiled --benchmark_repetitions=5

#include "holotrace/base/machine.h"
#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/synthesize.h"
#include "jobs.h"

namespace holotrace {
namespace {

void count_waves_pixels(benchmark::State& state, const Sources& sources, const Grid& panel, double ceiling) {
  count(state, "waves_pixels", double(waves_pixels(sources, panel)), ceiling);
}

void exact(benchmark::State& state) {
  const Grid panel = panel_of(state.range(0));
  const Sources sources = waves_of(panel, state.range(1), 0);
  for (auto _ : state) benchmark::DoNotOptimize(sum_exact(sources, panel));
  count_waves_pixels(state, sources, panel, 0);
}
BENCHMARK(exact)
    ->ArgNames({"panel", "waves"})
    ->Args({0, 16})
    ->Args({1, 4})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void tiled_on(benchmark::State& state, const std::string& instruction_set) {
  const OnInstructionSet alone(instruction_set);
  const double ceiling = measure_multiply_add_peak() / 4;  // four multiply-adds for each wave and pixel
  const Grid panel = panel_of(state.range(0));
  const Sources sources = waves_of(panel, state.range(1), state.range(2));
  for (auto _ : state) benchmark::DoNotOptimize(sum_tiled(sources, panel, 1.0 / double(state.range(3))));
  count_waves_pixels(state, sources, panel, ceiling);
}

void by_method(benchmark::State& state, SynthesisMethod method) {
  const double ceiling = measure_multiply_add_peak() / 4;
  const Grid panel = panel_of(state.range(0));
  const Sources sources = waves_of(panel, state.range(1), state.range(2));
  const SynthesizeParams params{.method = method, .tolerance = 1.0 / double(state.range(3))};
  for (auto _ : state) benchmark::DoNotOptimize(synthesize(sources, panel, params));
  count_waves_pixels(state, sources, panel, ceiling);
}

// The kernels for the available instruction sets are known only at run time.
const bool is_registered = [] {
  for (const std::string& name : instruction_sets())
    benchmark::RegisterBenchmark(("tiled_" + name).c_str(), tiled_on, name)
        ->ArgNames({"panel", "waves", "depths", "1/tolerance"})
        ->ArgsProduct({{0}, {1000, 10000}, {0, 1}, {1000}})
        ->Args({0, 1000, 0, 100})
        ->Args({0, 1000, 0, 10000})
        ->Args({1, 1000, 0, 1000})
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  for (const auto& [name, method] :
       {std::pair{"planes", SynthesisMethod::planes}, {"auto", SynthesisMethod::automatic}})
    benchmark::RegisterBenchmark(name, by_method, method)
        ->ArgNames({"panel", "waves", "depths", "1/tolerance"})
        ->ArgsProduct({{0, 1}, {1000, 10000, 100000, 500000}, {0, 1}, {1000}})
        ->ArgsProduct({{0, 1}, {100000, 500000}, {0}, {333}})
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  return true;
}();

}  // namespace
}  // namespace holotrace
