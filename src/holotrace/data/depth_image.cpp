#include "holotrace/data/depth_image.h"

#include <cmath>

#include "holotrace/base/error.h"

namespace holotrace {

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
  bool has_light = false;
  for (size_t i = 0; i < image.depth.size(); ++i) {
    const float depth = image.depth.values[i];
    require(std::isfinite(depth) && depth >= 0,
            "expected depths of 0 m (nothing there) or more, got {} m at row {}, column {}", depth,
            i / size_t(picture.nx), i % size_t(picture.nx));
    has_light = has_light || depth > 0;
  }
  require(has_light, "expected a pixel with a depth above 0 m, got none");
}

}  // namespace holotrace
