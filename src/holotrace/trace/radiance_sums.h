#pragma once

#include <utility>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// Weighted sums of radiance at the pixels of one picture, which become means: L = Σ w·L / Σ w.
struct RadianceSums {
  Image light;                 ///< Σ w·L, three channels
  std::vector<float> weights;  ///< Σ w

  explicit RadianceSums(const Grid& grid) : light(grid.ny, grid.nx, 3), weights(size_t(grid.pixels())) {
    light.pitch = grid.pitch;
    light.centre_x = grid.centre_x;
    light.centre_y = grid.centre_y;
  }

  void add(size_t pixel, const float weight, const float* radiance) {
    for (size_t channel = 0; channel < 3; ++channel) light.values[3 * pixel + channel] += weight * radiance[channel];
    weights[pixel] += weight;
  }
};

/// The means of a picture. A pixel without weight gets the mean over the smallest square of at most 7 × 7 pixels around
/// it that has some; 0 if there is none.
Image means_by_pixel(RadianceSums&& sums);

/// The means of the pictures of columns × rows cells, row by row. A pixel without weight gets the mean of the same
/// pixel over the smallest square of cells around its own that has some; 0 if there is none.
std::vector<Image> means_by_cell(std::vector<RadianceSums>&& sums, int columns, int rows);

}  // namespace holotrace
