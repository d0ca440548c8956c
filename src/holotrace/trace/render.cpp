#include "holotrace/trace/render.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/threads.h"
#include "holotrace/trace/first_hits.h"
#include "holotrace/trace/path.h"

namespace holotrace {

namespace {

void check_params(const RenderParams& params) {
  require(
      params.columns >= 0 && params.rows >= 1,
      "expected a picture of at least 1 row, and columns of 1 or more or 0 for a square, got columns = {}, rows = {}",
      params.columns, params.rows);
  require(params.paths >= 1, "expected paths of 1 or more per pixel, got {}", params.paths);
  require(params.max_depth >= 1, "expected a max_depth of 1 surface or more, got {}", params.max_depth);
}

/// A pinhole at the panel's centre.
struct Pinhole {
  int columns, rows;
  double pixel;  // side in tangents

  Ray ray(double column, double row) const {
    return {{}, view_direction((column - columns / 2.0) * pixel, (rows / 2.0 - row) * pixel)};
  }
};

void add(Image& image, int row, int column, Vec3 radiance) {
  image(row, column, 0) += float(radiance.x);
  image(row, column, 1) += float(radiance.y);
  image(row, column, 2) += float(radiance.z);
}

Vec3 render_pixel(const PathScene& scene, const Pinhole& pinhole, int row, int column, const RenderParams& params,
                  PathCounts& counts) {
  LowDiscrepancy numbers(uint64_t(params.seed), 0, uint64_t(row) * uint64_t(pinhole.columns) + uint64_t(column));
  std::vector<Vec3> sums(size_t(scene.sums()));
  Vec3 sum;
  for (int path = 0; path < params.paths; ++path) {
    numbers.start(uint32_t(path));
    const Vec2 place = numbers.two();
    ++counts.rays;
    const Ray ray = pinhole.ray(column + place.x, row + place.y);
    const auto hit = scene.accelerator.closest_hit(ray);
    if (hit)
      add_radiance(scene, {hit->point, -ray.direction, scene.automaton.start(), 1}, numbers, sums, counts);
    else
      sum += scene.emitters.background(ray.direction);
  }
  for (const Vec3 layer : sums) sum += layer;
  return sum / params.paths;
}

/// Adds light at (column, row), pixel centres at whole numbers, shared by the four pixels around it.
void add_between(Image& image, double column, double row, Vec3 light) {
  const double left = std::floor(column), top = std::floor(row);
  for (const int j : {0, 1})
    for (const int i : {0, 1}) {
      const double share = (1 - std::abs(left + i - column)) * (1 - std::abs(top + j - row));
      add(image, std::clamp(int(top) + j, 0, image.ny - 1), std::clamp(int(left) + i, 0, image.nx - 1), light * share);
    }
}

/// Adds the luminous points that fall into the picture and that no mesh hides.
void draw_points(const Accelerator& scene, const Pinhole& pinhole, Image& image) {
  for (const ScenePoint& point : scene.scene().points) {
    const Vec3 p = point.position;
    const double column = p.x / -p.z / pinhole.pixel + (pinhole.columns - 1) / 2.0;
    const double row = (pinhole.rows - 1) / 2.0 - p.y / -p.z / pinhole.pixel;
    const bool is_inside = std::abs(column - (pinhole.columns - 1) / 2.0) <= pinhole.columns / 2.0 &&
                           std::abs(row - (pinhole.rows - 1) / 2.0) <= pinhole.rows / 2.0;
    if (!is_inside || scene.is_occluded({}, p)) continue;
    const double cosine = -p.z / length(p);
    const double radiance =
        double(point.amplitude) * point.amplitude / (pinhole.pixel * pinhole.pixel * cosine * cosine);
    add_between(image, column, row, Vec3{1, 1, 1} * radiance);
  }
}

}  // namespace

Image render(const Scene& scene, const Grid& panel, double wavelength, const RenderParams& params,
             const Observer& observer) {
  check_scene(scene);
  check_grid(panel);
  check_wavelength(wavelength);
  check_params(params);

  const int rows = params.rows, columns = params.columns > 0 ? params.columns : rows;
  const Pinhole pinhole{columns, rows, 2 * raster_tangent(params.field_of_view, panel, wavelength) / rows};
  PathParams path_params;
  path_params.max_depth = params.max_depth;
  path_params.seed = uint64_t(params.seed);
  const PathScene path_scene(scene, Lines{}, params.layers, path_params);
  require_memory(3.0 * sizeof(float) * columns * rows, fmt::format("a picture of {} × {} pixels", columns, rows));
  Image image(rows, columns, 3);
  std::vector<PathCounts> counts(size_t(rows), PathCounts{});
  const auto render_row = [&](int64_t row) {
    for (int column = 0; column < columns; ++column)
      add(image, int(row), column, render_pixel(path_scene, pinhole, int(row), column, params, counts[size_t(row)]));
  };
  parallel_for(0, rows, render_row, observer);
  draw_points(path_scene.accelerator, pinhole, image);

  PathCounts total;
  for (const PathCounts& row : counts) total += row;
  report(total, params.max_depth, observer);
  return image;
}

}  // namespace holotrace
