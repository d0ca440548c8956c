#include "holotrace/view/diffraction_limit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/grid.h"

namespace holotrace {

void limit_to_pupil(Image& picture, double pitch, double wavelength, double distance, double diameter) {
  check_wavelength(wavelength);
  require(picture.channels >= 1 && picture.nx > 0 && picture.ny > 0, "expected a picture with pixels");
  require(pitch > 0 && distance > 0 && diameter > 0,
          "expected a pitch, a distance and a diameter of a pupil above 0 m, got {}, {} and {} m", pitch, distance,
          diameter);
  const double cutoff = diameter / (wavelength * distance) * pitch;  // [cycles per pixel]
  // Beyond three Airy radii hardly any light is left; edges are continued by reflection that far.
  const auto rim = [&](int count) { return std::min(count, int(std::ceil(3 * 1.22 / cutoff))); };
  const auto length = [&](int count) { return fft_good_length(count + 2 * rim(count)); };
  const int left = rim(picture.nx), top = rim(picture.ny), nx = length(picture.nx), ny = length(picture.ny);
  const auto reflected = [](int i, int count) {
    const int inside = ((i % (2 * count)) + 2 * count) % (2 * count);
    return inside < count ? inside : 2 * count - 1 - inside;
  };
  Array2D<std::complex<float>> wide(ny, nx);
  for (int c = 0; c < picture.channels; ++c) {
    parallel_for(0, ny, [&](int64_t j) {
      for (int i = 0; i < nx; ++i)
        wide(int(j), i) = picture(reflected(int(j) - top, picture.ny), reflected(i - left, picture.nx), c);
    });
    fft_2d(wide.values.data(), ny, nx, FftDirection::forward);
    parallel_for(0, ny, [&](int64_t j) {
      const double v = std::abs(double(signed_frequency(int(j), ny))) / ny;
      for (int i = 0; i < nx; ++i) {
        const double u = std::hypot(double(signed_frequency(i, nx)) / nx, v) / cutoff;
        const double h = u < 1 ? 2 / pi * (std::acos(u) - u * std::sqrt((1 - u) * (1 + u))) : 0;
        wide(int(j), i) *= float(h / (double(nx) * ny));
      }
    });
    fft_2d(wide.values.data(), ny, nx, FftDirection::backward);
    for (int j = 0; j < picture.ny; ++j)
      for (int i = 0; i < picture.nx; ++i) picture(j, i, c) = std::max(0.0F, wide(top + j, left + i).real());
  }
}

}  // namespace holotrace
