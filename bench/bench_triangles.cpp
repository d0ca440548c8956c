// Triangles on a full-HD panel, and a tiled sum of waves for comparison:
//   build/release/bench/holotrace_bench --benchmark_filter='triangles|reference'

#include <benchmark/benchmark.h>

#include "holotrace/estimate/machine/timing.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/triangles/sum_triangles.h"

namespace holotrace {
namespace {

const Grid full_hd = timed_full_hd;

void triangles(benchmark::State& state) {
  const Triangles set = timed_half_sphere(state.range(0));
  const double tolerance = 1.0 / double(state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(sum_triangles(set, full_hd, tolerance));
  state.counters["triangles"] = double(set.triangles.size());
}
BENCHMARK(triangles)
    ->ArgNames({"triangles", "1/tolerance"})
    ->Args({10000, 100})
    ->Args({10000, 1000})
    ->Args({100000, 100})
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

// Waves at the same depth: they show the speed of the machine during this run.
void reference_for_triangles(benchmark::State& state) {
  const Sources sources = timed_waves(full_hd, 10000, 0.19, 0.21);
  for (auto _ : state) benchmark::DoNotOptimize(sum_tiled(sources, full_hd, 1e-3));
}
BENCHMARK(reference_for_triangles)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace holotrace
