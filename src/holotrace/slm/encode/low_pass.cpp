#include "holotrace/slm/encode/low_pass.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/fft.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/frequency_band.h"

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
  const FrequencyBand x = band_within(nx, field.grid.width(), stop.half_u),
                      y = band_within(ny, field.grid.height(), stop.half_v);
  parallel_for(0, ny, [&](int64_t j) {
    std::complex<float>* u = inside.samples.row(int(j));
    const bool is_row_in = y.holds(signed_frequency(int(j), ny));
    for (int i = 0; i < nx; ++i) u[i] = is_row_in && x.holds(signed_frequency(i, nx)) ? u[i] * scale : 0;
  });
  fft_2d(inside.samples.values.data(), ny, nx, FftDirection::backward);
  const double all = power(field);
  observer.fact("band_power", Fact(all > 0 ? power(inside) / all : 1.0));
  return inside;
}

double normalise_modulus(double clipped_pixels, const Observer& observer, Field& field) {
  double largest = 0, square = 0;
  for (const auto& u : field.samples.values) {
    largest = std::max(largest, double(std::abs(u)));
    square += double(std::norm(u));
  }
  double top = largest;
  if (clipped_pixels > 0 && largest > 0) {
    std::vector<int64_t> counts(modulus_steps + 1);
    for (const auto& u : field.samples.values) ++counts[size_t(std::abs(u) / largest * modulus_steps)];
    top = modulus_to_clip(counts, largest, clipped_pixels * double(field.samples.size()));
  }
  double clipped = 0;
  for (auto& u : field.samples.values) {
    const double modulus = std::abs(u);
    if (modulus > top) clipped += modulus * modulus - top * top;
    u = modulus > 0 ? std::complex<float>(std::complex<double>(u) / std::max(top, modulus)) : 0;
  }
  tell_clipping(top, square > 0 ? clipped / square : 0, observer);
  return top;
}

double modulus_to_clip(const std::vector<int64_t>& counts, double largest, double clipped_pixels) {
  const int steps = int(counts.size()) - 1;
  int step = steps;
  for (; step > 1 && clipped_pixels >= double(counts[size_t(step)]); --step)
    clipped_pixels -= double(counts[size_t(step)]);
  return std::min(largest * (step + 1.0) / steps, largest);
}

void tell_clipping(double modulus, double clipped_part, const Observer& observer) {
  observer.fact("modulus_max", Fact(modulus));
  observer.fact("clipped_part", Fact(clipped_part));
}

}  // namespace holotrace
