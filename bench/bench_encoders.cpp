// Iterations of the encoders on a full-HD panel, and one propagation of its size for comparison:
//   build/release/bench/holotrace_bench --benchmark_filter='iteration|one_propagation'

#include "holotrace/estimate/picture_quality.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/wave/propagate/propagate.h"
#include "jobs.h"

namespace holotrace {
namespace {

constexpr int iterations = 10;

// Ten iterations, divided by ten. The time includes the work around them (transfer functions, the quality of the
// levels).
void iteration(benchmark::State& state, Encoding method) {
  const Slm slm{.name = "ideal", .grid = timed_full_hd};
  EncodeParams params{.method = method, .target_distances = {0.2_m}, .target_columns = 1600, .target_rows = 880};
  params.iterations = iterations;
  const std::vector<TargetPlane> targets = targets_of_picture(natural_picture(1600, 880), slm.grid, 520_nm, params);
  const Field start = field_of_target(targets.front(), slm, params);
  for (auto _ : state) benchmark::DoNotOptimize(encode_targets(targets, start, slm, params));
  state.counters["iterations/s"] = benchmark::Counter(iterations, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(iteration, gerchberg_saxton, Encoding::gerchberg_saxton)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(iteration, sgd, Encoding::sgd)->Unit(benchmark::kMillisecond)->UseRealTime();

void one_propagation(benchmark::State& state) {
  const Field field = timed_field(timed_full_hd);
  const auto propagator = make_propagator<float>(field.grid, field.wavelength, 0.2_m);
  for (auto _ : state) benchmark::DoNotOptimize(propagate(field, propagator));
}
BENCHMARK(one_propagation)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace holotrace
