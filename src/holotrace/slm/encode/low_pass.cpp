#include "holotrace/slm/encode/low_pass.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/iterate/iterations.h"

namespace holotrace {

SpectralFilter low_pass_stop(const EncodeParams& params, const Grid& grid) {
  const double half = stop_width(params) / (2 * grid.pitch);
  return {0, 0, half, half};
}

Field within_stop(const Field& field, const SpectralFilter& stop, const Observer& observer) {
  const int nx = field.grid.nx, ny = field.grid.ny;
  Field inside = field;
  fft_2d(inside.samples.values.data(), ny, nx, FftDirection::forward);
  const float scale = 1 / float(field.grid.pixels());
  // An edge that falls on a bin counts as inside, as in apply_order_stop.
  const auto passes = [](int k, int n, double side, double half) {
    return std::abs(signed_frequency(k, n)) / side <= half * (1 + 1e-9);
  };
  parallel_for(0, ny, [&](int64_t j) {
    std::complex<float>* u = inside.samples.row(int(j));
    const bool is_row_in = passes(int(j), ny, field.grid.height(), stop.half_v);
    for (int i = 0; i < nx; ++i) u[i] = is_row_in && passes(i, nx, field.grid.width(), stop.half_u) ? u[i] * scale : 0;
  });
  fft_2d(inside.samples.values.data(), ny, nx, FftDirection::backward);
  const double all = power(field);
  observer.fact("band_power", Fact(all > 0 ? power(inside) / all : 1.0));
  return inside;
}

double normalise_modulus(double clipped_pixels, const Observer& observer, Field& field) {
  constexpr int bins = 4096;
  double largest = 0, square = 0;
  for (const auto& u : field.samples.values) {
    largest = std::max(largest, double(std::abs(u)));
    square += double(std::norm(u));
  }
  double top = largest;
  if (clipped_pixels > 0 && largest > 0) {
    std::vector<int64_t> counts(bins + 1);
    for (const auto& u : field.samples.values) ++counts[size_t(std::abs(u) / largest * bins)];
    double left = clipped_pixels * double(field.samples.size());
    int bin = bins;
    while (bin > 1 && left >= double(counts[size_t(bin)])) left -= double(counts[size_t(bin--)]);
    top = largest * (bin + 1.0) / bins;
    top = std::min(top, largest);
  }
  double clipped = 0;
  for (auto& u : field.samples.values) {
    const double modulus = std::abs(u);
    if (modulus > top) clipped += modulus * modulus - top * top;
    u = modulus > 0 ? std::complex<float>(std::complex<double>(u) / std::max(top, modulus)) : 0;
  }
  observer.fact("modulus_max", Fact(top));
  observer.fact("clipped_part", Fact(square > 0 ? clipped / square : 0.0));
  return top;
}

}  // namespace holotrace
