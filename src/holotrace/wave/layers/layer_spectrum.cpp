#include "holotrace/wave/layers/layer_spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"

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

namespace {

constexpr double extension = 1.25;       // over the sine of the Nyquist angle
constexpr double edge_deviation = 0.56;  // of a taper's Gaussian, over √(λd)
constexpr double ringing_margin = 2;     // over √(λd): most of the light that a sharp band edge sends beyond its box
constexpr double box_edge = 0.5;         // width of a taper that ends at the box, over √(λd)
constexpr double most_of_band = 0.25;    // that such a taper takes near the panel, where nothing rings
constexpr double most_sine = 0.99;

double taper_width(double depth, double wavelength, double steepness) {
  return 2 * std::sqrt(2.0) * steepness * edge_deviation * std::sqrt(wavelength * depth);
}

double frequency_of(double offset, double depth, double wavelength) {
  return offset / (wavelength * std::hypot(offset, depth));
}

// Largest offset of light in a taper along its axis: more than `end` for light oblique along the other axis too.
double reach_of(const Taper& taper, const Taper& other, double depth, double wavelength, double pitch) {
  if (depth == 0) return 0;
  const double radius = box_radius(depth, wavelength, pitch);
  const auto end_of = [&](const Taper& t) { return std::isfinite(t.end) ? t.end : radius; };
  const double margin = std::isfinite(taper.end) ? 0 : ringing_margin * std::sqrt(wavelength * depth);
  return end_of(taper) * std::hypot(1.0, end_of(other) / depth) + margin;
}

int window_length(double samples, int least) {
  require(
      samples < 1e6,
      "expected a window of slices of less than a million samples along each axis, got {:.3g}; move the scene closer "
      "to the panel's axis, or closer to the panel",
      samples);
  return fft_good_length(std::max(int(std::ceil(samples)), least));
}

}  // namespace

double taper_steepness(double tolerance) { return std::sqrt(1.25 * std::log(2 / std::clamp(tolerance, 1e-8, 0.1))); }

Taper taper_of_points(const SliceLight& slice) {
  const auto& [depth, wavelength, pitch, span, radius, steepness, is_carried] = slice;
  const double width = taper_width(depth, wavelength, steepness);
  const double sine = std::min(extension * wavelength / (2 * pitch), most_sine);
  const bool is_narrowed = radius < box_radius(depth, wavelength, pitch) && span > radius;
  const double limit = is_carried || is_narrowed ? radius : depth * sine / std::sqrt(1 - sine * sine);
  if (span + width <= limit) return is_carried ? Taper{limit - width, limit} : Taper{span, span + width};
  if (!is_carried && span < std::min(radius, limit)) return {span, limit};
  const double end = std::min(radius, limit);
  return {end - std::min(box_edge * std::sqrt(wavelength * depth), most_of_band * end), end};
}

Taper taper_of_raster(const SliceLight& slice) {
  const auto& [depth, wavelength, pitch, span, radius, steepness, is_carried] = slice;
  const double width = taper_width(depth, wavelength, steepness), whole = box_radius(depth, wavelength, pitch);
  if (span + width < radius) return is_carried ? Taper{radius - width, radius} : Taper{span, span + width};
  // As wide below the border as above it, so that the power stays that of the cone.
  const double half = std::min({box_edge / 2 * std::sqrt(wavelength * depth), most_of_band * radius, whole - radius});
  if (radius < whole) return {radius - half, radius + half};
  return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
}

LayerWindow plan_window(const std::vector<PlannedSlice>& slices, const Grid& panel, double wavelength) {
  double width = 0, height = 0, highest_u = 0, highest_v = 0;
  const double nyquist = 1 / (2 * panel.pitch);
  const auto highest = [&](const Taper& taper, double depth) {
    return std::isfinite(taper.end) ? frequency_of(taper.end, depth, wavelength) : nyquist;
  };
  for (const PlannedSlice& s : slices) {
    width = std::max(width, s.span_x + reach_of(s.x, s.y, std::abs(s.depth), wavelength, panel.pitch));
    height = std::max(height, s.span_y + reach_of(s.y, s.x, std::abs(s.depth), wavelength, panel.pitch));
    highest_u = std::max(highest_u, highest(s.x, s.depth));
    highest_v = std::max(highest_v, highest(s.y, s.depth));
  }
  LayerWindow w;
  w.nx = window_length(width / panel.pitch, panel.nx);
  w.ny = window_length(height / panel.pitch, panel.ny);
  const auto reach = [&](double frequency, int samples) {
    return frequency >= nyquist * (1 - 1e-9) && frequency <= nyquist * (1 + 1e-9)
               ? samples / 2
               : int(frequency * samples * panel.pitch);
  };
  w.reach_x = reach(highest_u, w.nx), w.reach_y = reach(highest_v, w.ny);
  return w;
}

AxisWeights taper_weights(const Taper& taper, double depth, double wavelength, double side, double steepness,
                          int most) {
  if (!std::isfinite(taper.end)) return AxisWeights(size_t(most), 1.f);
  const double pass = frequency_of(taper.pass, depth, wavelength), end = frequency_of(taper.end, depth, wavelength);
  AxisWeights weights;
  for (int k = 0; k < most && k / side <= end; ++k) {
    const double t = (k / side - pass) / (end - pass);
    weights.push_back(t <= 0 ? 1.f : float(std::erfc(steepness * (2 * t - 1)) / 2));
  }
  return weights;
}

}  // namespace holotrace
