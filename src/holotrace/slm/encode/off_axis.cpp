#include "holotrace/slm/encode/off_axis.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/panel/pixel_kernel.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"

namespace holotrace {
namespace {

// Fraction of the power of U in the band |u| ≤ half_u, |v| ≤ half_v.
double power_inside(const Field& field, const SpectralFilter& filter) {
  const int nx = field.grid.nx, ny = field.grid.ny;
  Array2D<std::complex<float>> spectrum = field.samples;
  fft_2d(spectrum.values.data(), ny, nx, FftDirection::forward);
  double inside = 0, all = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const double u = signed_frequency(i, nx) / field.grid.width(), v = signed_frequency(j, ny) / field.grid.height();
      const double power = std::norm(std::complex<double>(spectrum(j, i)));
      all += power;
      if (std::abs(u) <= filter.half_u && std::abs(v) <= filter.half_v) inside += power;
    }
  return all > 0 ? inside / all : 1;
}

}  // namespace

Vec2 reference_carrier(const EncodeParams& params, const Grid& grid, double wavelength) {
  const double ax = params.reference_angle_x, ay = params.reference_angle_y;
  require(std::isfinite(ax) && std::isfinite(ay) && std::max(std::abs(ax), std::abs(ay)) < pi / 2,
          "expected an off-axis reference tilted by less than 90°, got {} in x, {} in y", format_angle(ax),
          format_angle(ay));
  if (ax == 0 && ay == 0) return {(params.with_bias ? 3.0 : 2.0) / (8 * grid.pitch), 0};
  const Vec2 carrier{std::sin(ax) / wavelength, std::sin(ay) / wavelength};
  const double nyquist = 1 / (2 * grid.pitch);
  require(std::max(std::abs(carrier.x), std::abs(carrier.y)) < nyquist,
          "expected an off-axis reference below {}, the steepest that pixels of {} hold at {}, got {} in x, {} in y",
          format_angle(std::asin(std::min(1.0, nyquist * wavelength))), format_length(grid.pitch),
          format_length(wavelength), format_angle(ax), format_angle(ay));
  return carrier;
}

SpectralFilter off_axis_filter(Vec2 carrier, const Grid& grid, bool with_bias) {
  const double nyquist = 1 / (2 * grid.pitch);
  const auto half_width = [&](double f, double panel_side) {
    const double to_bias = with_bias ? f / 3 : std::max(f / 3, f - 1 / panel_side);
    return std::min(to_bias, nyquist - f);
  };
  const double fx = std::abs(carrier.x), fy = std::abs(carrier.y);
  if (fx >= fy) return {-carrier.x, -carrier.y, half_width(fx, grid.width()), nyquist};
  return {-carrier.x, -carrier.y, nyquist, half_width(fy, grid.height())};
}

void encode_off_axis(const Field& field, const EncodeParams& params, const Observer& observer, Hologram& hologram) {
  const Grid& grid = field.grid;
  const Vec2 carrier = reference_carrier(params, grid, field.wavelength);
  const SpectralFilter filter = off_axis_filter(carrier, grid, params.with_bias);

  double largest = 0;
  for (const auto& u : field.samples.values) largest = std::max(largest, std::abs(std::complex<double>(u)));
  const double reference = params.reference_ratio * largest;

  Array2D<double> irradiance(grid.ny, grid.nx);
  std::vector<double> row_min(size_t(grid.ny)), row_max(size_t(grid.ny));
  parallel_for(0, grid.ny, [&](int64_t j) {
    const double y_cycles = carrier.y * grid.y(double(j));
    double* out = irradiance.row(int(j));
    for (int i = 0; i < grid.nx; ++i) {
      const std::complex<double> u(field.samples(int(j), i));
      const double cycles = carrier.x * grid.x(i) + y_cycles;
      const std::complex<double> r = reference * cis_cycles(cycles);
      const double interference = 2 * (u * std::conj(r)).real();
      out[i] = params.with_bias ? std::norm(u) + reference * reference + interference : interference;
    }
    const auto [low, high] = std::minmax_element(out, out + grid.nx);
    row_min[size_t(j)] = *low;
    row_max[size_t(j)] = *high;
  });
  const double offset = params.with_bias ? 0 : -*std::min_element(row_min.begin(), row_min.end());
  const double top = *std::max_element(row_max.begin(), row_max.end()) + offset;
  const double scale = top > 0 ? 1 / top : 0;
  parallel_for(0, grid.ny, [&](int64_t j) {
    for (int i = 0; i < grid.nx; ++i)
      hologram.level(int(j), i) = uint16_t(amplitude_level((irradiance(int(j), i) + offset) * scale, hologram.levels));
  });
  hologram.filter = filter;
  hologram.illumination = reference > 0 ? std::pow(top / reference, 2) : 0;

  observer.fact("modulus_max", Fact(largest));
  observer.fact("carrier_u", Fact(carrier.x));
  observer.fact("carrier_v", Fact(carrier.y));
  tell_band_power(field, filter, params.with_bias, "off-axis", observer);
}

void tell_band_power(const Field& field, const SpectralFilter& filter, bool with_bias, const char* encoder,
                     const Observer& observer) {
  const double inside = power_inside(field, filter);
  observer.fact("band_power", Fact(inside));
  if (inside < 0.99)
    observer.warn(fmt::format(
        "the {} hologram keeps {:.3g} % of the field's power: the rest lies beyond ±{} in x, ±{} in y, where the "
        "other terms of the interference or the panel's Nyquist limit are; narrow the scene{}",
        encoder, 100 * inside, format_angle(std::asin(std::min(1.0, filter.half_u * field.wavelength))),
        format_angle(std::asin(std::min(1.0, filter.half_v * field.wavelength))),
        with_bias ? " or leave the bias terms out" : ""));
}

}  // namespace holotrace
