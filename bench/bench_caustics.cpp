// Caustics of a square lamp behind a glass ball, sampled, against paths that meet the lamp by chance:
//   build/release/bench/holotrace_bench --benchmark_filter=caustics
// `gain` is variance times time of paths alone over that of sampling; the time shown is that of sampling.

#include <benchmark/benchmark.h>

#include <chrono>

#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/trace/paths/path.h"

namespace holotrace {
namespace {

using namespace literals;

struct Cost {
  double seconds = 0, variance = 0, relative_error = 0;  // of one mean of 256 paths
};

Cost cost_of(const Scene& scene, int caustic_rays, int samples) {
  const PathScene path_scene(scene, Lines{}, {}, {.caustic_rays = caustic_rays});
  const Ray ray{{1.5_mm, 0, -0.3001}, {0, 0, 1}};  // to the lower side of the plate
  const PathStart start{path_scene.accelerator.closest_hit(ray).value().point, -ray.direction,
                        path_scene.automaton.start(), 1};
  double sum = 0, squares = 0;
  PathCounts counts;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < samples; ++i) {
    Vec3 mean;
    mean_radiance(path_scene, start, 256, uint64_t(i), {&mean, 1}, counts);
    sum += mean.y;
    squares += mean.y * mean.y;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double mean = sum / samples, variance = squares / samples - mean * mean;
  return {seconds / samples, variance, std::sqrt(variance) / mean};
}

// The plate lies at −0.3 m, the middle of the ball 15 mm below it, and the lamp 30 mm below that.
void caustics_of_rectangle(benchmark::State& state) {
  const double side = double(state.range(0)) * 1e-6;
  Scene scene;
  scene.materials = {Material{DiffuseMaterial{.reflectance = {0.6, 0.6, 0.6}}},
                     Material{DielectricMaterial{.index = constant_index(1.5)}}};
  Mesh plate = make_quad(40_mm, 40_mm), ball = make_sphere(10_mm, 60);
  for (Vec3& p : plate.positions) p.z -= 0.3;
  for (Vec3& p : ball.positions) p.z -= 0.315;
  ball.material = 1;
  scene.meshes = {plate, ball};
  scene.lights = {
      RectangleLight{{-side / 2, -side / 2, -0.345}, {side, 0, 0}, {0, side, 0}, Vec3{1, 1, 1} / (side * side), false}};
  const Cost by_chance = cost_of(scene, 0, 40000);
  Cost sampled;
  for (auto _ : state) sampled = cost_of(scene, PathParams{}.caustic_rays, 400);
  state.counters["gain"] = by_chance.variance * by_chance.seconds / (sampled.variance * sampled.seconds);
  state.counters["variance_ratio"] = by_chance.variance / sampled.variance;
  state.counters["time_ratio"] = sampled.seconds / by_chance.seconds;
  state.counters["error_by_chance"] = by_chance.relative_error;
  state.counters["error_sampled"] = sampled.relative_error;
}
BENCHMARK(caustics_of_rectangle)
    ->ArgName("side_um")
    ->Arg(1000)
    ->Arg(3000)
    ->Arg(6000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace holotrace
