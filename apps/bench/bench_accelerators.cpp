// Steps of holotrace bench that follow the same rays through Embree's trees and through a uniform grid, from
// hundreds of triangles to a million: the cost of the paper's appendix, predicted and measured.

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <memory>

#include "bench/bench.h"
#include "holotrace/data/shapes.h"
#include "holotrace/estimate/cost.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/trace/geometry/accelerator.h"

namespace holotrace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// A sphere of about `count` triangles that fills the cube of the cloud.
Scene make_sphere_scene(int count) {
  Scene scene;
  scene.materials.emplace_back();
  Mesh mesh = make_sphere(1, std::max(4, int(std::sqrt(double(count)))));
  transform_mesh({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -2}}, mesh);
  scene.meshes.push_back(std::move(mesh));
  return scene;
}

struct AcceleratorJob {
  std::string name;
  Scene scene;
  std::vector<Ray> rays;
};

// Measures the time of a ray on one thread.
BenchRow time_rays(const BenchOptions& options, const AcceleratorJob& job, Acceleration kind) {
  const double build = median_seconds(1, [&] { Accelerator{job.scene, kind}; });
  const Accelerator accelerator(job.scene, kind);
  std::atomic<int64_t> hits{0};
  const Timing timing = time_work(
      options,
      [&] {
        int64_t found = 0;
        Hit hit;
        for (const Ray& ray : job.rays) found += accelerator.closest_hit(ray, hit);
        hits = found;
      },
      double(job.rays.size()));
  int64_t triangles = 0;
  for (const Mesh& mesh : job.scene.meshes) triangles += int64_t(mesh.triangles.size());
  BenchRow row = make_row(kind == Acceleration::grid ? "grid" : "Embree",
                          fmt::format("{}, {} triangles, one thread", job.name, triangles), timing,
                          double(job.rays.size()), "rays");
  row.facts = {{"triangles", triangles},
               {"scene", job.name},
               {"seconds_per_ray", timing.seconds / double(job.rays.size())},
               {"build_seconds", build},
               {"hits_per_ray", double(hits) / double(job.rays.size())}};
  return row;
}

BenchRow bench_grid(const BenchOptions& options, const AcceleratorJob& job, const GridRates& rates) {
  BenchRow row = time_rays(options, job, Acceleration::grid);
  const UniformGrid grid(job.scene);
  GridCounts counts;
  GridHit hit;
  for (const Ray& ray : job.rays) grid.closest_hit(ray, infinity, hit, &counts);
  const GridCost predicted = predict_grid_cost(grid.statistics(), rates), counted = counted_grid_cost(counts, rates);
  row.facts["grid_cells"] = grid.statistics().cells;
  row.facts["cells_per_ray"] = counted.cells;
  row.facts["tests_per_ray"] = counted.tests;
  row.facts["predicted_cells_per_ray"] = predicted.cells;
  row.facts["predicted_tests_per_ray"] = predicted.tests;
  row.facts["predicted_seconds_per_ray"] = predicted.seconds;
  return row;
}

}  // namespace

std::vector<BenchStep> accelerators_steps(const BenchOptions& options) {
  const auto rates = std::make_shared<GridRates>();
  std::vector<BenchStep> steps;
  for (const bool is_sphere : {false, true})
    for (const int count : {100, 1000, 10000, 100000, 1000000}) {
      if (options.is_quick && count > 10000) continue;
      for (const Acceleration kind : {Acceleration::embree, Acceleration::grid})
        steps.push_back({kind == Acceleration::grid ? "grid" : "Embree", [=] {
                           const AcceleratorJob job{is_sphere ? "sphere" : "cloud",
                                                    is_sphere ? make_sphere_scene(count) : make_triangle_cloud(count),
                                                    cloud_rays(options.is_quick ? 5000 : 50000)};
                           if (kind == Acceleration::embree) return time_rays(options, job, kind);
                           if (!(rates->cell > 0)) *rates = calibrate_grid();
                           return bench_grid(options, job, *rates);
                         }});
    }
  return steps;
}

Chart accelerators_chart(const std::vector<BenchRow>& rows) {
  Chart chart;
  chart.title = "Time per ray against the number of triangles, one thread";
  chart.x_label = "triangles";
  chart.y_label = "time per ray [us]";
  chart.is_log_x = chart.is_log_y = true;
  const auto add = [&](const std::string& name, double triangles, double seconds, bool is_measured) {
    auto series =
        std::find_if(chart.series.begin(), chart.series.end(), [&](const Series& s) { return s.name == name; });
    if (series == chart.series.end()) series = chart.series.insert(series, {name, {}, {}, is_measured, true});
    series->x.push_back(triangles);
    series->y.push_back(seconds * 1e6);
  };
  for (const BenchRow& row : rows) {
    if (!row.facts.contains("seconds_per_ray")) continue;
    const double triangles = row.facts["triangles"].get<double>();
    const std::string name = row.facts["scene"].get<std::string>() + ", " + row.stage;
    add(name, triangles, row.facts["seconds_per_ray"].get<double>(), true);
    if (row.facts.contains("predicted_seconds_per_ray"))
      add(name + " predicted", triangles, row.facts["predicted_seconds_per_ray"].get<double>(), false);
  }
  return chart;
}

}  // namespace holotrace
