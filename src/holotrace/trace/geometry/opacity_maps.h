#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/shared/texture.h"

namespace holotrace {

/// Which rays go through a part of a surface.
enum class Passage : uint8_t {
  depends,  ///< on the place, or on the ray
  all,
  none
};

/// Sums over the opacity texture of a material, which answer for any rectangle of texture coordinates. Cost: one pass over the
/// texels, 4 bytes for each.
class OpacitySums {
 public:
  /// @param material  with an opacity texture
  explicit OpacitySums(const Material& material);

  /// Which rays go through wherever the texture coordinates are between two corners. It may say `depends` where that is not so.
  /// Cost: at most 16 sums are read, however large the rectangle.
  Passage within(Vec2 low, Vec2 high) const;

  /// A distance in the texture, in texels.
  Vec2 texels(Vec2 distance) const { return {distance.x * nx_, distance.y * ny_}; }

 private:
  /// The first and last texel of a row or a column.
  struct Span {
    int first, last;
  };
  static std::array<Span, 2> spans(double from, double to, int count, ImageEdge edge);

  int nx_, ny_;
  ImageSampling sampling_;
  std::vector<uint32_t>
      sums_;  // over the texels above and to the left: 0 for one that is open, 2 for a closed one, else 1
};

/// Where a triangle lets all rays through, and where none: an opacity micromap (H. Gruen, C. Benthin, S. Woop, Proc. ACM on Computer
/// Graphics and Interactive Techniques 3(2), 18, 2020). Its barycentric coordinates are divided into n × n parts some 8 texels wide, with
/// n at most 32. Most parts are wholly open or wholly closed, which is known without the texture.
class OpacityMap {
 public:
  using Corners = std::array<Vec2, 3>;  ///< texture coordinates

  OpacityMap() = default;
  OpacityMap(const Corners& corners, const OpacitySums& sums);

  /// Which rays go through at barycentric coordinates. Where it does not depend, `opacity_at` is 0 or 1.
  Passage at(double b1, double b2) const {
    if (!(b1 >= 0 && b1 < 1 && b2 >= 0 && b2 < 1)) return Passage::depends;
    const size_t part = size_t(b2 * double(side_)) * side_ + size_t(b1 * double(side_));
    return Passage(passages_[part / 32] >> 2 * (part % 32) & 3);
  }

  Vec2 coordinates_at(double b1, double b2) const {
    return between_corners(corners_[0], corners_[1], corners_[2], b1, b2);
  }

 private:
  void fill(const OpacitySums& sums, size_t column, size_t row, size_t size);

  Corners corners_{};
  size_t side_ = 1;                                            // n: a power of 2
  std::vector<uint64_t> passages_ = std::vector<uint64_t>(1);  // two bits of each part
};

/// The maps of the triangles of a mesh. Triangles of the same texture coordinates share one, and the numbers of maps are stored in as
/// few bits as they need: those of a tree whose leaves are alike stay in the cache. Memory: some 120 bytes for each map, 350 for one of
/// 32 × 32 parts, and at most 4 for each triangle. A mesh of more than a million different ones has no maps.
class OpacityMaps {
 public:
  OpacityMaps() = default;
  OpacityMaps(const Mesh& mesh, const OpacitySums& sums);

  bool empty() const { return maps_.empty(); }
  const OpacityMap& operator[](uint32_t triangle) const {
    const size_t bit = triangle * bits_;
    return maps_[numbers_[bit / 64] >> bit % 64 & mask_];
  }

 private:
  size_t bits_ = 0;                // of a number: a power of 2
  uint64_t mask_ = 0;              // 2^bits − 1
  std::vector<uint64_t> numbers_;  // of the map of each triangle
  std::vector<OpacityMap> maps_;
};

}  // namespace holotrace
