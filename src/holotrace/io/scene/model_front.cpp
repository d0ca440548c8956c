#include "holotrace/io/scene/model_front.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "holotrace/base/array.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

constexpr int side = 192;  // pixels of a picture

// The surface nearest to the viewer at each pixel.
struct NormalPicture {
  Array2D<float> depth{side, side};
  Array2D<Vec3> normal{side, side};

  // Draws a triangle whose corners are in pixels.
  void draw(const std::array<Vec3, 3>& corners) {
    const auto& [a, b, c] = corners;
    const Vec3 across = cross(b - a, c - a);
    if (across.z == 0) return;
    Vec3 facing = normalize(across);
    if (facing.z < 0) facing = facing * -1.0;
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [low, high] = std::minmax({a.y, b.y, c.y});
    for (int row = std::max(0, int(std::ceil(low))); row <= std::min(side - 1, int(high)); ++row)
      for (int column = std::max(0, int(std::ceil(left))); column <= std::min(side - 1, int(right)); ++column) {
        const Vec3 at{double(column), double(row), 0};
        const auto part = [&](Vec3 p, Vec3 q) { return cross(q - p, at - p).z / across.z; };  // of the third corner
        const double u = part(b, c), v = part(c, a), w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        const auto z = float(u * a.z + v * b.z + w * c.z);
        if (z <= depth(row, column)) continue;
        depth(row, column) = z;
        normal(row, column) = facing;
      }
  }

  double detail() const {
    double sum = 0;
    const auto add = [&](int row, int column, int next_row, int next_column) {
      const bool is_here = std::isfinite(depth(row, column)), is_next = std::isfinite(depth(next_row, next_column));
      if (!is_here && !is_next) return;
      const double nearest = std::max(depth(row, column), depth(next_row, next_column));
      const double weight =
          1 + nearest / (side / 2.0);  // 2 at the nearest place that a model can have, 0 at the farthest
      if (is_here != is_next)
        sum += weight;
      else
        sum += weight * std::min(1.0, length(normal(row, column) - normal(next_row, next_column)));
    };
    for (int row = 0; row + 1 < side; ++row)
      for (int column = 0; column + 1 < side; ++column) {
        add(row, column, row, column + 1);
        add(row, column, row + 1, column);
      }
    return sum;
  }
};

double detail_of(const std::vector<Mesh>& meshes, const Frame& view, Vec3 middle, double pixels_per_metre) {
  NormalPicture picture;
  std::fill(picture.depth.values.begin(), picture.depth.values.end(), -std::numeric_limits<float>::infinity());
  const auto seen = [&](Vec3 p) {
    return transform_vector(view, p - middle) * pixels_per_metre + Vec3{side / 2.0, side / 2.0, 0};
  };
  for (const Mesh& mesh : meshes)
    for (const auto& [a, b, c] : mesh.triangles)
      picture.draw({seen(mesh.positions[a]), seen(mesh.positions[b]), seen(mesh.positions[c])});
  return picture.detail();
}

}  // namespace

double turn_that_shows_most(const std::vector<Mesh>& meshes, const std::vector<double>& turns, const Frame& view) {
  Vec3 low = meshes.front().positions.front(), high = low;
  for (const Mesh& mesh : meshes)
    for (const Vec3 p : mesh.positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  const double scale = side / length(high - low);
  std::vector<double> details(turns.size());
  parallel_for(0, int64_t(turns.size()), [&](int64_t i) {
    details[size_t(i)] = detail_of(meshes, compose(view, rotation_y(turns[size_t(i)])), (low + high) * 0.5, scale);
  });
  size_t best = 0;
  for (size_t i = 1; i < turns.size(); ++i)
    if (details[i] > 1.01 * details[best]) best = i;
  return turns[best];
}

}  // namespace holotrace
