// Triangles on a full-HD panel, beside a tiled sum of waves in the same run:
//   build/release/bench/holotrace_bench --benchmark_filter='triangles|reference'

#include <benchmark/benchmark.h>

#include <cmath>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/wave/sum_tiled.h"
#include "holotrace/wave/sum_triangles.h"

namespace holotrace {
namespace {

using namespace literals;

const Grid full_hd{1920, 1080, 8_um};

// The half of a sphere of 8 mm that faces the panel, 0.2 m behind it, as about that many triangles, random phases.
Triangles half_sphere(int64_t count) {
  // A sphere of s segments has about s² triangles, half of them in front.
  Mesh sphere = make_sphere(8_mm, int(std::lround(std::sqrt(2.0 * double(count)))));
  transform_mesh({.origin = {0, 0, -0.2_m}}, sphere);
  Triangles triangles{532_nm, {}};
  CounterRandom random(1, 0, 0);
  for (const auto& [i, j, k] : sphere.triangles) {
    Triangle t;
    t.corners = {sphere.positions[i], sphere.positions[j], sphere.positions[k]};
    const Vec3 normal = cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
    if (!(normal.z > 0)) continue;
    for (float& a : t.amplitudes) a = float(normal.z / length(normal));
    t.phase = float(2 * pi * random.uniform());
    triangles.triangles.push_back(t);
  }
  return triangles;
}

void triangles(benchmark::State& state) {
  const Triangles set = half_sphere(state.range(0));
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

// Waves at the same depth: what the machine has left for this run.
void reference_for_triangles(benchmark::State& state) {
  Sources sources{532_nm, {}};
  CounterRandom random(1, 0, 0);
  for (int j = 0; j < 10000; ++j)
    sources.waves.push_back({{(random.uniform() - 0.5) * 8_mm, (random.uniform() - 0.5) * 8_mm, -0.2_m}, 1, 0});
  for (auto _ : state) benchmark::DoNotOptimize(sum_tiled(sources, full_hd, 1e-3));
}
BENCHMARK(reference_for_triangles)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace holotrace
