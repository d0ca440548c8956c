#include "holotrace/trace/geometry/uniform_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/trace/geometry/light_surfaces.h"

namespace holotrace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double margin = 1e-9;       // relative margin of boxes and cells: far above rounding, far below a cell
constexpr double most_across = 2048;  // largest number of cells along an axis
constexpr int64_t block_size = 1024;  // triangles or cells per task

double component(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// A ray in the frame of the watertight test: z is the axis of its largest component, and a shear puts it along z.
struct ShearedRay {
  Vec3 origin;
  int x, y, z;
  double shear_x, shear_y, shear_z;

  explicit ShearedRay(const Ray& ray) : origin(ray.origin) {
    const Vec3 direction = ray.direction;
    const double size[] = {std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)};
    z = size[0] > size[1] ? (size[0] > size[2] ? 0 : 2) : (size[1] > size[2] ? 1 : 2);
    x = (z + 1) % 3, y = (z + 2) % 3;
    if (component(direction, z) < 0) std::swap(x, y);  // keeps the winding of triangles
    shear_z = 1 / component(direction, z);
    shear_x = component(direction, x) * shear_z;
    shear_y = component(direction, y) * shear_z;
  }
};

/// Where a ray meets a triangle: the signed areas U, V, W of the ray with its edges have one sign. The neighbour across
/// an edge gets the same number with the opposite sign, so no ray passes between the two triangles.
struct Meeting {
  double distance, b1, b2;  // barycentric coordinates of the second and the third corner
};
bool meets(const ShearedRay& ray, const std::array<Vec3, 3>& corners, double limit, Meeting& meeting) {
  const Vec3 a = corners[0] - ray.origin, b = corners[1] - ray.origin, c = corners[2] - ray.origin;
  const double az = component(a, ray.z), bz = component(b, ray.z), cz = component(c, ray.z);
  const double ax = component(a, ray.x) - ray.shear_x * az, ay = component(a, ray.y) - ray.shear_y * az;
  const double bx = component(b, ray.x) - ray.shear_x * bz, by = component(b, ray.y) - ray.shear_y * bz;
  const double cx = component(c, ray.x) - ray.shear_x * cz, cy = component(c, ray.y) - ray.shear_y * cz;
  const double u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double sum = u + v + w;
  if (sum == 0) return false;  // seen edge on
  const double t = ray.shear_z * (u * az + v * bz + w * cz) / sum;
  if (!(t >= 0 && t <= limit)) return false;
  meeting = {t, v / sum, w / sum};
  return true;
}

/// Whether the projections of a triangle and of a box centred at the origin onto an axis overlap.
bool overlap(Vec3 axis, Vec3 a, Vec3 b, Vec3 c, Vec3 half) {
  const double p = dot(axis, a), q = dot(axis, b), r = dot(axis, c);
  const double reach = half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
  return std::min({p, q, r}) <= reach && std::max({p, q, r}) >= -reach;
}

/// Separating-axis test of a triangle and a box, without the box's own axes (T. Akenine-Möller, J. Graphics Tools 6(1),
/// 29, 2001).
bool touches(Vec3 a, Vec3 b, Vec3 c, Vec3 half) {
  const Vec3 edges[] = {b - a, c - b, a - c};
  if (!overlap(cross(edges[0], edges[1]), a, b, c, half)) return false;
  for (const Vec3 edge : edges)
    for (const Vec3 axis : {Vec3{0, -edge.z, edge.y}, Vec3{edge.z, 0, -edge.x}, Vec3{-edge.y, edge.x, 0}})
      if (!overlap(axis, a, b, c, half)) return false;
  return true;
}

}  // namespace

GridCounts& GridCounts::operator+=(const GridCounts& other) {
  rays += other.rays, cells += other.cells, tests += other.tests;
  return *this;
}

UniformGrid::UniformGrid(const Scene& scene, double density) : UniformGrid(scene, light_lifts(scene), density) {}

UniformGrid::UniformGrid(const Scene& scene, const std::vector<double>& lifts, double density) {
  require(std::isfinite(density) && density > 0, "expected a density above 0 cells per triangle, got {}", density);
  list_triangles(scene, lifts);
  if (triangles_.empty()) return;
  choose_cells(density);
  fill_cells();
}

void UniformGrid::list_triangles(const Scene& scene, const std::vector<double>& lifts) {
  low_ = {infinity, infinity, infinity}, high_ = -low_;
  uint32_t id = 0;
  const auto add = [&](const Mesh& mesh) {
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [i, j, k] = mesh.triangles[t];
      const Triangle triangle{mesh.positions[i], mesh.positions[j], mesh.positions[k], id, uint32_t(t)};
      const double twice = length(cross(triangle.b - triangle.a, triangle.c - triangle.a));
      if (!(twice > 0)) continue;
      statistics_.area += twice / 2;
      for (const Vec3 p : {triangle.a, triangle.b, triangle.c}) {
        low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
        high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), std::max(high_.z, p.z)};
      }
      triangles_.push_back(triangle);
    }
    ++id;
  };
  for (const Mesh& mesh : scene.meshes) add(mesh);
  for (const Mesh& lamp : lifted_light_surfaces(scene, lifts)) add(lamp);
  statistics_.triangles = int64_t(triangles_.size());
  if (triangles_.empty()) return;
  const Vec3 size = high_ - low_;
  const double pad = margin * length(size) + 1e-15 * (length(low_) + length(high_));
  low_ = low_ - Vec3{pad, pad, pad}, high_ = high_ + Vec3{pad, pad, pad};
}

void UniformGrid::choose_cells(double density) {
  const Vec3 size = high_ - low_;
  // A flat scene has one cell across its thin axes: the side of a cell follows from the other axes alone.
  const double wanted = density * double(triangles_.size());
  std::array<int, 3> axes{0, 1, 2};
  std::sort(axes.begin(), axes.end(), [&](int i, int j) { return component(size, i) < component(size, j); });
  double side = 0;
  for (int skipped = 0; skipped < 3; ++skipped) {
    double volume = 1;
    for (int i = skipped; i < 3; ++i) volume *= component(size, axes[size_t(i)]);
    side = std::pow(volume / wanted, 1.0 / (3 - skipped));
    if (component(size, axes[size_t(skipped)]) >= side) break;
  }
  int64_t cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    counts_[axis] = int(std::clamp(std::round(component(size, axis) / side), 1.0, most_across));
    sides_[axis] = component(size, axis) / counts_[axis];
    cells *= counts_[axis];
  }
  statistics_.cells = cells;
  statistics_.cell_x = sides_[0], statistics_.cell_y = sides_[1], statistics_.cell_z = sides_[2];
  statistics_.width = size.x, statistics_.height = size.y, statistics_.depth = size.z;
}

/// Calls visit(cell) for every cell that a triangle touches; cells are slightly enlarged for the test.
template <class Visit>
void UniformGrid::for_each_cell(const Triangle& triangle, const Visit& visit) const {
  int first[3], last[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double p = component(triangle.a, axis), q = component(triangle.b, axis), r = component(triangle.c, axis);
    const double low = component(low_, axis);
    const auto cell = [&](double place) {
      return int(std::clamp(std::floor((place - low) / sides_[axis]), 0.0, double(counts_[axis] - 1)));
    };
    const double slack = 2 * margin * sides_[axis];
    first[axis] = cell(std::min({p, q, r}) - slack);
    last[axis] = cell(std::max({p, q, r}) + slack);
  }
  const bool is_one = first[0] == last[0] && first[1] == last[1] && first[2] == last[2];
  const double half = 0.5 + 2 * margin;
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) {
        const Vec3 centre = low_ + Vec3{(i + 0.5) * sides_[0], (j + 0.5) * sides_[1], (k + 0.5) * sides_[2]};
        if (is_one || touches(triangle.a - centre, triangle.b - centre, triangle.c - centre,
                              Vec3{sides_[0], sides_[1], sides_[2]} * half))
          visit((uint64_t(k) * uint64_t(counts_[1]) + uint64_t(j)) * uint64_t(counts_[0]) + uint64_t(i));
      }
}

// Counts the triangles of each cell, then lists them: a counting sort.
void UniformGrid::fill_cells() {
  const size_t cells = size_t(statistics_.cells);
  require_memory(double(cells) * (sizeof(uint64_t) + sizeof(uint32_t)), fmt::format("a grid of {} cells", cells));
  std::vector<std::atomic<uint32_t>> sizes(cells);
  const int64_t count = int64_t(triangles_.size());
  const auto for_each_triangle = [&](const auto& work) {
    parallel_for(0, (count + block_size - 1) / block_size, [&](int64_t b) {
      for (int64_t i = b * block_size; i < std::min(count, (b + 1) * block_size); ++i)
        for_each_cell(triangles_[size_t(i)], [&](uint64_t cell) { work(uint32_t(i), size_t(cell)); });
    });
  };
  for_each_triangle([&](uint32_t, size_t cell) { sizes[cell].fetch_add(1, std::memory_order_relaxed); });
  starts_.resize(cells + 1);
  starts_[0] = 0;
  for (size_t i = 0; i < cells; ++i) starts_[i + 1] = starts_[i] + sizes[i];
  statistics_.entries = int64_t(starts_.back());
  require_memory(double(starts_.back()) * sizeof(uint32_t), fmt::format("{} triangles in cells", starts_.back()));
  entries_.resize(starts_.back());
  for_each_triangle([&](uint32_t triangle, size_t cell) {
    entries_[starts_[cell] + sizes[cell].fetch_sub(1, std::memory_order_relaxed) - 1] = triangle;
  });
  // The order of the entries depends on the threads: sort them.
  parallel_for(0, (int64_t(cells) + block_size - 1) / block_size, [&](int64_t b) {
    for (size_t i = size_t(b * block_size); i < std::min(cells, size_t((b + 1) * block_size)); ++i)
      std::sort(entries_.begin() + int64_t(starts_[i]), entries_.begin() + int64_t(starts_[i + 1]));
  });
}

template <bool any>
bool UniformGrid::walk(const Ray& ray, double limit, GridHit& hit, GridCounts* counts) const {
  if (counts) ++counts->rays;
  if (triangles_.empty()) return false;
  // The part of the ray inside the box.
  double enter = 0, leave = limit;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = component(ray.origin, axis), d = component(ray.direction, axis);
    const double low = component(low_, axis), high = component(high_, axis);
    if (d == 0) {
      if (o < low || o > high) return false;
      continue;
    }
    const double p = (low - o) / d, q = (high - o) / d;
    enter = std::max(enter, std::min(p, q));
    leave = std::min(leave, std::max(p, q));
  }
  if (!(enter <= leave)) return false;

  // Distance to the next cell along each axis, computed from the cell's faces so that rounding does not accumulate.
  int cell[3], step[3];
  double next[3];
  const auto distance_to_next = [&](int axis) {
    const double plane = component(low_, axis) + (cell[axis] + (step[axis] > 0)) * sides_[axis];
    return (plane - component(ray.origin, axis)) / component(ray.direction, axis);
  };
  for (int axis = 0; axis < 3; ++axis) {
    const double d = component(ray.direction, axis);
    const double place = component(ray.origin, axis) + d * enter - component(low_, axis);
    cell[axis] = int(std::clamp(std::floor(place / sides_[axis]), 0.0, double(counts_[axis] - 1)));
    step[axis] = d > 0 ? 1 : d < 0 ? -1 : 0;
    next[axis] = step[axis] == 0 ? infinity : distance_to_next(axis);
  }
  const uint64_t strides[3] = {1, uint64_t(counts_[0]), uint64_t(counts_[0]) * uint64_t(counts_[1])};
  const ShearedRay sheared(ray);
  bool has_hit = false;
  double nearest = limit;
  uint32_t nearest_index = 0;
  while (true) {
    const uint64_t at = uint64_t(cell[0]) + uint64_t(cell[1]) * strides[1] + uint64_t(cell[2]) * strides[2];
    if (counts) ++counts->cells, counts->tests += int64_t(starts_[at + 1] - starts_[at]);
    for (uint64_t e = starts_[at]; e < starts_[at + 1]; ++e) {
      const uint32_t index = entries_[e];
      const Triangle& triangle = triangles_[index];
      Meeting met;
      if (!meets(sheared, {triangle.a, triangle.b, triangle.c}, nearest, met)) continue;
      if constexpr (any) return true;
      if (has_hit && met.distance == nearest && index >= nearest_index) continue;
      has_hit = true;
      nearest = met.distance, nearest_index = index;
      hit = {met.distance, triangle.mesh, triangle.triangle, met.b1, met.b2};
    }
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    if (std::min(nearest, leave) < next[axis]) break;
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] >= counts_[axis]) break;
    next[axis] = distance_to_next(axis);
  }
  return has_hit;
}

bool UniformGrid::closest_hit(const Ray& ray, double limit, GridHit& hit, GridCounts* counts) const {
  return walk<false>(ray, limit, hit, counts);
}

bool UniformGrid::is_occluded(const Ray& ray, double limit, GridCounts* counts) const {
  GridHit hit;
  return walk<true>(ray, limit, hit, counts);
}

}  // namespace holotrace
