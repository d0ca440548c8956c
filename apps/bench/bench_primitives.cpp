// The steps of holotrace bench that make fields of slices and of triangles.

#include <fmt/format.h>

#include "bench/bench.h"
#include "holotrace/estimate/machine/timed_jobs.h"
#include "holotrace/wave/layers/sum_layers.h"
#include "holotrace/wave/triangles/sum_triangles.h"

namespace holotrace {
namespace {

// Waves spread over the whole panel, in 20 mm of depth around 0.2 m.
BenchRow bench_layers(const BenchOptions& options, int count, int slices) {
  const Sources sources = timed_waves(timed_full_hd, count, 0.19, 0.21);
  SynthesizeParams params;
  params.slices = slices;
  const Timing timing = time_work(
      options, [&] { sum_layers(sources, timed_full_hd, params); }, slices);
  return make_row("layers", fmt::format("1920x1080, {} waves, 0.19-0.21 m", short_count(count)), timing, slices,
                  "slices");
}

BenchRow bench_triangles(const BenchOptions& options, int count, double tolerance) {
  const Triangles triangles = timed_half_sphere(count);
  const double amount = double(triangles.triangles.size());
  const Timing timing = time_work(
      options, [&] { sum_triangles(triangles, timed_full_hd, tolerance); }, amount);
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
