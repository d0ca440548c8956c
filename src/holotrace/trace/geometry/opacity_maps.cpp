#include "holotrace/trace/geometry/opacity_maps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/trace/shared/texture.h"

namespace holotrace {

namespace {

/// Which rays go through between texels that all have a value, whatever rounding does to their mean.
Passage passage_of(const Material& material, float value) {
  const double opacity = material.opacity * double(value), cutoff = material.opacity_cutoff, rounding = 1e-12;
  if (cutoff > 0) {
    if (opacity < cutoff * (1 - rounding)) return Passage::all;
    return opacity > cutoff * (1 + rounding) ? Passage::none : Passage::depends;
  }
  return opacity <= 0 ? Passage::all : opacity >= 1 ? Passage::none : Passage::depends;
}

using Corners = OpacityMap::Corners;

/// The rectangle of texture coordinates around some.
struct Around {
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};

  void include(Vec2 uv) {
    low = {std::min(low.x, uv.x), std::min(low.y, uv.y)};
    high = {std::max(high.x, uv.x), std::max(high.y, uv.y)};
  }
};

struct HashOfCorners {
  size_t operator()(const Corners& corners) const {
    uint64_t bits = 0;
    for (const auto& [u, v] : corners)
      for (const double number : {u, v}) bits = mix(bits + splitmix_step + std::bit_cast<uint64_t>(number));
    return bits;
  }
};

}  // namespace

OpacitySums::OpacitySums(const Material& material)
    : nx_(material.opacity_texture->nx),
      ny_(material.opacity_texture->ny),
      sampling_(material.opacity_texture->sampling),
      sums_(size_t(nx_ + 1) * size_t(ny_ + 1)) {
  const size_t row = size_t(nx_) + 1;
  for (int j = 0; j < ny_; ++j)
    for (int i = 0; i < nx_; ++i) {
      const Passage passage = passage_of(material, (*material.opacity_texture)(j, i));
      uint32_t* sum = &sums_[size_t(j) * row + size_t(i)];
      sum[row + 1] = sum[row] + sum[1] - sum[0] + (passage == Passage::all ? 0 : passage == Passage::none ? 2 : 1);
    }
}

/// The texels between which coordinates from `from` to `to` may lie, counted in texels without end: each is a mirror image or a
/// copy of one of the texture. Two spans, which may be the same.
std::array<OpacitySums::Span, 2> OpacitySums::spans(double from, double to, int count, ImageEdge edge) {
  constexpr double rounding = 1e-3;
  const auto first = int64_t(std::floor(from - 0.5 - rounding)), last = int64_t(std::floor(to - 0.5 + rounding)) + 1;
  if (edge == ImageEdge::clamp) {
    const Span span{int(std::clamp<int64_t>(first, 0, count - 1)), int(std::clamp<int64_t>(last, 0, count - 1))};
    return {span, span};
  }
  if (last - first >= count) return {Span{0, count - 1}, Span{0, count - 1}};
  const auto copy_of = [&](int64_t texel) { return int64_t(std::floor(double(texel) / count)); };
  const auto in_copy = [&](int64_t copy, int64_t begin, int64_t end) {
    const Span span{int(begin - copy * count), int(end - copy * count)};
    const bool is_mirrored = edge == ImageEdge::mirror && copy % 2 != 0;
    return is_mirrored ? Span{count - 1 - span.last, count - 1 - span.first} : span;
  };
  const int64_t copy = copy_of(first), next = copy_of(last);
  return {in_copy(copy, first, std::min(last, (copy + 1) * count - 1)),
          in_copy(next, std::max(first, next * count), last)};
}

Passage OpacitySums::within(Vec2 low, Vec2 high) const {
  constexpr double farthest = 1e6;  // in textures; beyond, coordinates are rounded too much
  if (!(std::min(low.x, low.y) > -farthest && std::max(high.x, high.y) < farthest)) return Passage::depends;
  bool are_open = true, are_closed = true;
  for (const Span& columns : spans(low.x * nx_, high.x * nx_, nx_, sampling_.edge_u))
    for (const Span& rows : spans((1 - high.y) * ny_, (1 - low.y) * ny_, ny_, sampling_.edge_v)) {
      const auto sum = [&](int j, int i) { return sums_[size_t(j) * (size_t(nx_) + 1) + size_t(i)]; };
      const uint32_t inside = sum(rows.last + 1, columns.last + 1) - sum(rows.last + 1, columns.first) -
                              sum(rows.first, columns.last + 1) + sum(rows.first, columns.first);
      const uint32_t texels = uint32_t(rows.last - rows.first + 1) * uint32_t(columns.last - columns.first + 1);
      are_open = are_open && inside == 0;
      are_closed = are_closed && inside == 2 * texels;
    }
  return are_open ? Passage::all : are_closed ? Passage::none : Passage::depends;
}

OpacityMap::OpacityMap(const Corners& corners, const OpacitySums& sums) : corners_(corners) {
  constexpr double width = 8, most = 32;  // texels of a part, parts
  Around all;
  for (const Vec2& corner : corners) all.include(corner);
  const Vec2 texels = sums.texels(all.high - all.low);
  side_ = std::bit_ceil(size_t(std::min(std::max(texels.x, texels.y) / width, most - 1)) + 1);
  passages_.assign((side_ * side_ + 31) / 32, 0);
  fill(sums, 0, 0, side_);
}

/// Sets the parts of a square of `size` × `size`; those beyond the triangle depend.
void OpacityMap::fill(const OpacitySums& sums, size_t column, size_t row, size_t size) {
  if (column + row >= side_) return;
  Around square;
  for (const size_t i : {column, column + size})
    for (const size_t j : {row, row + size})
      square.include(coordinates_at(double(i) / double(side_), double(j) / double(side_)));
  const Passage passage = sums.within(square.low, square.high);
  if (passage == Passage::depends) {
    const size_t half = size / 2;
    if (half == 0) return;
    for (const size_t j : {row, row + half})
      for (const size_t i : {column, column + half}) fill(sums, i, j, half);
    return;
  }
  for (size_t j = row; j < row + size; ++j)
    for (size_t part = j * side_ + column; part < j * side_ + column + size; ++part)
      passages_[part / 32] |= uint64_t(passage) << 2 * (part % 32);
}

OpacityMaps::OpacityMaps(const Mesh& mesh, const OpacitySums& sums) {
  std::unordered_map<Corners, uint32_t, HashOfCorners> number_of;
  std::vector<Corners> different;
  std::vector<uint32_t> numbers;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Corners corners{mesh.texture_coordinates[i], mesh.texture_coordinates[j], mesh.texture_coordinates[k]};
    const auto [number, is_new] = number_of.emplace(corners, uint32_t(different.size()));
    if (is_new) different.push_back(corners);
    numbers.push_back(number->second);
  }
  constexpr size_t most = 1'000'000;  // triangles that differ: 120 MB
  if (different.size() > most) return;
  maps_.resize(different.size());
  const auto make = [&](int64_t n) { maps_[size_t(n)] = OpacityMap(different[size_t(n)], sums); };
  parallel_for(0, int64_t(maps_.size()), make);

  bits_ = std::bit_ceil(size_t(std::bit_width(maps_.size())));
  mask_ = (uint64_t(1) << bits_) - 1;
  numbers_.resize(numbers.size() * bits_ / 64 + 1);
  for (size_t t = 0; t < numbers.size(); ++t) numbers_[t * bits_ / 64] |= uint64_t(numbers[t]) << t * bits_ % 64;
}

}  // namespace holotrace
