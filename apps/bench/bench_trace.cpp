// The step of holotrace bench that traces paths, compared with the same rays followed by Embree alone.

#include <fmt/format.h>

#include <atomic>

#include "bench/bench.h"
#include "bench/bench_scenes.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/estimate/machine/median_seconds.h"
#include "holotrace/io/scene/slm_file.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/trace.h"

namespace holotrace {
namespace {

using namespace literals;

/// The rays of `trace`; each of its first hits is followed again.
std::vector<LoggedRay> log_rays(const Scene& scene, const Grid& panel, double wavelength, const TraceParams& params) {
  PathScene path_scene(
      scene, make_lines(wavelength, wavelength, wavelength), params.path_expressions,
      {.max_depth = params.max_depth, .roulette_depth = params.roulette_depth, .seed = uint64_t(params.seed)});
  std::vector<LoggedRay> log;
  path_scene.accelerator.log_rays(&log);
  const FirstHits pattern(params, panel, wavelength);
  PathCounts counts;
  for (int64_t i = 0; i < pattern.count(); ++i) {
    CounterRandom random(uint64_t(params.seed), 0, uint64_t(i));
    const auto ray = pattern.ray(i, random);
    const auto hit = path_scene.accelerator.closest_hit(*ray);
    Vec3 sum;
    if (hit)
      mean_radiance(path_scene, {hit->point, -ray->direction, path_scene.automaton.start(), 1}, params.paths,
                    uint64_t(i), {&sum, 1}, counts);
  }
  return log;
}

BenchRow bench_trace() {
  const Grid panel = slm_preset("pluto").grid;
  const double wavelength = 532_nm;
  const Scene scene = make_board_scene();
  TraceParams params;
  params.columns = params.rows = 128;
  params.field_of_view = 1.1_deg;
  params.paths = 64;  // the default
  int64_t triangles = 0;
  for (const Mesh& mesh : scene.meshes) triangles += int64_t(mesh.triangles.size());

  const std::vector<LoggedRay> rays = log_rays(scene, panel, wavelength, params);
  const Accelerator accelerator(scene);
  const int64_t count = int64_t(rays.size()), block = 4096;
  std::atomic<int64_t> found;
  const double build = median_seconds(3, [&] { Accelerator{scene}; });
  const auto replay = [&] {
    parallel_for(0, (count + block - 1) / block, [&](int64_t i) {
      found += accelerator.replay(&rays[size_t(i * block)], std::min(block, count - i * block));
    });
  };
  // Alternately, so that changes of the machine's speed affect both.
  std::vector<double> traced, bare;
  for (int run = 0; run < 7; ++run) {
    traced.push_back(median_seconds(1, [&] { trace(scene, panel, wavelength, params); }) - build);
    bare.push_back(median_seconds(1, replay));
  }
  std::sort(traced.begin(), traced.end());
  std::sort(bare.begin(), bare.end());
  const double rate = double(count) / traced[3], embree = double(count) / bare[3];
  return {.stage = "trace",
          .job = fmt::format("{} triangles, {} rays", triangles, short_count(count)),
          .seconds = traced[3],
          .runs = int(traced.size()),
          .rate = rate,
          .unit = "rays",
          .ceiling_rate = embree,
          .ceiling = "Embree alone",
          .of_ceiling = rate / embree,
          .facts = {{"triangles", triangles}, {"rays", count}, {"build_seconds", build}}};
}

}  // namespace

std::vector<BenchStep> trace_steps(const BenchOptions&) {
  return {{"trace", [] { return bench_trace(); }}};
}

}  // namespace holotrace
