#pragma once

#include <cmath>

#include "holotrace/base/vec.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// Colour of a texture at (u, v), v up: row 0 of the image is the top, v = 1. Bilinear between
/// pixel centres; beyond [0, 1] the image repeats. One channel gives grey.
inline Vec3 eval_texture(const Image& image, Vec2 uv) {
  const auto wrap = [](double position, int count) {
    const int index = int(position - std::floor(position / count) * count);
    return index < count ? index : 0;  // a position just below a multiple of count rounds up to it
  };
  const auto texel = [&](int row, int column) -> Vec3 {
    if (image.channels < 3) return Vec3{1, 1, 1} * double(image(row, column));
    return {image(row, column, 0), image(row, column, 1), image(row, column, 2)};
  };
  const double x = (uv.x - std::floor(uv.x)) * image.nx - 0.5, y = (1 - (uv.y - std::floor(uv.y))) * image.ny - 0.5;
  const double left = std::floor(x), top = std::floor(y), s = x - left, t = y - top;
  const int column = wrap(left, image.nx), next_column = wrap(left + 1, image.nx);
  const int row = wrap(top, image.ny), next_row = wrap(top + 1, image.ny);
  return (texel(row, column) * (1 - s) + texel(row, next_column) * s) * (1 - t) +
         (texel(next_row, column) * (1 - s) + texel(next_row, next_column) * s) * t;
}

}  // namespace holotrace
