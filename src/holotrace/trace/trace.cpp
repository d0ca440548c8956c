#include "holotrace/trace/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/first_hits.h"
#include "holotrace/trace/path.h"

namespace holotrace {

namespace {

constexpr int64_t block_size = 64;  // rays that one task follows

void check_params(const TraceParams& params) {
  require(params.paths >= 1, "expected paths of 1 or more per first hit, got {}", params.paths);
  require(params.max_depth >= 1, "expected a max_depth of 1 surface or more, got {}", params.max_depth);
}

/// The first number of a sample's sequence makes its phase, so that phases do not depend on the light.
double draw_phase(SourcePhase phase, CounterRandom& random) {
  const double u = random.uniform();
  return phase == SourcePhase::random ? 2 * pi * u : 0;
}

/// The luminous points that no mesh hides from the panel's centre, as they are.
void append_points(const Accelerator& accelerator, const TraceParams& params, std::vector<Source>& waves) {
  const std::vector<ScenePoint>& points = accelerator.scene().points;
  for (size_t i = 0; i < points.size(); ++i) {
    const ScenePoint& point = points[i];
    if (accelerator.is_occluded({}, point.position)) continue;
    CounterRandom random(uint64_t(params.seed), 0, i);
    waves.push_back({point.position, point.amplitude, float(draw_phase(params.phase, random) + point.phase)});
  }
}

/// What one task finds.
struct Block {
  std::vector<Source> waves;
  PathCounts counts;
  int64_t first_hits = 0;
};

/// Follows ray `index` to its first hit and traces light there.
void trace_sample(const PathScene& scene, const FirstHits& pattern, int64_t index, const TraceParams& params,
                  Block& block) {
  const uint64_t sample = scene.scene.points.size() + uint64_t(index);
  CounterRandom random(uint64_t(params.seed), 0, sample);
  const double phase = draw_phase(params.phase, random);
  const auto ray = pattern.ray(index, random);
  if (!ray) return;
  ++block.counts.rays;
  const auto hit = scene.accelerator.closest_hit(*ray);
  if (!hit) return;
  ++block.first_hits;
  const Vec3 origin = hit->point.position;
  std::vector<Vec3> sums(size_t(scene.sums()));
  mean_radiance(scene, {hit->point, -ray->direction, scene.automaton.start(), 1}, params.paths, sample, sums,
                block.counts);
  double radiance = 0;
  for (const Vec3 sum : sums) radiance += sum.x;
  const double light = params.amplitude == AmplitudeLaw::sqrt ? radiance : radiance * radiance;
  const double amplitude = std::sqrt(light * pattern.squared_amplitude(*ray, origin));
  if (amplitude > 0) block.waves.push_back({origin, float(amplitude), float(phase)});
}

/// Says how far the rays looked, and what would make them meet a mesh.
std::string unseen_sentence(const Grid& panel, double wavelength, const TraceParams& params, int64_t rays) {
  if (params.pattern == Pattern::grid && params.field_of_view > 0)
    return fmt::format(
        "none of {} rays from the panel met a mesh: the raster sees {} to each side of the axis; move the "
        "scene onto the axis or widen field_of_view",
        rays, format_angle(params.field_of_view));
  return fmt::format(
      "none of {} rays from the panel met a mesh: its pitch of {} sees {} to each side of the axis at {}; {}", rays,
      format_length(panel.pitch), format_angle(std::asin(acceptance_sine(wavelength, panel.pitch))),
      format_length(wavelength),
      params.pattern == Pattern::grid ? "move the scene onto the axis or set field_of_view"
                                      : "move the scene onto the axis or take a panel of finer pitch");
}

/// The waves of the meshes, and the facts of their tracing.
void append_meshes(const PathScene& path_scene, const Grid& panel, double wavelength, const TraceParams& params,
                   const FirstHits& pattern, const Observer& observer, std::vector<Source>& waves) {
  const int64_t count = pattern.count();
  require_memory(double(count) * sizeof(Source), fmt::format("the waves of {} first hits", count));
  std::vector<Block> blocks(size_t((count + block_size - 1) / block_size));
  const auto trace_block = [&](int64_t b) {
    const int64_t end = std::min(count, (b + 1) * block_size);
    for (int64_t i = b * block_size; i < end; ++i) trace_sample(path_scene, pattern, i, params, blocks[size_t(b)]);
  };
  parallel_for(0, int64_t(blocks.size()), trace_block, observer);

  PathCounts counts;
  int64_t first_hits = 0;
  const size_t points = waves.size();
  for (const Block& block : blocks) {
    counts += block.counts;
    first_hits += block.first_hits;
    waves.insert(waves.end(), block.waves.begin(), block.waves.end());
  }
  report(counts, params.max_depth, observer);
  observer.fact("first_hits", Fact(first_hits));
  if (first_hits == 0)
    observer.warn(unseen_sentence(panel, wavelength, params, count));
  else if (waves.size() == points)
    observer.warn("every first hit is dark; add lights, emission or a background to the scene");
}

}  // namespace

Sources trace(const Scene& scene, const Grid& panel, double wavelength, const TraceParams& params,
              const Observer& observer) {
  check_scene(scene);
  check_grid(panel);
  check_wavelength(wavelength);
  check_params(params);

  Sources sources;
  sources.wavelength = wavelength;
  PathParams path_params;
  path_params.max_depth = params.max_depth;
  path_params.seed = uint64_t(params.seed);
  const PathScene path_scene(scene, make_lines(wavelength, wavelength, wavelength), params.layers, path_params);
  append_points(path_scene.accelerator, params, sources.waves);
  if (!scene.meshes.empty()) {
    const FirstHits pattern(params, panel, wavelength);
    append_meshes(path_scene, panel, wavelength, params, pattern, observer, sources.waves);
  }
  observer.fact("waves", Fact(int64_t(sources.waves.size())));
  return sources;
}

std::vector<Sources> trace(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                           const TraceParams& params, const Observer& observer) {
  std::vector<Sources> sets;
  for (const double wavelength : wavelengths) sets.push_back(trace(scene, panel, wavelength, params, observer));
  return sets;
}

}  // namespace holotrace
