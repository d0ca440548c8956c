#include "holotrace/view/expose.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

// Weights of the samples −2 … n + 1 about a pixel along an axis: each of its n cells depends on five of them.
std::vector<double> weights_of_integral(int n) {
  constexpr double a = 0.0684, b = -0.0087;  // see mean_over_pixels
  constexpr double cell[] = {b, a, 1 - 2 * a - 2 * b, a, b};
  static_assert(std::size(cell) == 2 * integration_rim + 1);
  std::vector<double> weights(size_t(n) + 2 * integration_rim);
  for (size_t k = 0; k < size_t(n); ++k)
    for (size_t i = 0; i < std::size(cell); ++i) weights[k + i] += cell[i];
  return weights;
}

// Percentile (nearest rank) of the means over blocks of 8 × 8 pixels, of all channels together.
double percentile_of_blocks(const Image& image, double part) {
  constexpr int side = 8;
  std::vector<double> means;
  for (int top = 0; top < image.ny; top += side)
    for (int left = 0; left < image.nx; left += side)
      for (int channel = 0; channel < image.channels; ++channel) {
        const int rows = std::min(side, image.ny - top), columns = std::min(side, image.nx - left);
        double sum = 0;
        for (int j = 0; j < rows; ++j)
          for (int i = 0; i < columns; ++i) sum += image(top + j, left + i, channel);
        means.push_back(sum / (rows * columns));
      }
  const auto nearest_rank = means.begin() + std::ptrdiff_t(std::ceil(part * double(means.size()))) - 1;
  std::nth_element(means.begin(), nearest_rank, means.end());
  return *nearest_rank;
}

// The level above which that part of the light lies, by bisection. Values that are on one side of all levels to come are
// counted together.
double level_of_clipped_light(const Image& image, double part) {
  double light = 0, high = 0, low = 0;
  std::vector<float> between;
  between.reserve(image.values.size());
  for (const float value : image.values) {
    if (!(value > 0)) continue;
    light += double(value);
    high = std::max(high, double(value));
    between.push_back(value);
  }
  double sum = 0, count = 0;               // of values above `high`
  for (int step = 0; step < 24; ++step) {  // to the precision of a float
    const double level = (low + high) / 2;
    double above = sum - count * level;
    for (const float value : between) above += std::max(0.0, double(value) - level);
    const bool is_low = above > part * light;
    (is_low ? low : high) = level;
    if (!is_low)
      for (const float value : between)
        if (double(value) > level) {
          sum += double(value);
          ++count;
        }
    std::erase_if(between, [&](float value) { return (double(value) > level) != is_low; });
  }
  return high;
}

}  // namespace

PixelSums pixel_sums(int ny, int nx, int n, int rim, bool is_integrated) {
  const int beyond = is_integrated ? integration_rim : 0;
  require(n >= 1 && rim >= beyond, "expected pixels of 1 sample or more and a rim of {}, got {} and {}", beyond, n,
          rim);
  PixelSums sums{(ny - 2 * rim) / n, (nx - 2 * rim) / n, n, rim - beyond};
  sums.weights = is_integrated ? weights_of_integral(n) : std::vector<double>(size_t(n), 1);
  sums.across = sums.columns > 0 ? (sums.columns - 1) * n + int(sums.weights.size()) : 0;
  return sums;
}

Image mean_over_pixels(const Array2D<float>& values, int n, int rim, bool is_integrated, const Observer& observer) {
  const PixelSums sums = pixel_sums(values.ny, values.nx, n, rim, is_integrated);
  const std::vector<double>& weights = sums.weights;
  const size_t across = size_t(sums.across);
  Image image(sums.rows, sums.columns, 1);
  // First down each column of samples, then across the pixels.
  const auto read_row = [&](int64_t row) {
    std::vector<double> line(across);
    for (size_t j = 0; j < weights.size(); ++j) {
      const float* from = values.row(sums.first + int(row) * n + int(j)) + sums.first;
      for (size_t i = 0; i < across; ++i) line[i] += weights[j] * double(from[i]);
    }
    for (int column = 0; column < image.nx; ++column) {
      double sum = 0;
      for (size_t i = 0; i < weights.size(); ++i) sum += weights[i] * line[size_t(column) * size_t(n) + i];
      image(int(row), column) = float(std::max(0.0, sum / (double(n) * n)));
    }
  };
  parallel_for(0, image.ny, read_row, observer, 16);
  return image;
}

double exposure_white(const Image& image, double exposure) {
  require(std::isfinite(exposure) && exposure >= 0,
          "expected an exposure above 0 W/m², or 0 for the automatic one, got {}", exposure);
  if (exposure > 0) return exposure;
  require(!image.values.empty(), "expected an image with pixels, got an empty one");
  const double white = std::max(1.25 * percentile_of_blocks(image, 0.999), level_of_clipped_light(image, 0.1));
  return white > 0 ? white : 1;
}

}  // namespace holotrace
