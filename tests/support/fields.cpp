#include "support/fields.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/fft.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"

namespace holotrace::test {

FieldDouble make_field(const Grid& grid, double wavelength,
                       const std::function<std::complex<double>(double, double)>& f) {
  FieldDouble field(grid, wavelength);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) field.samples(j, i) = f(grid.x(i), grid.y(j));
  return field;
}

FieldDouble make_band_limited_noise(const Grid& grid, double wavelength, double band) {
  FieldDouble field(grid, wavelength);
  CounterRandom random(3, 0, 0);
  for (auto& u : field.samples.values) u = std::polar(1.0, 2 * pi * random.uniform());
  fft_2d(field.samples.values.data(), grid.ny, grid.nx, FftDirection::forward);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const double u = std::min(i, grid.nx - i) / grid.width(), v = std::min(j, grid.ny - j) / grid.height();
      field.samples(j, i) *= std::exp(-(u * u + v * v) / (2 * band * band)) / double(grid.pixels());
    }
  fft_2d(field.samples.values.data(), grid.ny, grid.nx, FftDirection::backward);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const double x = 2 * grid.x(i) / grid.width(), y = 2 * grid.y(j) / grid.height();
      field.samples(j, i) *= std::exp(-26 * (x * x + y * y));
    }
  return field;
}

Sources make_random_sources(int count, const Grid& panel, double wavelength, double nearest, double farthest,
                            double margin) {
  Sources sources;
  sources.wavelength = wavelength;
  CounterRandom random(11, 0, 0);
  const double spread = 1 + 2 * margin;
  for (int j = 0; j < count; ++j)
    sources.waves.push_back(
        {{(random.uniform() - 0.5) * spread * panel.width(), (random.uniform() - 0.5) * spread * panel.height(),
          -(nearest + (farthest - nearest) * random.uniform())},
         float(0.5 + random.uniform()),
         float(2 * pi * random.uniform())});
  return sources;
}

namespace {

// The length of the part of the pixel [c − p/2, c + p/2] that lies in [−a, a].
double covered(double c, double p, double a) {
  return std::max(0.0, std::min(c + p / 2, a) - std::max(c - p / 2, -a)) / p;
}

}  // namespace

FieldDouble make_square_aperture(const Grid& grid, double wavelength, double a) {
  return make_field(grid, wavelength,
                    [&](double x, double y) { return covered(x, grid.pitch, a) * covered(y, grid.pitch, a); });
}

FieldDouble make_disc_aperture(const Grid& grid, double wavelength, double a) {
  constexpr int parts = 64;  // strips per pixel; the covered length of a strip is exact
  return make_field(grid, wavelength, [&](double x, double y) {
    const double reach = grid.pitch;
    if (std::hypot(x, y) < a - reach) return 1.0;
    if (std::hypot(x, y) > a + reach) return 0.0;
    double sum = 0;
    for (int s = 0; s < parts; ++s) {
      const double strip = y + ((s + 0.5) / parts - 0.5) * grid.pitch;
      if (std::abs(strip) < a) sum += covered(x, grid.pitch, std::sqrt(a * a - strip * strip));
    }
    return sum / parts;
  });
}

}  // namespace holotrace::test
