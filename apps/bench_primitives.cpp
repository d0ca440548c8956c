// The steps of holotrace bench that make fields of slices and of triangles.

#include <fmt/format.h>

#include <cmath>

#include "bench.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/wave/sum_layers.h"
#include "holotrace/wave/sum_triangles.h"

namespace holotrace {
namespace {

using namespace literals;

const Grid full_hd{1920, 1080, 8_um};

// Waves all over the panel, in 20 mm of depth around 0.2 m.
BenchRow bench_layers(const BenchOptions& options, int count, int slices) {
  Sources sources{532_nm, {}};
  CounterRandom random(1, 0, 0);
  for (int j = 0; j < count; ++j)
    sources.waves.push_back({{(random.uniform() - 0.5) * full_hd.width(), (random.uniform() - 0.5) * full_hd.height(),
                              -0.19_m - 20_mm * random.uniform()},
                             1,
                             float(2 * pi * random.uniform())});
  SynthesizeParams params;
  params.slices = slices;
  const Timing timing = time_work(
      options, [&] { sum_layers(sources, full_hd, params); }, slices);
  return make_row("layers", fmt::format("1920x1080, {} waves, 0.19-0.21 m", short_count(count)), timing, slices,
                  "slices");
}

// The half of a sphere of 8 mm that faces the panel, 0.2 m behind it, as about that many triangles.
BenchRow bench_triangles(const BenchOptions& options, int count, double tolerance) {
  Mesh sphere = make_sphere(8_mm, int(std::lround(std::sqrt(2.0 * count))));
  transform_mesh({.origin = {0, 0, -0.2_m}}, sphere);
  Triangles triangles{532_nm, {}};
  CounterRandom random(1, 0, 0);
  for (const auto& [i, j, k] : sphere.triangles) {
    Triangle t;
    t.corners = {sphere.positions[i], sphere.positions[j], sphere.positions[k]};
    const Vec3 normal = cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
    if (!(normal.z > 0)) continue;
    t.amplitudes = {1, 1, 1};
    t.phase = float(2 * pi * random.uniform());
    triangles.triangles.push_back(t);
  }
  const double amount = double(triangles.triangles.size());
  const Timing timing = time_work(
      options, [&] { sum_triangles(triangles, full_hd, tolerance); }, amount);
  return make_row("triangles", fmt::format("1920x1080, {} triangles, {:g}", short_count(count), tolerance), timing,
                  amount, "triangles");
}

}  // namespace

std::vector<BenchStep> layers_steps(const BenchOptions& options) {
  return {
      {"layers", [=] { return bench_layers(options, options.is_quick ? 10000 : 100000, options.is_quick ? 5 : 20); }}};
}

std::vector<BenchStep> triangles_steps(const BenchOptions& options) {
  if (options.is_quick) return {{"triangles", [=] { return bench_triangles(options, 100, 1e-2); }}};
  return {{"triangles", [=] { return bench_triangles(options, 10000, 1e-2); }},
          {"triangles", [=] { return bench_triangles(options, 10000, 1e-3); }}};
}

}  // namespace holotrace
