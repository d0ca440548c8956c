#include "holotrace/estimate/cost.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/pseudo_inverse.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"

namespace holotrace {

double mean_path_length(double reflectance, int bounces) {
  require(reflectance >= 0 && reflectance < 1,
          "expected a probability in [0, 1) that a path goes on, got {}; at 1 no path would end", reflectance);
  if (bounces < 0) return 1 / (1 - reflectance);
  return (1 - std::pow(reflectance, bounces + 1)) / (1 - reflectance);
}

Cost estimate_cost(const CostInputs& in) {
  for (double value : {in.pixels, in.samples_per_pixel, in.frames, in.trace_seconds, in.waves, in.wave_rate})
    require(std::isfinite(value) && value >= 0, "expected counts and times of 0 or more, got {}", value);
  require(in.wave_rate > 0, "expected a rate above 0 waves·pixels/s, got {}", in.wave_rate);
  Cost cost;
  cost.paths = in.pixels * in.samples_per_pixel;
  cost.mean_path_length = mean_path_length(in.reflectance);
  cost.rays = cost.mean_path_length * cost.paths;
  cost.trace_seconds = in.frames * cost.paths * (1 + cost.mean_path_length) * in.trace_seconds;
  cost.synthesis_seconds = in.frames * in.waves * in.pixels / in.wave_rate;
  cost.seconds = cost.trace_seconds + cost.synthesis_seconds;
  return cost;
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const Vec3 cloud_centre{0, 0, -2};

Vec3 random_direction(CounterRandom& random) {
  const double z = 2 * random.uniform() - 1, angle = 2 * pi * random.uniform(), r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace

GridCost predict_grid_cost(const GridStatistics& grid, const GridRates& rates) {
  GridCost cost{0, 0, rates.ray};
  if (grid.triangles == 0) return cost;
  const double volume = grid.width * grid.height * grid.depth;
  const double surface = 2 * (grid.width * grid.height + grid.height * grid.depth + grid.depth * grid.width);
  const double chord = 4 * volume / surface, density = grid.area / (2 * volume);
  const double travelled = density * chord > 1e-9 ? -std::expm1(-density * chord) / density : chord;
  cost.cells = 1 + travelled / 2 * (1 / grid.cell_x + 1 / grid.cell_y + 1 / grid.cell_z);
  // A box that is flat along an axis has one cell along it, which limits the cells that a ray crosses.
  cost.cells = std::min(cost.cells, grid.width / grid.cell_x + grid.height / grid.cell_y + grid.depth / grid.cell_z);
  cost.tests = cost.cells * double(grid.entries) / double(grid.cells);
  cost.seconds += cost.cells * rates.cell + cost.tests * rates.test;
  return cost;
}

GridCost counted_grid_cost(const GridCounts& counts, const GridRates& rates) {
  if (counts.rays == 0) return {};
  const double cells = double(counts.cells) / double(counts.rays), tests = double(counts.tests) / double(counts.rays);
  return {cells, tests, rates.ray + cells * rates.cell + tests * rates.test};
}

GridRates calibrate_grid() {
  constexpr int counts_of_triangles[] = {200, 2000, 20000};
  constexpr double densities[] = {0.5, 4.0, 30.0};
  Eigen::MatrixX3d rows(9, 3);  // counts over seconds: rows·(cell, test, ray) = 1
  int row = 0;
  const std::vector<Ray> rays = cloud_rays(8000);  // too many for branch prediction to learn
  for (const int triangles : counts_of_triangles)
    for (const double density : densities) {
      const Scene scene = make_triangle_cloud(triangles);
      const UniformGrid grid(scene, density);
      GridCounts counts;
      GridHit hit;
      for (const Ray& ray : rays) grid.closest_hit(ray, infinity, hit, &counts);
      // The fastest of several runs: other work on the machine can only slow a run down.
      double best = infinity;
      for (int run = 0; run < 3; ++run) {
        const auto start = std::chrono::steady_clock::now();
        for (const Ray& ray : rays) grid.closest_hit(ray, infinity, hit);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      }
      rows.row(row++) << double(counts.cells) / best, double(counts.tests) / best, double(counts.rays) / best;
    }
  const Eigen::Vector3d seconds = pseudo_inverse(rows).rowwise().sum();
  return {std::max(seconds[0], 0.0), std::max(seconds[1], 0.0), std::max(seconds[2], 0.0)};
}

Scene make_triangle_cloud(int count) {
  Scene scene;
  scene.materials.emplace_back();
  Mesh mesh;
  mesh.name = "cloud";
  const double side = std::sqrt(2.0 / count * 4 / std::sqrt(3.0));  // side of an equilateral triangle of 2 m²/count
  for (int i = 0; i < count; ++i) {
    CounterRandom random(1, 0, uint64_t(i));
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    const Vec3 centre = cloud_centre + Vec3{x - 0.5, y - 0.5, z - 0.5} * std::max(0.0, 1 - side);
    const Vec3 normal = random_direction(random), other = random_direction(random);
    const Vec3 u = normalize(cross(normal, other)), v = cross(normal, u);
    const uint32_t first = uint32_t(mesh.positions.size());
    for (int corner = 0; corner < 3; ++corner) {
      const double angle = 2 * pi * corner / 3;
      mesh.positions.push_back(centre + (u * std::cos(angle) + v * std::sin(angle)) * (side / std::sqrt(3.0)));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  scene.meshes.push_back(std::move(mesh));
  return scene;
}

namespace {

Ray cloud_ray(int64_t i) {
  // A direction, and a place on the disc across it that covers the cube; rays that miss the cube are drawn again.
  CounterRandom random(2, 0, uint64_t(i));
  constexpr double radius = 0.8660254037844386;  // radius of the sphere around the cube [m]
  while (true) {
    const Vec3 direction = random_direction(random), other = random_direction(random);
    const Vec3 u = normalize(cross(direction, other)), v = cross(direction, u);
    const double r = radius * std::sqrt(random.uniform()), angle = 2 * pi * random.uniform();
    const Vec3 origin = u * (r * std::cos(angle)) + v * (r * std::sin(angle)) - direction * 2;
    double enter = 0, leave = infinity;
    for (const auto& [o, d] : {std::pair{origin.x, direction.x}, {origin.y, direction.y}, {origin.z, direction.z}}) {
      enter = std::max(enter, std::min((-0.5 - o) / d, (0.5 - o) / d));
      leave = std::min(leave, std::max((-0.5 - o) / d, (0.5 - o) / d));
    }
    if (enter < leave) return {cloud_centre + origin, direction};
  }
}

}  // namespace

std::vector<Ray> cloud_rays(int64_t count) {
  std::vector<Ray> rays;
  for (int64_t i = 0; i < count; ++i) rays.push_back(cloud_ray(i));
  return rays;
}

}  // namespace holotrace
