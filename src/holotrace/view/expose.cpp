#include "holotrace/view/expose.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"

namespace holotrace {

Image expose(const Field& field, const CameraParams& params, const Observer& observer) {
  const Grid& grid = field.grid;
  check_grid(grid);
  const int n = std::max(params.binning, 1);
  require(params.binning >= 0 && n <= std::min(grid.nx, grid.ny),
          "expected a binning of 1 to {} samples, the side of the field, or 0 for 1, got {}",
          std::min(grid.nx, grid.ny), params.binning);
  Image image(grid.ny / n, grid.nx / n, 1);
  image.pitch = n * grid.pitch;
  const int spare_x = grid.nx % n, spare_y = grid.ny % n;
  image.centre_x = grid.centre_x - (spare_x % 2) * grid.pitch / 2;
  image.centre_y = grid.centre_y + (spare_y % 2) * grid.pitch / 2;
  if (spare_x || spare_y)
    observer.warn(
        fmt::format("the field of {} × {} samples does not divide into bins of {}: {} columns and {} rows at "
                    "its border are left out",
                    grid.nx, grid.ny, n, spare_x, spare_y));

  const int left = spare_x / 2, top = spare_y / 2;
  const auto expose_row = [&](int64_t row) {
    for (int column = 0; column < image.nx; ++column) {
      double sum = 0;
      for (int j = 0; j < n; ++j) {
        const std::complex<float>* u = field.samples.row(top + int(row) * n + j) + left + column * n;
        for (int i = 0; i < n; ++i) sum += std::norm(std::complex<double>(u[i]));
      }
      image(int(row), column) = float(sum / (double(n) * n));
    }
  };
  parallel_for(0, image.ny, expose_row, observer, 16);
  return image;
}

double exposure_white(const Image& image, double exposure) {
  require(std::isfinite(exposure) && exposure >= 0,
          "expected an exposure above 0 W/m², or 0 for the 99.9th percentile, got {}", exposure);
  if (exposure > 0) return exposure;
  require(!image.values.empty(), "expected an image with pixels, got an empty one");
  std::vector<float> values = image.values;
  const auto nearest_rank = values.begin() + std::ptrdiff_t(std::ceil(0.999 * double(values.size()))) - 1;
  std::nth_element(values.begin(), nearest_rank, values.end());
  if (*nearest_rank > 0) return *nearest_rank;
  const float brightest = *std::max_element(values.begin(), values.end());
  return brightest > 0 ? brightest : 1;
}

}  // namespace holotrace
