// Benchmarks of propagation, encoding and the virtual SLM by themselves.

#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/io/scene/slm_file.h"
#include "holotrace/io/user_cache.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/shared/cost_model.h"
#include "jobs.h"

namespace holotrace {
namespace {

template <class Real>
void propagation(benchmark::State& state) {
  const auto field = convert<Real>(timed_field(panel_of(state.range(0))));
  const auto propagator = make_propagator<Real>(field.grid, 532_nm, 0.3_m);
  const double ceiling = measure_fft_in_cache();
  for (auto _ : state) benchmark::DoNotOptimize(propagate(field, propagator));
  count(state, "operations", 2 * fft_operations(double(propagator.padded_nx) * propagator.padded_ny), ceiling);
}
BENCHMARK(propagation<float>)->ArgName("panel")->DenseRange(0, 1)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(propagation<double>)->ArgName("panel")->DenseRange(0, 1)->Unit(benchmark::kMillisecond)->UseRealTime();

// The verb with its transfer function, as bench/python_figures.py calls it from Python.
void propagation_verb(benchmark::State& state) {
  const auto field = timed_field(slm_preset("pluto").grid);
  for (auto _ : state) benchmark::DoNotOptimize(propagate(field, 0.3_m));
}
BENCHMARK(propagation_verb)->Unit(benchmark::kMillisecond)->UseRealTime();

void transfer_function(benchmark::State& state) {
  const Grid panel = panel_of(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(make_propagator<float>(panel, 532_nm, 0.3_m));
  count(state, "pixels", double(panel.pixels()));
}
BENCHMARK(transfer_function)->ArgName("panel")->DenseRange(0, 1)->Unit(benchmark::kMillisecond)->UseRealTime();

void encoding(benchmark::State& state) {
  const Slm slm = slm_preset("pluto");
  const Field field = timed_field(slm.grid);
  const double ceiling = measure_memory_bandwidth();
  for (auto _ : state) benchmark::DoNotOptimize(encode(field, slm, {}));
  count(state, "bytes", double(slm.grid.pixels()) * (sizeof(std::complex<float>) + sizeof(uint16_t)), ceiling);
}
BENCHMARK(encoding)->Unit(benchmark::kMillisecond)->UseRealTime();

void showing(benchmark::State& state) {
  const Slm slm = slm_preset("pluto");
  const Hologram hologram = encode(timed_field(slm.grid), slm, {});
  const ShowParams params{.subpixels = int(state.range(0))};
  const double ceiling = measure_fft_in_cache();
  for (auto _ : state) benchmark::DoNotOptimize(show(hologram, slm, params));
  count(state, "operations", fft_operations(double(slm.grid.pixels()) * params.subpixels * params.subpixels), ceiling);
}
BENCHMARK(showing)->ArgName("subpixels")->Arg(1)->Arg(3)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace holotrace
