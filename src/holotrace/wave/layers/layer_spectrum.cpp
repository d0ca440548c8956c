#include "holotrace/wave/layers/layer_spectrum.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holotrace/base/complex_product.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/base/wrapped.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

constexpr int block = 8;  // columns of each sign transformed together, to use whole cache lines

// factors[l] = exp(−2πi·distance·lag[l]) within 2e-7, written so that compilers vectorise it. The cycle is
// reduced to ±1/2 in double; Taylor series of half the angle reach a float's precision in ±π/2.
void free_space_factors(const double* lag, double distance, int count, Complex* factors) {
  constexpr double whole = 0x1.8p52;  // adding and subtracting it rounds to the nearest whole number
  for (int l = 0; l < count; ++l) {
    const double cycles = -distance * lag[l];
    const float a = float((cycles - ((cycles + whole) - whole)) * pi), a2 = a * a;
    const float s =
        a * (1 + a2 * (-1.f / 6 + a2 * (1.f / 120 + a2 * (-1.f / 5040 + a2 * (1.f / 362880 - a2 / 39916800.f)))));
    const float c =
        1 + a2 * (-1.f / 2 +
                  a2 * (1.f / 24 + a2 * (-1.f / 720 + a2 * (1.f / 40320 + a2 * (-1.f / 3628800 + a2 / 479001600.f)))));
    factors[l] = {1 - 2 * s * s, 2 * s * c};
  }
}

// Adds a transformed column of ny samples, times factors of |l|, to one column of a spectrum, l = −L … L. If the
// raster's Nyquist frequency lies at both ends of the band, it is added once.
void gain(Complex* column, int reach, const Complex* transformed, int ny, const Complex* factors, int count) {
  column[reach] += product(transformed[0], factors[0]);
  for (int l = 1; l < count; ++l) column[reach + l] += product(transformed[l], factors[l]);
  const int negative = 2 * (count - 1) == ny ? count - 1 : count;
  for (int l = 1; l < negative; ++l) column[reach - l] += product(transformed[ny - l], factors[l]);
}

}  // namespace

LayerSpectrum make_layer_spectrum(const Grid& panel, double wavelength, int nx, int ny, int reach_x, int reach_y) {
  LayerSpectrum s{panel, wavelength, nx, ny, reach_x, reach_y, {}, {}, {}};
  s.values = Array2D<Complex>(2 * reach_x + 1, 2 * reach_y + 1);
  s.lag = Array2D<double>(reach_x + 1, reach_y + 1);
  s.inverse_cosine = Array2D<float>(reach_x + 1, reach_y + 1);
  const double k = 1 / wavelength;
  parallel_for(0, reach_x + 1, [&](int64_t i) {
    for (int j = 0; j <= reach_y; ++j) {
      const double u = s.u(int(i)), v = s.v(j), q = u * u + v * v, w2 = k * k - q;
      if (w2 <= 0) continue;
      const double w = std::sqrt(w2);
      s.lag(int(i), j) = q / (k + w);  // k − w without cancellation
      s.inverse_cosine(int(i), j) = float(k / w);
    }
  });
  return s;
}

double layer_spectrum_bytes(int reach_x, int reach_y) {
  const double quarter = (reach_x + 1.0) * (reach_y + 1.0);
  return quarter * (4 * sizeof(Complex) + sizeof(double) + sizeof(float));
}

void add_light(LayerSpectrum& spectrum, SliceSamples&& samples, const AxisWeights& along_x, const AxisWeights& along_y,
               const AddedLight& light) {
  const int nx = samples.nx, ny = samples.ny, rows = int(samples.rows.size());
  const int band_x = int(along_x.size()), band_y = int(along_y.size());
  const Fft<float> transform_x(nx, FftDirection::forward), transform_y(ny, FftDirection::forward);
  parallel_for(0, rows, [&](int64_t j) { transform_x(samples.values.row(int(j))); });

  parallel_for(0, (band_x + block - 1) / block, [&](int64_t b) {
    const int first = int(b) * block, count = std::min(block, band_x - first);
    AlignedVector<Complex> columns(size_t(ny) * block), factors(size_t(band_y) * block);
    for (int c = 0; c < count; ++c) {
      const int k = first + c;
      Complex* f = factors.data() + size_t(c) * size_t(band_y);
      free_space_factors(spectrum.lag.row(k), light.distance, band_y, f);
      const float* inverse_cosine = spectrum.inverse_cosine.row(k);
      const float scale_x = float(light.scale) * along_x[size_t(k)];
      for (int l = 0; l < band_y; ++l)
        f[l] *= scale_x * along_y[size_t(l)] * (light.is_of_points ? inverse_cosine[l] : float(inverse_cosine[l] > 0));
    }
    for (const int sign : {1, -1}) {
      std::fill(columns.begin(), columns.end(), Complex());
      for (int j = 0; j < rows; ++j) {
        const Complex* row = samples.values.row(j);
        for (int c = 0; c < count; ++c)
          columns[size_t(c) * size_t(ny) + size_t(samples.rows[size_t(j)])] =
              row[sign > 0 ? first + c : (nx - first - c) % nx];
      }
      for (int c = 0; c < count; ++c) {
        const int k = first + c;
        if (sign < 0 && (k == 0 || 2 * k == nx)) continue;
        Complex* column = columns.data() + size_t(c) * size_t(ny);
        transform_y(column);
        gain(spectrum.values.row(spectrum.reach_x + sign * k), spectrum.reach_y, column, ny,
             factors.data() + size_t(c) * size_t(band_y), band_y);
      }
    }
  });
}

void carry(LayerSpectrum& spectrum, double distance) {
  const int reach = spectrum.reach_y;
  parallel_for(0, 2 * spectrum.reach_x + 1, [&](int64_t i) {
    AlignedVector<Complex> factors(size_t(reach) + 1);
    free_space_factors(spectrum.lag.row(std::abs(int(i) - spectrum.reach_x)), distance, reach + 1, factors.data());
    Complex* column = spectrum.values.row(int(i));
    for (int l = -reach; l <= reach; ++l) column[reach + l] = product(column[reach + l], factors[size_t(std::abs(l))]);
  });
}

Array2D<Complex> samples_of(const LayerSpectrum& spectrum, int columns, int rows) {
  const int nx = spectrum.nx, ny = spectrum.ny, width = 2 * spectrum.reach_x + 1;
  const Fft<float> transform_x(nx, FftDirection::backward), transform_y(ny, FftDirection::backward);

  // Along y, each frequency k by itself; only the rows needed are kept.
  Array2D<Complex> half(rows, width);
  parallel_for(0, (width + block - 1) / block, [&](int64_t b) {
    const int first = int(b) * block, count = std::min(block, width - first);
    AlignedVector<Complex> lines(size_t(ny) * block);
    for (int c = 0; c < count; ++c) {
      Complex* line = lines.data() + size_t(c) * size_t(ny);
      const Complex* column = spectrum.values.row(first + c);
      for (int l = -spectrum.reach_y; l <= spectrum.reach_y; ++l) line[wrapped(l, ny)] += column[spectrum.reach_y + l];
      transform_y(line);
    }
    for (int j = 0; j < rows; ++j)
      for (int c = 0; c < count; ++c) half(j, first + c) = lines[size_t(c) * size_t(ny) + size_t(j)];
  });

  Array2D<Complex> samples(rows, columns);
  constexpr int grain = 16;  // rows per buffer
  parallel_for(0, (rows + grain - 1) / grain, [&](int64_t b) {
    AlignedVector<Complex> line(static_cast<size_t>(nx));
    for (int j = int(b) * grain; j < std::min(rows, int(b + 1) * grain); ++j) {
      std::fill(line.begin(), line.end(), Complex());
      for (int i = 0; i < width; ++i) line[size_t(wrapped(i - spectrum.reach_x, nx))] += half(j, i);
      transform_x(line.data());
      std::copy_n(line.begin(), columns, samples.row(j));
    }
  });
  return samples;
}

void hide(LayerSpectrum& spectrum, const Array2D<float>& mask, int column, int row, const AxisWeights& along_x,
          const AxisWeights& along_y) {
  const int nx = spectrum.nx, ny = spectrum.ny;
  SliceSamples light{nx, ny, {}, samples_of(spectrum, nx, ny)};
  for (int j = 0; j < mask.ny; ++j) {
    Complex* samples = light.values.row(wrapped(row + j, ny));
    for (int i = 0; i < mask.nx; ++i) samples[wrapped(column + i, nx)] *= 1 - mask(j, i);
  }
  for (int j = 0; j < ny; ++j) light.rows.push_back(j);
  std::fill(spectrum.values.values.begin(), spectrum.values.values.end(), Complex());
  add_light(spectrum, std::move(light), along_x, along_y, {.scale = 1.0 / (double(nx) * ny)});
}

}  // namespace holotrace
