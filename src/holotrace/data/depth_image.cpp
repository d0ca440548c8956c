#include "holotrace/data/depth_image.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"

namespace holotrace {

namespace {

// Renderers write 1e10, or the largest number of half precision, 65504, where a ray hits nothing.
constexpr float background_depth = 1e4F;  // [m]

bool has_light(const Image& picture, size_t pixel) {
  const auto* values = picture.values.data() + pixel * size_t(picture.channels);
  return std::any_of(values, values + picture.channels, [](float value) { return value > 0; });
}

}  // namespace

void leave_out_empty_pixels(DepthImage& image) {
  const Image& picture = image.picture;
  if (image.depth.nx != picture.nx || image.depth.ny != picture.ny) return;  // check_depth_image says so
  float deepest = -background_depth;
  for (size_t i = 0; i < image.depth.size(); ++i) {
    float& depth = image.depth.values[i];
    if (!(std::abs(depth) < background_depth)) depth = 0;
    if (depth != 0 && has_light(picture, i)) deepest = std::max(deepest, depth);
  }
  for (size_t i = 0; i < image.depth.size(); ++i)
    if (image.depth.values[i] > deepest && !has_light(picture, i)) image.depth.values[i] = 0;
}

void check_depth_image(const DepthImage& image) {
  const Image& picture = image.picture;
  require(picture.nx > 0 && picture.ny > 0, "expected a picture with pixels, got {} × {}", picture.nx, picture.ny);
  require(image.depth.nx == picture.nx && image.depth.ny == picture.ny,
          "expected a depth for each of {} × {} pixels, got {} × {}; make both pictures one size", picture.nx,
          picture.ny, image.depth.nx, image.depth.ny);
  for (size_t i = 0; i < picture.values.size(); ++i)
    require(std::isfinite(picture.values[i]) && picture.values[i] >= 0,
            "expected light of 0 or more in a picture, got {} at row {}, column {}", picture.values[i],
            i / size_t(picture.channels) / size_t(picture.nx), i / size_t(picture.channels) % size_t(picture.nx));
  bool is_anywhere = false;
  for (size_t i = 0; i < image.depth.size(); ++i) {
    const float depth = image.depth.values[i];
    require(std::isfinite(depth), "expected finite depths, or 0 m (nothing there), got {} m at row {}, column {}",
            depth, i / size_t(picture.nx), i % size_t(picture.nx));
    is_anywhere = is_anywhere || depth != 0;
  }
  require(is_anywhere, "expected a pixel with a depth other than 0 m (nothing there), got none");
}

}  // namespace holotrace
