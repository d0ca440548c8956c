#include "holotrace/data/focal_stack.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {

void check_focal_stack(const FocalStack& stack) {
  check_grid(stack.grid);
  require(!stack.distances.empty(), "expected a focal stack of at least one plane, got none");
  require(stack.pictures.size() == stack.distances.size(),
          "expected a picture for each of the {} planes of the focal stack, got {}", stack.distances.size(),
          stack.pictures.size());
  const int channels = stack.pictures.front().channels;
  require(channels == 1 || channels == 3, "expected a focal stack of 1 or 3 channels, got {}", channels);
  for (size_t k = 0; k < stack.pictures.size(); ++k) {
    require(std::isfinite(stack.distances[k]) && stack.distances[k] != 0,
            "expected plane {} of the focal stack behind the panel or in front of it, got {}", k + 1,
            format_length(stack.distances[k]));
    const Image& picture = stack.pictures[k];
    require(picture.nx == stack.grid.nx && picture.ny == stack.grid.ny && picture.channels == channels &&
                picture.values.size() == size_t(stack.grid.pixels()) * size_t(channels),
            "expected {} x {} pixels and {} channel(s) in plane {} of the focal stack, got {} x {} and {}",
            stack.grid.nx, stack.grid.ny, channels, k + 1, picture.nx, picture.ny, picture.channels);
    for (const float value : picture.values)
      require(std::isfinite(value) && value >= 0,
              "expected finite radiance of 0 or more in plane {} of the focal stack, got {}", k + 1, value);
  }
}

}  // namespace holotrace
