#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// Values in a box, interpolated linearly between the centres of cells, and its majorants.
class MediumGrid {
 public:
  /// @param thickness  of a cell of the value 1, as tentative particles of the densest colour meet it; 0: has no particles
  MediumGrid(const std::optional<MediumBox>& box, const Cells& cells, double thickness)
      : box_(box.value_or(MediumBox{{-1, -1, -1}, {1, 1, 1}})),  // of one cell; none matters
        values_(*cells.values),
        size_{values_.nx, values_.ny / cells.planes, cells.planes} {
    const auto mean_of = [](const std::vector<float>& of) {
      return std::accumulate(of.begin(), of.end(), 0.0) / double(of.size());
    };
    // A ray steps from block to block, and to tentative particles, most of which are not real where densities in a block differ.
    if (!(thickness > 0)) return;
    const double density = mean_of(values_.values);
    for (side_ = 8;; side_ /= 2) {
      set_majorants();
      const double steps_to_none = thickness * (mean_of(majorants_) - density) * side_;
      if (side_ == 2 || !(steps_to_none > 1)) break;
    }
  }

  double at(Vec3 place) const {
    const Vec3 p = in_cells(place) - Vec3{0.5, 0.5, 0.5};
    const double x = std::floor(p.x), y = std::floor(p.y), z = std::floor(p.z);
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      const int i = c & 1, j = c >> 1 & 1, k = c >> 2;
      const double share = std::abs(1 - i - (p.x - x)) * std::abs(1 - j - (p.y - y)) * std::abs(1 - k - (p.z - z));
      if (share > 0) sum += share * value(int(x) + i, int(y) + j, int(z) + k);
    }
    return sum;
  }

  /// Calls visit(from, to, majorant) for the blocks on a part of a ray in their order, until it returns true.
  template <class Visit>
  bool visit_blocks(const Ray& ray, double from, double to, const Visit& visit) const {
    const Vec3 start = in_cells(ray.origin + ray.direction * from) * (1.0 / side_),
               end = in_cells(ray.origin + ray.direction * to) * (1.0 / side_), way = end - start;
    const std::array<double, 3> origin{start.x, start.y, start.z}, step{way.x, way.y, way.z};
    std::array<int, 3> block, direction;
    std::array<double, 3> next, apart;  // where the ray leaves the block along an axis, as a fraction of the way
    for (size_t a = 0; a < 3; ++a) {
      block[a] = std::clamp(int(std::floor(origin[a])), 0, blocks_[a] - 1);
      direction[a] = step[a] > 0 ? 1 : -1;
      const double edge = block[a] + (step[a] > 0 ? 1 : 0);
      next[a] = step[a] != 0 ? (edge - origin[a]) / step[a] : std::numeric_limits<double>::infinity();
      apart[a] = step[a] != 0 ? 1 / std::abs(step[a]) : std::numeric_limits<double>::infinity();
    }
    for (double passed = 0; passed < 1;) {
      const size_t a = size_t(std::min_element(next.begin(), next.end()) - next.begin());
      const double until = std::clamp(next[a], passed, 1.0);
      constexpr double rounding = 1 + 1e-9;  // of interpolation
      const double majorant = double(majorants_[index(block[0], block[1], block[2])]) * rounding;
      if (until > passed && majorant > 0 && visit(from + passed * (to - from), from + until * (to - from), majorant))
        return true;
      passed = until;
      block[a] += direction[a];
      next[a] += apart[a];
      if (block[a] < 0 || block[a] >= blocks_[a]) break;
    }
    return false;
  }

 private:
  void set_majorants() {
    for (size_t a = 0; a < 3; ++a) blocks_[a] = (size_[a] + side_ - 1) / side_;
    majorants_.resize(size_t(blocks_[0]) * size_t(blocks_[1]) * size_t(blocks_[2]));
    for (int k = 0; k < blocks_[2]; ++k)
      for (int j = 0; j < blocks_[1]; ++j)
        for (int i = 0; i < blocks_[0]; ++i) majorants_[index(i, j, k)] = largest_near(i, j, k);
  }

  size_t index(int i, int j, int k) const {
    return (size_t(k) * size_t(blocks_[1]) + size_t(j)) * size_t(blocks_[0]) + size_t(i);
  }

  Vec3 in_cells(Vec3 place) const {
    const Vec3 p = place - box_.low, all = box_.high - box_.low;
    return {p.x / all.x * size_[0], p.y / all.y * size_[1], p.z / all.z * size_[2]};
  }

  double value(int i, int j, int k) const {
    i = std::clamp(i, 0, size_[0] - 1);
    j = std::clamp(j, 0, size_[1] - 1);
    k = std::clamp(k, 0, size_[2] - 1);
    return double(values_(k * size_[1] + j, i));
  }

  /// The largest value that the interpolation in a block uses: one cell more on every side.
  float largest_near(int i, int j, int k) const {
    double largest = 0;
    for (int z = side_ * k - 1; z <= side_ * (k + 1); ++z)
      for (int y = side_ * j - 1; y <= side_ * (j + 1); ++y)
        for (int x = side_ * i - 1; x <= side_ * (i + 1); ++x) largest = std::max(largest, value(x, y, z));
    return float(largest);
  }

  MediumBox box_;
  const Image& values_;
  std::array<int, 3> size_, blocks_{};
  int side_ = 8;  // of a block, in cells
  std::vector<float> majorants_;
};

}  // namespace holotrace
