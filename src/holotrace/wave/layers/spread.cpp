#include "holotrace/wave/layers/spread.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/base/wrapped.h"

namespace holotrace {
namespace {

constexpr double oversampling = 1.25;
constexpr int most_width = 12;
constexpr int block_rows = 32;  // rows of the raster that one thread fills

struct Placed {
  int first = 0;      // index of the first sample, not wrapped
  double offset = 0;  // from the point to that sample
};

Placed place(double position, int width) {
  const double first = std::ceil(position - width / 2.0);
  return {int(first), first - position};
}

void kernel_values(const SpreadKernel& kernel, double offset, float* values) {
  for (int m = 0; m < kernel.width; ++m) values[m] = float(kernel.value(offset + m));
}

}  // namespace

SpreadKernel make_spread_kernel(double tolerance) {
  const double digits = std::log(1 / std::max(tolerance, 1e-7)) / (pi * std::sqrt(1 - 1 / oversampling));
  const int width = std::clamp(int(std::ceil(digits + 0.4)), 3, most_width);
  return {width, 0.97 * pi * width * (1 - 1 / (2 * oversampling))};
}

int spread_length(int band, const SpreadKernel& kernel) {
  return fft_good_length(std::max(int(std::ceil(oversampling * (2 * band + 1))), 2 * kernel.width));
}

std::vector<double> spread_correction(const SpreadKernel& kernel, int samples, int band) {
  std::vector<double> correction(size_t(band) + 1);
  parallel_for(0, band + 1, [&](int64_t k) { correction[size_t(k)] = 1 / kernel.moment(0, double(k) / samples); });
  return correction;
}

SliceSamples spread_points(const std::vector<PointOnSlice>& points, const SpreadKernel& kernel, int nx, int ny,
                           int samples_x, int samples_y) {
  const double across = double(samples_x) / nx, down = double(samples_y) / ny;
  // Sorts the points by their first row; points of one row keep their order.
  std::vector<uint32_t> start(size_t(samples_y) + 1), order(points.size());
  const auto first_row = [&](const PointOnSlice& p) {
    return size_t(wrapped(place(p.row * down, kernel.width).first, samples_y));
  };
  for (const PointOnSlice& p : points) ++start[first_row(p) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<uint32_t> next(start.begin(), start.end() - 1);
  for (size_t i = 0; i < points.size(); ++i) order[next[first_row(points[i])]++] = uint32_t(i);

  SliceSamples s{samples_x, samples_y, {}, {}};
  std::vector<int> place_of_row(size_t(samples_y), -1);
  for (int j = 0; j < samples_y; ++j) {
    bool is_lit = false;
    for (int m = 0; m < kernel.width && !is_lit; ++m) {
      const size_t from = size_t(wrapped(j - m, samples_y));
      is_lit = start[from] < start[from + 1];
    }
    if (!is_lit) continue;
    place_of_row[size_t(j)] = int(s.rows.size());
    s.rows.push_back(j);
  }
  s.values = Array2D<std::complex<float>>(int(s.rows.size()), samples_x);

  parallel_for(0, (samples_y + block_rows - 1) / block_rows, [&](int64_t b) {
    const int begin = int(b) * block_rows, end = std::min(begin + block_rows, samples_y);
    float along_x[most_width], along_y[most_width];
    for (int j = begin - kernel.width + 1; j < end; ++j) {
      const size_t from = size_t(wrapped(j, samples_y));
      for (uint32_t n = start[from]; n < start[from + 1]; ++n) {
        const PointOnSlice& p = points[order[n]];
        const Placed x = place(p.column * across, kernel.width), y = place(p.row * down, kernel.width);
        kernel_values(kernel, x.offset, along_x);
        kernel_values(kernel, y.offset, along_y);
        for (int m = std::max(0, begin - j); m < std::min(kernel.width, end - j); ++m) {
          std::complex<float>* row = s.values.row(place_of_row[size_t(j + m)]);
          const std::complex<float> strength = p.strength * along_y[m];
          for (int i = 0, column = wrapped(x.first, samples_x); i < kernel.width; ++i) {
            row[column] += strength * along_x[i];
            if (++column == samples_x) column = 0;
          }
        }
      }
    }
  });
  return s;
}

}  // namespace holotrace
