#include "holotrace/trace/render.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/trace/camera_rays.h"
#include "holotrace/trace/exposed_scene.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/trace_report.h"

namespace holotrace {

namespace {

/// Start and target of the picture's rays (formulas: render.h).
struct Eye {
  int columns, rows;
  double pixel;  // side of a pixel, as a tangent
  Lens lens;
  Vec3 position;
  double pupil, focus;
  double middle_x, middle_y;       // of the picture, as tangents
  double panel_x, panel_y, reach;  // half the sides of the panel; of its boxes in the plane in focus [m]

  /// A point of the lens for the tangents (x, y), from two numbers; none if the panel has no such part.
  std::optional<Vec3> lens_place(double x, double y, Vec2 u) const {
    if (lens == Lens::pinhole) return position;
    if (lens == Lens::round) {
      const double radius = pupil / 2 * std::sqrt(u.x), angle = 2 * pi * u.y;
      return position + Vec3{radius * std::cos(angle), radius * std::sin(angle), 0};
    }
    const double distance = std::abs(focus);
    const double left = std::max(-panel_x, x * distance - reach), right = std::min(panel_x, x * distance + reach);
    const double low = std::max(-panel_y, y * distance - reach), high = std::min(panel_y, y * distance + reach);
    if (left >= right || low >= high) return std::nullopt;
    return Vec3{left + (right - left) * u.x, low + (high - low) * u.y, 0};
  }

  /// The ray through a place in the window, given in pixels from its upper left corner.
  std::optional<Ray> ray(double column, double row, Vec2 u) const {
    const double x = middle_x + (column - columns / 2.0) * pixel, y = middle_y + (rows / 2.0 - row) * pixel;
    const auto from = lens_place(x, y, u);
    if (!from) return std::nullopt;
    const double distance = std::abs(focus);
    const Vec3 way = Vec3{x * distance, y * distance, -focus} - *from;
    return Ray{*from, normalize(way.z < 0 ? way : -way)};
  }

  bool needs_lens_place() const { return lens != Lens::pinhole; }
};

void add(Image& image, int row, int column, Vec3 radiance) {
  image(row, column, 0) += float(radiance.x);
  image(row, column, 1) += float(radiance.y);
  image(row, column, 2) += float(radiance.z);
}

struct Pixel {
  int row, column;
};

// The sum over some of the paths of a pixel.
Vec3 sum_paths(const PathScene& scene, const Eye& eye, const Pixel& pixel, PathRange paths, const RenderParams& params,
               PathCounts& counts) {
  const auto [row, column] = pixel;
  LowDiscrepancy numbers(uint64_t(params.seed), 0, uint64_t(row) * uint64_t(eye.columns) + uint64_t(column));
  Vec3 sum;
  std::array<NumberedRay, most_together> rays;
  std::array<Vec3, most_together> lights;
  for (int block = paths.first / most_together * most_together; block < paths.last; block += most_together) {
    size_t count = 0;
    for (int path = std::max(0, paths.first - block); path < std::min(most_together, paths.last - block); ++path) {
      numbers.start(uint32_t(block + path));
      const Vec2 place = numbers.two();
      const auto ray = eye.ray(column + place.x, row + place.y, eye.needs_lens_place() ? numbers.two() : Vec2{});
      if (ray) rays[count++] = {scene.accelerator.from_viewer(*ray), uint32_t(path)};
    }
    radiance_along(scene, {rays.data(), count}, params.has_background, numbers.dimension(), numbers,
                   {lights.data(), count}, counts);
    sum = std::accumulate(lights.begin(), lights.begin() + int64_t(count), sum);
  }
  return sum;
}

/// Adds light at (column, row), with pixel centres at integers, shared among the four pixels around it.
void add_between(Image& image, double column, double row, Vec3 light) {
  const double left = std::floor(column), top = std::floor(row);
  for (const int j : {0, 1})
    for (const int i : {0, 1}) {
      const double share = (1 - std::abs(left + i - column)) * (1 - std::abs(top + j - row));
      add(image, std::clamp(int(top) + j, 0, image.ny - 1), std::clamp(int(left) + i, 0, image.nx - 1), light * share);
    }
}

/// Adds that part of the light of the luminous points that fall into the picture and that no mesh hides from the eye.
void draw_points(const Accelerator& scene, const Eye& eye, const Grid& panel, double wavelength, double part,
                 Image& image) {
  const Vec3 from = eye.lens == Lens::panel ? Vec3{} : eye.position;
  for (const ScenePoint& point : scene.scene().points) {
    const Vec3 way = point.position - from;
    if (from.z > 0 && way.z >= 0) continue;                           // behind the viewer
    const Vec3 place = from + way * ((from.z + eye.focus) / -way.z);  // in the plane in focus
    const double distance = std::abs(eye.focus);
    const double column = (place.x / distance - eye.middle_x) / eye.pixel + (eye.columns - 1) / 2.0;
    const double row = (eye.rows - 1) / 2.0 - (place.y / distance - eye.middle_y) / eye.pixel;
    const bool is_inside = std::abs(column - (eye.columns - 1) / 2.0) <= eye.columns / 2.0 &&
                           std::abs(row - (eye.rows - 1) / 2.0) <= eye.rows / 2.0;
    if (!is_inside || scene.is_hidden(from, point.position)) continue;
    const double side = std::abs(eye.pixel * distance / (eye.focus + from.z));
    const double radiance = point_light(point, from, panel, wavelength) / (side * side);
    add_between(image, column, row, Vec3{1, 1, 1} * (part * radiance));
  }
}

// The picture, or only its pixels in the mask; the others hold nothing but luminous points.
Image render_masked(const SceneExposure& exposure, const Grid& panel, double wavelength, const RenderParams& asked,
                    const PixelMask* mask, const Observer& observer) {
  for (const Moment& moment : exposure.moments) check_scene(*moment.scene);
  check_grid(panel);
  check_wavelength(wavelength, panel);
  check_ranges(asked);
  require(asked.focus != 0, "expected a plane in focus behind the panel or in front of it, got the panel's own, 0 m");
  RenderParams params = asked;
  params.paths = paths_per_pixel(asked);

  const int rows = params.rows, columns = params.columns > 0 ? params.columns : rows;
  Eye eye{.columns = columns,
          .rows = rows,
          .pixel = 2 * raster_tangent(params.field_of_view, panel, wavelength) / rows,
          .lens = params.lens,
          .position = params.eye,
          .pupil = params.pupil,
          .focus = params.focus,
          .middle_x = std::tan(params.azimuth),
          .middle_y = std::tan(params.elevation),
          .panel_x = panel.width() / 2,
          .panel_y = panel.height() / 2,
          .reach = box_radius(std::abs(params.focus), wavelength, panel.pitch)};
  PreparedExposure prepared(exposure, params);
  warn_of_caustics(prepared.at(0), observer);
  require_memory(3.0 * (sizeof(float) + 1) * columns * rows,  // a byte each when it is saved
                 fmt::format("a picture of {} × {} pixels", columns, rows));
  Image image(rows, columns, 3);
  std::vector<PathCounts> counts(size_t(rows), PathCounts{});
  constexpr int often = 16;  // pixels between reports: a row of many paths takes long, and a caller may want to stop
  std::atomic<int64_t> done{0};
  for (size_t moment = 0; moment < exposure.moments.size(); ++moment) {
    const PathScene& path_scene = prepared.at(moment);
    eye.position = params.eye + exposure.moments[moment].eye_moved;
    parallel_for(0, rows, [&](int64_t row) {
      for (int first = 0; first < columns; first += often) {
        const int end = std::min(columns, first + often);
        for (int column = first; column < end; ++column) {
          const size_t pixel = size_t(row) * size_t(columns) + size_t(column);
          const PathRange paths =
              paths_of_moment(moment, exposure.moments.size(), params.paths, uint64_t(params.seed), pixel);
          if (paths.first == paths.last || (mask && !(*mask)[pixel])) continue;
          const Vec3 sum = sum_paths(path_scene, eye, {int(row), column}, paths, params, counts[size_t(row)]);
          add(image, int(row), column, sum / params.paths);
        }
        const int64_t pixels = done += end - first;
        observer.progress(double(pixels) / (double(rows) * columns * double(exposure.moments.size())));
      }
    });
  }
  for (size_t moment = 0; prepared.has_points() && moment < exposure.moments.size(); ++moment) {
    const Accelerator& accelerator = prepared.at(moment).accelerator;
    eye.position = params.eye + exposure.moments[moment].eye_moved;
    const double part = prepared.at(moment).share_of_unpolarised() / double(exposure.moments.size());
    draw_points(accelerator, eye, panel, wavelength, part, image);
  }

  PathCounts total;
  for (const PathCounts& row : counts) total += row;
  report(total, params.max_depth, observer);
  const bool is_black = std::all_of(image.values.begin(), image.values.end(), [](float v) { return v == 0; });
  const Scene& scene = *exposure.moments.front().scene;
  if (!mask && is_black && has_surfaces(scene))
    observer.warn("the picture is black: " +
                  (total.vertices > 0
                       ? dark_sentence(scene)
                       : "no ray met a surface; move the scene behind the panel's middle, or widen field_of_view"));
  return image;
}

}  // namespace

Image render(const SceneExposure& exposure, const Grid& panel, double wavelength, const RenderParams& params,
             const Observer& observer) {
  return render_masked(exposure, panel, wavelength, params, nullptr, observer);
}

void render_pixels(const SceneExposure& exposure, const Grid& panel, double wavelength, const RenderParams& params,
                   const PixelMask& mask, Image& image, const Observer& observer) {
  check_ranges(params);
  const int columns = params.columns > 0 ? params.columns : params.rows;
  const size_t pixels = size_t(params.rows) * size_t(columns);
  require(image.ny == params.rows && image.nx == columns && image.channels == 3 && mask.size() == pixels,
          "expected a picture of {} × {} pixels in three colours, with a mask of as many pixels, got {} × {}, {} "
          "colour(s) and {} pixels",
          columns, params.rows, image.nx, image.ny, image.channels, mask.size());
  const Image made = render_masked(exposure, panel, wavelength, params, &mask, observer);
  for (size_t i = 0; i < pixels; ++i)
    if (mask[i]) std::copy_n(&made.values[3 * i], 3, &image.values[3 * i]);
}

}  // namespace holotrace
