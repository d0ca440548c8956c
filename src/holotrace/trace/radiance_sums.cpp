#include "holotrace/trace/radiance_sums.h"

#include <algorithm>

#include "holotrace/base/threads.h"

namespace holotrace {

namespace {

struct WeightedLight {
  Vec3 light;
  double weight = 0;

  void add(const RadianceSums& sums, size_t pixel) {
    const float* values = &sums.light.values[3 * pixel];
    light += {values[0], values[1], values[2]};
    weight += sums.weights[pixel];
  }
  Vec3 mean() const { return weight > 0 ? light / weight : Vec3{}; }
};

/// Calls add(row, column) for the places of a square of `radius` around (row, column), within rows × columns.
template <class Add>
void for_square(int row, int column, int radius, Vec2 size, const Add& add) {
  for (int j = std::max(0, row - radius); j <= std::min(int(size.y) - 1, row + radius); ++j)
    for (int i = std::max(0, column - radius); i <= std::min(int(size.x) - 1, column + radius); ++i) add(j, i);
}

void set(Image& image, size_t pixel, Vec3 value) {
  image.values[3 * pixel] = float(value.x);
  image.values[3 * pixel + 1] = float(value.y);
  image.values[3 * pixel + 2] = float(value.z);
}

}  // namespace

Image means_by_pixel(RadianceSums&& sums) {
  constexpr int largest_radius = 3;
  const int nx = sums.light.nx, ny = sums.light.ny;
  Image means = sums.light;
  parallel_for(0, ny, [&](int64_t row) {
    for (int column = 0; column < nx; ++column) {
      WeightedLight sum;
      for (int radius = 0; radius <= largest_radius && !(sum.weight > 0); ++radius)
        for_square(int(row), column, radius, {double(nx), double(ny)},
                   [&](int j, int i) { sum.add(sums, size_t(j) * size_t(nx) + size_t(i)); });
      set(means, size_t(row) * size_t(nx) + size_t(column), sum.mean());
    }
  });
  return means;
}

std::vector<Image> means_by_cell(std::vector<RadianceSums>&& sums, int columns, int rows) {
  const int64_t pixels = int64_t(sums.front().weights.size());
  const int largest_radius = std::max(columns, rows);
  const auto find_means = [&](int64_t first, int64_t last) {
    std::vector<Vec3> means(sums.size());
    for (size_t pixel = size_t(first); pixel < size_t(last); ++pixel) {
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
          WeightedLight sum;
          for (int radius = 0; radius <= largest_radius && !(sum.weight > 0); ++radius)
            for_square(row, column, radius, {double(columns), double(rows)},
                       [&](int j, int i) { sum.add(sums[size_t(j * columns + i)], pixel); });
          means[size_t(row * columns + column)] = sum.mean();
        }
      for (size_t cell = 0; cell < sums.size(); ++cell) set(sums[cell].light, pixel, means[cell]);
    }
  };
  constexpr int64_t block = 1024;
  parallel_for(0, (pixels + block - 1) / block,
               [&](int64_t i) { find_means(i * block, std::min(pixels, (i + 1) * block)); });
  std::vector<Image> images;
  for (RadianceSums& sum : sums) {
    sum.weights = {};
    images.push_back(std::move(sum.light));
  }
  return images;
}

}  // namespace holotrace
