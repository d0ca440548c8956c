#include "holotrace/view/source_image.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"

namespace holotrace {

Array2D<float> source_image(const SourcePart& part, double z, double pitch, int reach) {
  const int side = 2 * reach + 1;
  Array2D<float> kernel(side, side);
  if (reach == 0 || z == 0) {
    kernel(reach, reach) = 1;
    return kernel;
  }
  // Directions per sample and axis: some 64 along the radius of a small picture, and 4 of a large one.
  const int parts = std::clamp(64 / reach, 4, 32);
  const double step = pitch / z;
  parallel_for(0, side, [&](int64_t row) {
    for (int column = 0; column < side; ++column) {
      int inside = 0;
      for (int b = 0; b < parts; ++b)
        for (int a = 0; a < parts; ++a) {
          const double right = column - reach + (a + 0.5) / parts - 0.5;
          const double up = reach - double(row) + (b + 0.5) / parts - 0.5;
          inside += part.holds(right * step, up * step);
        }
      kernel(int(row), column) = float(inside);
    }
  });
  const double radius = part.angle / 2 / std::abs(step);  // in samples
  double all = pi * radius * radius * parts * parts / double(part.count());
  if (part.count() == 1) all = std::accumulate(kernel.values.begin(), kernel.values.end(), 0.0);
  require(all > 0, "expected a source image of at least a sample, got one of {:.3g}", radius);
  for (float& weight : kernel.values) weight = float(double(weight) / all);
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
  for (int j = 0; j < values.ny; ++j)  // rounding may leave dark places a little below 0
    for (int i = 0; i < values.nx; ++i)
      out(j, i) = std::max(0.0F, light.data()[size_t(j) * size_t(nx) + size_t(i)].real());
  return out;
}

double convolved_bytes(int ny, int nx) {
  return 2.0 * sizeof(std::complex<float>) * fft_good_length(ny) * fft_good_length(nx) + 4.0 * ny * nx;
}

}  // namespace holotrace
