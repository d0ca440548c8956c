#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace holotrace {

/// What a texture shows beyond its borders: itself again, its mirror image, or its outermost pixels.
enum class ImageEdge : uint8_t { repeat, mirror, clamp };

/// How a texture is read between its pixels and beyond its borders.
struct ImageSampling {
  ImageEdge edge_u = ImageEdge::repeat, edge_v = ImageEdge::repeat;  ///< along columns and rows
  bool is_stepped = false;                                           ///< pixels are even, not interpolated
  auto operator<=>(const ImageSampling&) const = default;
};

/// An image of linear light, row 0 on top: values[(row·nx + column)·channels + channel].
/// Channels are 1 (monochrome) or 3 (red, green, blue). [W/m²] on a sensor, [W/m²/sr] from `render`.
struct Image {
  int nx = 0, ny = 0, channels = 1;
  double pitch =
      0;  ///< side of a pixel [m], on the sensor, or of a render beside a view in the plane in focus; 0: unknown
  double centre_x = 0, centre_y = 0;  ///< centre of a sensor [m]
  ImageSampling sampling{};           ///< of a texture
  std::vector<float> values;

  Image() = default;
  Image(int ny, int nx, int channels)
      : nx(nx), ny(ny), channels(channels), values(size_t(nx) * size_t(ny) * size_t(channels)) {}

  float& operator()(int row, int column, int channel = 0) {
    return values[(size_t(row) * size_t(nx) + size_t(column)) * size_t(channels) + size_t(channel)];
  }
  const float& operator()(int row, int column, int channel = 0) const {
    return values[(size_t(row) * size_t(nx) + size_t(column)) * size_t(channels) + size_t(channel)];
  }
};

}  // namespace holotrace
