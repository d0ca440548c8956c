#include "holotrace/trace/focal_stack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/trace/camera_rays.h"
#include "holotrace/trace/exposed_scene.h"
#include "holotrace/trace/stack_planes.h"

namespace holotrace {
namespace {

/// Weighted sums of radiance at the pixels of one picture, which become means: L = Σ w·L / Σ w.
struct RadianceSums {
  Image light;                 ///< Σ w·L, three channels
  std::vector<float> weights;  ///< Σ w

  explicit RadianceSums(const Grid& grid) : light(grid.ny, grid.nx, 3), weights(size_t(grid.pixels())) {
    light.pitch = grid.pitch;
    light.centre_x = grid.centre_x;
    light.centre_y = grid.centre_y;
  }

  void add(size_t pixel, const float weight, const float* radiance) {
    for (size_t channel = 0; channel < 3; ++channel) light.values[3 * pixel + channel] += weight * radiance[channel];
    weights[pixel] += weight;
  }
};

struct WeightedLight {
  Vec3 light;
  double weight = 0;

  void add(const RadianceSums& sums, size_t pixel) {
    const float* values = &sums.light.values[3 * pixel];
    light += {values[0], values[1], values[2]};
    weight += sums.weights[pixel];
  }
  Vec3 mean() const { return weight > 0 ? light / weight : Vec3{}; }
};

/// Calls add(row, column) for the places of a square of `radius` around (row, column), within rows × columns.
template <class Add>
void for_square(int row, int column, int radius, Vec2 size, const Add& add) {
  for (int j = std::max(0, row - radius); j <= std::min(int(size.y) - 1, row + radius); ++j)
    for (int i = std::max(0, column - radius); i <= std::min(int(size.x) - 1, column + radius); ++i) add(j, i);
}

void set(Image& image, size_t pixel, Vec3 value) {
  image.values[3 * pixel] = float(value.x);
  image.values[3 * pixel + 1] = float(value.y);
  image.values[3 * pixel + 2] = float(value.z);
}

// The means of a picture. A pixel without weight gets the mean over the smallest square of at most 7 × 7 pixels around
// it that has some; 0 if there is none.
Image means_by_pixel(RadianceSums&& sums) {
  constexpr int largest_radius = 3;
  const int nx = sums.light.nx, ny = sums.light.ny;
  Image means = sums.light;
  parallel_for(0, ny, [&](int64_t row) {
    for (int column = 0; column < nx; ++column) {
      WeightedLight sum;
      for (int radius = 0; radius <= largest_radius && !(sum.weight > 0); ++radius)
        for_square(int(row), column, radius, {double(nx), double(ny)},
                   [&](int j, int i) { sum.add(sums, size_t(j) * size_t(nx) + size_t(i)); });
      set(means, size_t(row) * size_t(nx) + size_t(column), sum.mean());
    }
  });
  return means;
}

// The means of the pictures of columns × rows cells, row by row. A pixel without weight gets the mean of the same
// pixel over the smallest square of cells around its own that has some; 0 if there is none.
std::vector<Image> means_by_cell(std::vector<RadianceSums>&& sums, int columns, int rows) {
  const int64_t pixels = int64_t(sums.front().weights.size());
  const int largest_radius = std::max(columns, rows);
  const auto find_means = [&](int64_t first, int64_t last) {
    std::vector<Vec3> means(sums.size());
    for (size_t pixel = size_t(first); pixel < size_t(last); ++pixel) {
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
          WeightedLight sum;
          for (int radius = 0; radius <= largest_radius && !(sum.weight > 0); ++radius)
            for_square(row, column, radius, {double(columns), double(rows)},
                       [&](int j, int i) { sum.add(sums[size_t(j * columns + i)], pixel); });
          means[size_t(row * columns + column)] = sum.mean();
        }
      for (size_t cell = 0; cell < sums.size(); ++cell) set(sums[cell].light, pixel, means[cell]);
    }
  };
  constexpr int64_t block = 1024;
  parallel_for(0, (pixels + block - 1) / block,
               [&](int64_t i) { find_means(i * block, std::min(pixels, (i + 1) * block)); });
  std::vector<Image> images;
  for (RadianceSums& sum : sums) {
    sum.weights = {};
    images.push_back(std::move(sum.light));
  }
  return images;
}

/// The light of a path, to be added to all pictures.
struct TracedRay {
  float from[2], slope[2], weight, radiance[3];
};

/// The pictures that the rays are added to: one per plane, or for the light field one per cell. Distances are those from the
/// lens.
struct Target {
  PixelPlane plane;
  int columns = 1, rows = 1;  // cells
  std::vector<RadianceSums> sums;
};

/// Adds the rays that cross some of a target's rows of pixels, [first, last).
void add_rays(const std::vector<std::vector<TracedRay>>& blocks, const Grid& panel, int first, int last,
              Target& target) {
  const Grid& grid = target.plane.grid;
  const auto per_pixel = float(1 / grid.pitch), distance = float(target.plane.distance);
  const auto left = float(grid.x(-0.5)), top = float(grid.y(-0.5));
  const auto panel_left = float(panel.x(-0.5)), panel_top = float(panel.y(-0.5));
  const auto cells_per_x = float(target.columns / panel.width()), cells_per_y = float(target.rows / panel.height());
  for (const auto& block : blocks)
    for (const TracedRay& ray : block) {
      const float row = std::floor((top - (ray.from[1] + ray.slope[1] * distance)) * per_pixel);
      if (!(row >= float(first) && row < float(last))) continue;
      const float column = std::floor((ray.from[0] + ray.slope[0] * distance - left) * per_pixel);
      if (!(column >= 0 && column < float(grid.nx))) continue;
      size_t cell = 0;
      if (target.sums.size() > 1) {
        const int i = std::clamp(int((ray.from[0] - panel_left) * cells_per_x), 0, target.columns - 1);
        const int j = std::clamp(int((panel_top - ray.from[1]) * cells_per_y), 0, target.rows - 1);
        cell = size_t(j * target.columns + i);
      }
      target.sums[cell].add(size_t(row) * size_t(grid.nx) + size_t(column), ray.weight, ray.radiance);
    }
}

/// Adds rays to all targets. Each row of a target is one thread's, which adds the rays in their order: the sums do not
/// depend on the number of threads.
void add_rays(const std::vector<std::vector<TracedRay>>& blocks, const Grid& panel, std::vector<Target>& targets) {
  const int count = int(targets.size()), strips = (2 * thread_count() + count - 1) / count;
  parallel_for(0, int64_t(count) * strips, [&](int64_t task) {
    Target& target = targets[size_t(task % count)];
    const int64_t strip = task / count, rows = target.plane.grid.ny;
    add_rays(blocks, panel, int(rows * strip / strips), int(rows * (strip + 1) / strips), target);
  });
}

/// The panel, or a part of a plane in front of it.
struct StackLens {
  Grid window;
  double z = 0;        // [m]
  double tangent = 0;  // largest slope of a ray along one axis
};

class StackTracing {
 public:
  /// The tracing of moment m of N.
  StackTracing(const PathScene& scene, size_t moment, size_t moments, const PanelRays& rays, double lens_z,
               const RenderParams& params)
      : scene_(scene), moment_(moment), moments_(moments), rays_(rays), lens_z_(lens_z), params_(params) {}

  /// Traces the moment's paths of some pixels of a plane, [first, last) row by row, and adds them to `found`.
  void trace(int plane, const Grid& grid, int64_t first, int64_t last, std::vector<TracedRay>& found,
             PathCounts& counts) const {
    for (int64_t pixel = first; pixel < last; ++pixel) {
      const int row = int(pixel / grid.nx), column = int(pixel % grid.nx);
      const int candidates = rays_.candidates(plane, row, column);
      const PathRange paths = paths_of_moment(moment_, moments_, candidates, uint64_t(params_.seed), uint64_t(pixel));
      LowDiscrepancy numbers(uint64_t(params_.seed), uint32_t(plane), uint64_t(pixel));
      for (int block = paths.first / most_together * most_together; block < paths.last; block += most_together)
        trace({plane, row, column, candidates}, paths, block, numbers, found, counts);
    }
  }

 private:
  struct Pixel {
    int plane, row, column, candidates;  // number of paths that may be followed
  };

  /// The same for the paths of a pixel that are in one block of the numbers.
  void trace(const Pixel& pixel, PathRange paths, int block, LowDiscrepancy& numbers, std::vector<TracedRay>& found,
             PathCounts& counts) const {
    std::array<NumberedRay, most_together> rays;
    std::array<Vec3, most_together> lights;
    size_t count = 0;
    for (int path = std::max(0, paths.first - block); path < std::min(most_together, paths.last - block); ++path) {
      numbers.start(uint32_t(block + path));
      const Vec2 place = numbers.two(), lens_place = numbers.two();
      const auto ray = rays_.ray(pixel.plane, {pixel.column + place.x, pixel.row + place.y}, lens_place);
      if (numbers.one() >= (ray ? rays_.keep_probability(pixel.plane, *ray, pixel.candidates) : 0)) continue;
      const Vec3 direction = normalize({ray->slope.x, ray->slope.y, -1});
      rays[count++] = {scene_.accelerator.from_viewer({{ray->from.x, ray->from.y, lens_z_}, direction}),
                       uint32_t(path)};
      found.push_back({{float(ray->from.x), float(ray->from.y)},
                       {float(ray->slope.x), float(ray->slope.y)},
                       float(rays_.weight(*ray)),
                       {}});
    }
    radiance_along(scene_, {rays.data(), count}, params_.has_background, numbers.dimension(), numbers,
                   {lights.data(), count}, counts);
    for (size_t i = 0; i < count; ++i) {
      const Vec3 light = lights[i];
      TracedRay& traced = found[found.size() - count + i];
      traced.radiance[0] = float(light.x), traced.radiance[1] = float(light.y), traced.radiance[2] = float(light.z);
    }
  }

  const PathScene& scene_;
  size_t moment_, moments_;
  const PanelRays& rays_;
  double lens_z_;
  const RenderParams& params_;
};

/// Traces the rays of all planes at one moment, in bands of a size that memory holds, and adds them to the targets.
PathCounts fill_at_moment(PreparedExposure& scenes, size_t moment, const PanelRays& rays, double lens_z,
                          const Grid& lens, const RenderParams& params, std::vector<Target>& targets,
                          const Observer& observer) {
  const StackTracing tracing(scenes.at(moment), moment, scenes.moments(), rays, lens_z, params);
  constexpr int64_t pixels_per_block = 64, rays_per_band = int64_t(1) << 21;
  const int64_t paths = std::max<int64_t>(1, paths_per_pixel(params) / int64_t(scenes.moments()));
  const int64_t blocks_per_band = std::max<int64_t>(1, rays_per_band / (pixels_per_block * paths));
  PathCounts total;
  for (size_t p = 0; p < targets.size(); ++p) {
    const Grid grid = targets[p].plane.grid;
    const int64_t blocks = (grid.pixels() + pixels_per_block - 1) / pixels_per_block;
    for (int64_t band = 0; band < blocks; band += blocks_per_band) {
      const int64_t in_band = std::min(blocks_per_band, blocks - band);
      std::vector<std::vector<TracedRay>> found(size_t(in_band), std::vector<TracedRay>{});
      std::vector<PathCounts> counts(size_t(in_band), PathCounts{});
      parallel_for(0, in_band, [&](int64_t i) {
        const int64_t first = (band + i) * pixels_per_block;
        tracing.trace(int(p), grid, first, std::min(grid.pixels(), first + pixels_per_block), found[size_t(i)],
                      counts[size_t(i)]);
      });
      for (const PathCounts& one : counts) total += one;
      add_rays(found, lens, targets);
      // The first plane has nearly all of the work.
      observer.progress(p == 0 ? 0.8 * double(band + in_band) / double(blocks)
                               : 0.8 + 0.2 * (double(p - 1) + double(band + in_band) / double(blocks)) /
                                           double(targets.size() - 1));
    }
  }
  observer.progress(1);
  return total;
}

/// The same at all moments.
PathCounts fill_targets(PreparedExposure& scenes, const StackLens& lens, const RenderParams& params,
                        std::vector<Target>& targets, const Observer& observer) {
  std::vector<PixelPlane> planes;
  for (const Target& target : targets) planes.push_back(target.plane);
  const PanelRays rays(lens.window, lens.tangent, planes, paths_per_pixel(params));
  PathCounts total;
  for (size_t moment = 0; moment < scenes.moments(); ++moment)
    total += fill_at_moment(scenes, moment, rays, lens.z, lens.window, params, targets,
                            part_of(observer, int(moment), int(scenes.moments())));
  return total;
}

/// Adds the mean light of the luminous points to a picture.
void draw_points(PreparedExposure& scenes, const PanelPart& part, const PixelPlane& plane, Image& picture) {
  for (size_t moment = 0; scenes.has_points() && moment < scenes.moments(); ++moment)
    draw_points(scenes.at(moment).accelerator, part, plane,
                scenes.at(moment).share_of_unpolarised() / double(scenes.moments()), picture);
}

void check_light_field(const LightFieldParams& p, const Grid& panel) {
  const Grid& most = p.lens.pixels() > 0 ? p.lens : panel;
  require(std::isfinite(p.distance) && p.distance != 0 && p.distance + p.lens_z != 0,
          "expected a light field in a plane other than those of the panel and the lens, got one at {}",
          format_length(p.distance));
  require(p.columns >= 1 && p.rows >= 1 && p.columns <= most.nx && p.rows <= most.ny,
          "expected 1 to {} columns and 1 to {} rows of cells for the light field of a panel of that many pixels, got "
          "{} and {}",
          most.nx, most.ny, p.columns, p.rows);
  if (p.plane.pixels() > 0) check_grid(p.plane);
}

void check_planes(const ScenePlanes& planes, const Grid& panel) {
  require(!planes.distances.empty() || planes.light_field,
          "expected at least one plane for a focal stack, got none; give distances, such as \"290 mm, 300 mm\"");
  for (const double distance : planes.distances)
    require(std::isfinite(distance) && distance != 0,
            "expected planes of a focal stack behind the panel or in front of it, got one on the panel, at {}",
            format_length(distance));
  if (planes.light_field) check_light_field(*planes.light_field, panel);
}

/// The light field's plane, if there is one, and the others from far to near. `places` receives the place of each
/// target's picture in the stack; −1 for the light field.
std::vector<Target> make_targets(const ScenePlanes& planes, const Grid& panel, std::vector<int>& places) {
  std::vector<Target> targets;
  if (planes.light_field) {
    const LightFieldParams& p = *planes.light_field;
    targets.push_back({{p.plane.pixels() > 0 ? p.plane : panel, p.distance + p.lens_z}, p.columns, p.rows, {}});
    places.push_back(-1);
  }
  std::vector<int> order(planes.distances.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::abs(planes.distances[size_t(a)]) > std::abs(planes.distances[size_t(b)]);
  });
  for (const int place : order) {
    targets.push_back({{panel, planes.distances[size_t(place)]}, 1, 1, {}});
    places.push_back(place);
  }
  double bytes = 0;
  for (const Target& t : targets) bytes += 4.0 * sizeof(float) * double(t.plane.grid.pixels()) * t.columns * t.rows;
  require_memory(bytes, fmt::format("{} planes of a focal stack{}", planes.distances.size(),
                                    planes.light_field ? " and the cells of a light field" : ""));
  for (Target& t : targets) t.sums.assign(size_t(t.columns) * size_t(t.rows), RadianceSums(t.plane.grid));
  return targets;
}

/// The light field that a target has become, with its luminous points.
LightField light_field_of(Target&& target, PreparedExposure& scenes, const Grid& panel, double wavelength,
                          const StackLens& lens) {
  LightField field{panel,
                   lens.window,
                   lens.z,
                   target.columns,
                   target.rows,
                   target.plane.grid,
                   target.plane.distance - lens.z,
                   means_by_cell(std::move(target.sums), target.columns, target.rows)};
  for (int cell = 0; cell < field.columns * field.rows; ++cell) {
    const double left = field.left() + cell % field.columns * field.cell_width();
    const double high = field.top() - cell / field.columns * field.cell_height();
    const PanelPart part{
        left, left + field.cell_width(), high - field.cell_height(), high, lens.z, lens.tangent, panel, wavelength};
    draw_points(scenes, part, target.plane, field.views[size_t(cell)]);
  }
  return field;
}

void check_tracing(const SceneExposure& exposure, const Grid& panel, double wavelength, const RenderParams& params) {
  for (const Moment& moment : exposure.moments) check_scene(*moment.scene);
  check_grid(panel);
  check_wavelength(wavelength, panel);
  check_ranges(params);
}

}  // namespace

SceneViews trace_scene_views(const SceneExposure& exposure, const Grid& panel, double wavelength,
                             const ScenePlanes& planes, const RenderParams& params, const Observer& observer) {
  check_tracing(exposure, panel, wavelength, params);
  check_planes(planes, panel);
  const StackLens lens{panel, 0, acceptance_tangent(wavelength, panel.pitch)};
  PreparedExposure scenes(exposure, params);
  warn_of_caustics(scenes.at(0), observer);
  std::vector<int> places;
  std::vector<Target> targets = make_targets(planes, panel, places);
  const PathCounts counts = fill_targets(scenes, lens, params, targets, observer);

  SceneViews views;
  views.stack = {panel, planes.distances, std::vector<Image>(planes.distances.size())};
  const PanelPart whole{
      panel.x(-0.5), panel.x(panel.nx - 0.5), panel.y(panel.ny - 0.5), panel.y(-0.5), 0, lens.tangent, panel,
      wavelength};
  for (size_t t = 0; t < targets.size(); ++t) {
    Target& target = targets[t];
    if (places[t] < 0) {
      views.light_field = light_field_of(std::move(target), scenes, panel, wavelength, lens);
      continue;
    }
    Image& picture = views.stack.pictures[size_t(places[t])];
    picture = means_by_pixel(std::move(target.sums.front()));
    draw_points(scenes, whole, target.plane, picture);
  }
  report(counts, params.max_depth, observer);
  return views;
}

LightField trace_light_field(const SceneExposure& exposure, const Grid& panel, double wavelength,
                             const LightFieldParams& field, const RenderParams& params, const Observer& observer) {
  check_tracing(exposure, panel, wavelength, params);
  check_light_field(field, panel);
  require(field.lens_z >= 0, "expected a lens on the panel or in front of it (z of 0 m or more), got z = {}",
          format_length(field.lens_z));
  const StackLens lens{field.lens.pixels() > 0 ? field.lens : panel, field.lens_z,
                       acceptance_tangent(wavelength, panel.pitch)};
  PreparedExposure scenes(exposure, params);
  warn_of_caustics(scenes.at(0), observer);
  std::vector<int> places;
  std::vector<Target> targets = make_targets({{}, field}, panel, places);
  report(fill_targets(scenes, lens, params, targets, observer), params.max_depth, observer);
  return light_field_of(std::move(targets.front()), scenes, panel, wavelength, lens);
}

FocalStack trace_focal_stack(const SceneExposure& exposure, const Grid& panel, double wavelength,
                             const std::vector<double>& distances, const RenderParams& params,
                             const Observer& observer) {
  return trace_scene_views(exposure, panel, wavelength, {distances, {}}, params, observer).stack;
}

}  // namespace holotrace
