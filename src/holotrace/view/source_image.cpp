#include "holotrace/view/source_image.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/base/threads.h"

namespace holotrace {

namespace {

// Directions in the disc at (a + 1/2, b + 1/2)·step from its middle, for integers a and b. All parts of a source use
// the same directions, and each direction belongs to one part. The shares of the parts therefore sum to exactly 1.
struct DiscLattice {
  double radius = 0;  // radius of the disc, in steps
  double step = 0;    // [rad]

  // The directions in row b have −n ≤ a < n.
  int64_t half_row(int64_t b) const {
    const double y = double(b) + 0.5;
    return std::abs(y) > radius ? 0 : std::llround(std::sqrt((radius - y) * (radius + y)));
  }
  int64_t half_rows() const { return std::llround(radius); }
  double directions() const {
    double all = 0;
    for (int64_t b = -half_rows(); b < half_rows(); ++b) all += 2 * double(half_row(b));
    return all;
  }
};

// With a whole number of steps per sample, the sum of linear weights is even inside the picture. At least 4 steps per
// sample resolve the rim of a large picture; at least 64·√N steps across the disc resolve the parts of a small one.
DiscLattice lattice_of(const SourcePart& part, double samples_per_angle) {
  const double samples = part.angle * samples_per_angle;  // samples across the disc
  const double per_sample = std::max(4.0, std::ceil(64 * std::sqrt(double(part.count())) / samples));
  return {samples * per_sample / 2, 1 / (samples_per_angle * per_sample)};
}

}  // namespace

Array2D<float> source_image(const SourcePart& part, double z, double pitch, int reach) {
  const int side = 2 * reach + 1;
  Array2D<float> kernel(side, side);
  const double to_samples = z / pitch;  // samples per radian
  // A picture of 1e-9 samples counts as a point.
  if (reach == 0 || part.angle * std::abs(to_samples) < 1e-9) {
    kernel(reach, reach) = 1;
    return kernel;
  }
  const DiscLattice lattice = lattice_of(part, std::abs(to_samples));
  const double x0 = part.place()[0], y0 = part.place()[1];
  const auto angle_of = [&](int64_t n) { return (double(n) + 0.5) * lattice.step; };
  // Largest distance of a direction of the part from its point, in steps.
  const double around = (reach + 1) / (std::abs(to_samples) * lattice.step);
  const auto first = [&](double place) { return int64_t(std::floor(place / lattice.step - around)); };
  const auto last = [&](double place) { return int64_t(std::ceil(place / lattice.step + around)); };
  const double scale = double(part.count()) / lattice.directions();
  parallel_for(0, side, [&](int64_t row) {
    std::vector<double> line(size_t(side), 0.0);
    const int64_t top = std::min(lattice.half_rows(), last(y0));
    for (int64_t b = std::max(-lattice.half_rows(), first(y0)); b < top; ++b) {
      const double y = angle_of(b), place = std::clamp(reach - (y - y0) * to_samples, 0.0, side - 1.0);
      const double weight = 1 - std::abs(place - double(row));
      if (weight <= 0) continue;
      const int64_t half = lattice.half_row(b), end = std::min(half, last(x0));
      for (int64_t a = std::max(-half, first(x0)); a < end; ++a) {
        const double x = angle_of(a);
        if (!part.is_nearest(x, y)) continue;
        const double column = std::clamp(reach + (x - x0) * to_samples, 0.0, side - 1.0);
        const int left = std::min(int(column), side - 2);
        line[size_t(left)] += weight * (left + 1 - column);
        line[size_t(left) + 1] += weight * (column - left);
      }
    }
    for (int i = 0; i < side; ++i) kernel(int(row), i) = float(line[size_t(i)] * scale);
  });
  return kernel;
}

Array2D<float> convolved(const Array2D<float>& values, const Array2D<float>& kernel) {
  require(kernel.ny % 2 == 1 && kernel.nx % 2 == 1 && kernel.ny <= values.ny && kernel.nx <= values.nx,
          "expected a kernel of odd sides within {} × {} samples, got {} × {}", values.nx, values.ny, kernel.nx,
          kernel.ny);
  using Complex = std::complex<float>;
  const int ny = fft_good_length(values.ny), nx = fft_good_length(values.nx);
  const size_t count = size_t(ny) * size_t(nx);
  LargeBuffer<Complex> light(count), weights(count);
  std::fill_n(light.data(), count, Complex());
  std::fill_n(weights.data(), count, Complex());
  for (int j = 0; j < values.ny; ++j)
    for (int i = 0; i < values.nx; ++i) light.data()[size_t(j) * size_t(nx) + size_t(i)] = values(j, i);
  for (int j = 0; j < kernel.ny; ++j)
    for (int i = 0; i < kernel.nx; ++i) {
      const int y = (j - kernel.ny / 2 + ny) % ny, x = (i - kernel.nx / 2 + nx) % nx;
      weights.data()[size_t(y) * size_t(nx) + size_t(x)] = kernel(j, i);
    }
  fft_2d(light.data(), ny, nx, FftDirection::forward);
  fft_2d(weights.data(), ny, nx, FftDirection::forward);
  const float scale = float(1 / double(count));
  parallel_for(0, int64_t(count), [&](int64_t n) { light.data()[n] *= weights.data()[n] * scale; });
  fft_2d(light.data(), ny, nx, FftDirection::backward);
  Array2D<float> out(values.ny, values.nx);
  for (int j = 0; j < values.ny; ++j)  // rounding may leave values a little below 0
    for (int i = 0; i < values.nx; ++i)
      out(j, i) = std::max(0.0F, light.data()[size_t(j) * size_t(nx) + size_t(i)].real());
  return out;
}

double convolved_bytes(int ny, int nx) {
  return 2.0 * sizeof(std::complex<float>) * fft_good_length(ny) * fft_good_length(nx) + 4.0 * ny * nx;
}

}  // namespace holotrace
