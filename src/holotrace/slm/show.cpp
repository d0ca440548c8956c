#include "holotrace/slm/show.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/checks.h"
#include "holotrace/slm/pixel_kernel.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

// One row or column of pixels → the same on n samples per pixel: its spectrum, repeated n times, times the
// aperture's. The pattern is separable, so rows and then columns make the panel.
class PixelLine {
 public:
  PixelLine(int pixels, int subpixels, double lit_fraction)
      : pixels_(pixels),
        samples_(pixels * subpixels),
        forward_(pixels, FftDirection::forward),
        backward_(samples_, FftDirection::backward),
        weights_(size_t(samples_)) {
    for (int k = 0; k < samples_; ++k) {
      const int f = signed_frequency(k, samples_);
      // Sample s of the line stands (s − (n−1)/2)/n pixels from the centre of pixel 0.
      const double shift = -pi * f * (subpixels - 1.0) / samples_;
      std::complex<double> weight = aperture_spectrum(double(f) / pixels, lit_fraction) * std::polar(1.0, shift);
      if (2 * f == -samples_) weight = subpixels % 2 ? weight.real() : 0.0;  // the mean of both signs
      weights_[size_t(k)] = Complex(weight / double(pixels));
    }
  }

  int samples() const { return samples_; }

  // `line` holds `pixels` values and is overwritten; `out` takes `samples` values.
  void operator()(Complex* line, Complex* out) const {
    forward_(line);
    for (int k = 0; k < samples_; ++k) out[k] = line[k % pixels_] * weights_[size_t(k)];
    backward_(out);
  }

 private:
  int pixels_, samples_;
  Fft<float> forward_, backward_;
  AlignedVector<Complex> weights_;
};

void check_hologram(const Hologram& hologram, const Slm& slm) {
  check_levels(hologram.levels);
  check_wavelength(hologram.wavelength);
  require_grid_of(slm, hologram.grid, "hologram");
  require(hologram.level.nx == hologram.grid.nx && hologram.level.ny == hologram.grid.ny,
          "expected {} × {} levels, as the hologram's grid says, got {} × {}", hologram.grid.nx, hologram.grid.ny,
          hologram.level.nx, hologram.level.ny);
  for (int j = 0; j < hologram.grid.ny; ++j)
    for (int i = 0; i < hologram.grid.nx; ++i)
      require(hologram.level(j, i) < hologram.levels, "expected levels below {}, got {} at row {}, column {}",
              hologram.levels, hologram.level(j, i), j, i);
}

AlignedVector<Complex> transmittances(const Hologram& hologram, double stretch, double amplitude) {
  AlignedVector<Complex> table(size_t(hologram.levels));
  for (int level = 0; level < hologram.levels; ++level) {
    const Transmittance t = hologram.modulation == Modulation::phase
                                ? phase_transmittance(level, hologram.levels, stretch)
                                : amplitude_transmittance(level, hologram.levels);
    table[size_t(level)] = Complex(float(amplitude * t.real), float(amplitude * t.imaginary));
  }
  return table;
}

Array2D<Complex> spread_rows(const Hologram& hologram, const AlignedVector<Complex>& table, const PixelLine& line) {
  Array2D<Complex> out(hologram.grid.ny, line.samples());
  parallel_for(0, hologram.grid.ny, [&](int64_t j) {
    AlignedVector<Complex> pixels(size_t(hologram.grid.nx));
    const uint16_t* level = hologram.level.row(int(j));
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = table[level[i]];
    line(pixels.data(), out.row(int(j)));
  });
  return out;
}

void spread_columns(const Array2D<Complex>& rows, const PixelLine& line, const Observer& observer,
                    Array2D<Complex>& out) {
  constexpr int block = 16;  // columns that lie together in memory, so that it is read by cache lines
  const auto work = [&](int64_t b) {
    const int first = int(b) * block, count = std::min(block, rows.nx - first);
    const size_t length = size_t(line.samples());
    AlignedVector<Complex> pixels(size_t(count) * size_t(rows.ny)), samples(size_t(count) * length);
    for (int j = 0; j < rows.ny; ++j)
      for (int c = 0; c < count; ++c) pixels[size_t(c) * size_t(rows.ny) + size_t(j)] = rows(j, first + c);
    for (int c = 0; c < count; ++c) line(&pixels[size_t(c) * size_t(rows.ny)], &samples[size_t(c) * length]);
    for (size_t j = 0; j < length; ++j)
      for (int c = 0; c < count; ++c) out(int(j), first + c) = samples[size_t(c) * length + j];
  };
  parallel_for(0, (rows.nx + block - 1) / block, work, observer);
}

}  // namespace

Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const Observer& observer) {
  check_slm(slm);
  check_hologram(hologram, slm);
  const int n = params.subpixels;
  require(n >= 1, "expected at least 1 sample per pixel, got {}", n);
  require(std::isfinite(params.irradiance) && params.irradiance >= 0,
          "expected an irradiance of 0 W/m² or more on the panel, got {} W/m²", params.irradiance);
  const double wavelength = params.wavelength == 0 ? hologram.wavelength : params.wavelength;
  check_wavelength(wavelength);
  const Grid& panel = slm.grid;
  require_memory(8.0 * double(panel.pixels()) * n * (n + 1.0),
                 fmt::format("a panel of {} × {} pixels at {} samples per pixel and axis", panel.nx, panel.ny, n));
  if (hologram.levels > slm.levels)
    observer.warn(fmt::format("the hologram has {} levels and the SLM \"{}\" {}: it is shown as if it had {}",
                              hologram.levels, slm.name, slm.levels, hologram.levels));

  const double design = slm.design_wavelength > 0 ? slm.design_wavelength : hologram.wavelength;
  const AlignedVector<Complex> table = transmittances(hologram, design / wavelength, std::sqrt(params.irradiance));
  const double lit_fraction = std::sqrt(slm.fill_factor);
  const PixelLine row(panel.nx, n, lit_fraction), column(panel.ny, n, lit_fraction);

  Field field({n * panel.nx, n * panel.ny, panel.pitch / n}, wavelength);
  spread_columns(spread_rows(hologram, table, row), column, observer, field.samples);
  field.image = hologram.image;
  field.filter = hologram.filter;

  const double power_in = params.irradiance * panel.width() * panel.height(), power_out = power(field);
  observer.fact("power_in", Fact(power_in));
  observer.fact("power_out", Fact(power_out));
  observer.fact("efficiency", Fact(power_in > 0 ? power_out / power_in : 0.0));
  return field;
}

}  // namespace holotrace
