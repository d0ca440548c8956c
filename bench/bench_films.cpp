// Films of points: every picture has its own waves, which become the levels of a kinoform on a full-HD panel.
//   build/release/bench/holotrace_bench --benchmark_filter=film_of_points
// Its arguments are the number of points and the tolerance in units of 1e-4. "CPU" is the time of all threads for one picture. Where
// other programs use the processor, pictures per second fall, and this nearly stays.

#include <algorithm>
#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/wave/synthesize.h"
#include "jobs.h"

namespace holotrace {
namespace {

// The points turn by 0.4 degrees about an axis that is parallel to y and through their middle.
void turn(Sources& points) {
  constexpr double angle = 0.4 * pi / 180, middle = -0.2;
  for (Source& point : points.waves) {
    const double x = point.origin.x, z = point.origin.z - middle;
    point.origin.x = x * std::cos(angle) + z * std::sin(angle);
    point.origin.z = middle + std::clamp(z * std::cos(angle) - x * std::sin(angle), -0.01, 0.01);
  }
}

void film_of_points(benchmark::State& state) {
  const Slm slm{.name = "ideal", .grid = timed_full_hd};
  Sources points = timed_waves(timed_full_hd, state.range(0), 0.19_m, 0.21_m);
  const SynthesizeParams sum{.tolerance = double(state.range(1)) * 1e-4};
  for (auto _ : state) {
    turn(points);
    const Field field = synthesize(points, slm.grid, sum);
    benchmark::DoNotOptimize(encode(field, slm, {.method = Encoding::phase}));
  }
  state.counters["pictures/s"] = benchmark::Counter(1, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["waves·pixels/s"] = benchmark::Counter(double(state.range(0)) * double(slm.grid.pixels()),
                                                        benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(film_of_points)
    ->ArgsProduct({{1000, 16000, 100000}, {10, 100}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace holotrace
