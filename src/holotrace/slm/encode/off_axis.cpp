#include "holotrace/slm/encode/off_axis.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/device_levels.h"
#include "holotrace/slm/encode/interference_kernel.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/panel/pixel_kernel.h"

namespace holotrace {
Vec2 reference_carrier(const EncodeParams& params, const Grid& grid, double wavelength) {
  const double ax = params.reference_angle_x, ay = params.reference_angle_y;
  require(std::isfinite(ax) && std::isfinite(ay) && std::max(std::abs(ax), std::abs(ay)) < pi / 2,
          "expected an off-axis reference tilted by less than 90°, got {} in x, {} in y", format_angle(ax),
          format_angle(ay));
  if (ax == 0 && ay == 0) return {(params.with_bias ? 3.0 : 2.0) / (8 * grid.pitch), 0};
  const Vec2 carrier{std::sin(ax) / wavelength, std::sin(ay) / wavelength};
  const double nyquist = 1 / (2 * grid.pitch);
  require(std::max(std::abs(carrier.x), std::abs(carrier.y)) < nyquist,
          "expected an off-axis reference at an angle below {}, the largest that pixels of {} can represent at {}, got "
          "{} in x, {} in y; use smaller reference angles",
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

namespace {

// The interference of a field with a reference wave of modulus ρ·max|U|, with its bias |U|² + |R|² or without.
struct Interference {
  ReferenceWave wave;
  double reference = 0;
  bool with_bias = true;
};

// The least and the largest irradiance of an interference over the panel [W/m²].
struct IrradianceRange {
  double least = 0, largest = 0;
};

// The level of (irradiance + offset)·scale at each pixel.
struct Transmittances {
  double offset = 0, scale = 1;
};

// Calls visit(row, column, irradiance) for the pixels of all rows, on many threads.
template <class Visit>
void visit_irradiances(const Field& field, const Interference& with, const Visit& visit) {
  using interference_kernel::WaveSample;
  const auto sample_of = [](std::complex<double> u) { return WaveSample{u.real(), u.imag()}; };
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    const WaveSample of_row = sample_of(with.wave.along_y[size_t(j)]);
    const std::complex<float>* u = field.samples.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i) {
      const WaveSample wave = interference_kernel::plane_wave(sample_of(with.wave.along_x[size_t(i)]), of_row);
      visit(int(j), i, interference_kernel::interference(sample_of(u[i]), wave, with.reference, with.with_bias));
    }
  });
}

IrradianceRange irradiance_range(const ShownPixels<Field>& shown, const Interference& interference) {
  constexpr double all = std::numeric_limits<double>::infinity();
  std::vector<IrradianceRange> rows(size_t(shown.field.grid.ny), {all, -all});
  visit_irradiances(shown.field, interference, [&](int j, int, double irradiance) {
    IrradianceRange& row = rows[size_t(j)];
    row = {std::min(row.least, irradiance), std::max(row.largest, irradiance)};
  });
  IrradianceRange range{all, -all};
  for (const IrradianceRange& row : rows)
    range = {std::min(range.least, row.least), std::max(range.largest, row.largest)};
  return range;
}

void write_irradiance_levels(const ShownPixels<Field>& shown, const Interference& interference,
                             const Transmittances& transmittances, int levels, Array2D<uint16_t>& to) {
  const auto [offset, scale] = transmittances;
  visit_irradiances(shown.field, interference, [&, offset = offset, scale = scale](int j, int i, double irradiance) {
    to(j, i) = uint16_t(amplitude_level((irradiance + offset) * scale, levels));
  });
}

// Within 1e-6 of (|U| + |R|)². Transfers: those of each_band and of send_wave; 8 bytes per row come back.
IrradianceRange irradiance_range(const ShownPixels<DeviceSamples>& shown, const Interference& interference) {
  constexpr double none = std::numeric_limits<double>::infinity();
  IrradianceRange range{none, -none};
  each_band(shown.field, [&](const DeviceField& band, int first) {
    Device& device = *band.device;
    const Grid& grid = band.head.grid;
    const WaveThere reference = send_wave(shown, interference.wave, band, first);
    const double unit = double(reference.unit);
    const DeviceBuffer there = device.make_buffer(2 * size_t(grid.ny) * sizeof(float), "the irradiance of rows");
    device.run(kernel_of_pixels("irradiance_ranges"), groups_of_rows(grid.ny),
               {band.samples, int32_t(grid.nx), reference.unit, reference.along_x, reference.along_y,
                float(interference.reference * unit), int32_t(interference.with_bias), there});
    const auto rows = device.fetch<float>(there);
    for (size_t row = 0; row < rows.size(); row += 2)
      range = {std::min(range.least, double(rows[row]) / (unit * unit)),
               std::max(range.largest, double(rows[row + 1]) / (unit * unit))};
  });
  return range;
}

void write_irradiance_levels(const ShownPixels<DeviceSamples>& shown, const Interference& interference,
                             const Transmittances& transmittances, int levels, Array2D<uint16_t>& to) {
  fetch_levels(shown.field, to,
               [&](const DeviceField& band, int first, const WorkSize& size, const DeviceBuffer& there) {
                 const WaveThere reference = send_wave(shown, interference.wave, band, first);
                 const double unit = double(reference.unit);
                 band.device->run(kernel_of_pixels("irradiance_levels"), size,
                                  {band.samples, int32_t(to.nx), reference.unit, reference.along_x, reference.along_y,
                                   float(interference.reference * unit), int32_t(interference.with_bias),
                                   float(transmittances.offset * unit * unit),
                                   float(transmittances.scale / (unit * unit)), int32_t(levels), there});
                 band.device->finish();  // before the wave is released
               });
}

}  // namespace

double power_inside(const ShownPixels<Field>& shown, const SpectralFilter& filter) {
  const Field& field = shown.field;
  const int nx = field.grid.nx, ny = field.grid.ny;
  const FrequencyBand x = band_within(nx, field.grid.width(), filter.half_u),
                      y = band_within(ny, field.grid.height(), filter.half_v);
  Array2D<std::complex<float>> spectrum = field.samples;
  fft_2d(spectrum.values.data(), ny, nx, FftDirection::forward);
  double inside = 0, all = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const double power = std::norm(std::complex<double>(spectrum(j, i)));
      all += power;
      if (x.holds(signed_frequency(i, nx)) && y.holds(signed_frequency(j, ny))) inside += power;
    }
  return all > 0 ? inside / all : 1;
}

template <class AnyField>
void encode_off_axis(const ShownPixels<AnyField>& shown, const EncodeParams& params, const Observer& observer,
                     Hologram& hologram) {
  const Vec2 carrier = reference_carrier(params, hologram.grid, hologram.wavelength);
  const double largest = shown.moments.largest;
  const Interference interference{reference_wave(carrier, hologram.grid, shown.is_conjugate),
                                  params.reference_ratio * largest, params.with_bias};
  const IrradianceRange range = irradiance_range(shown, interference);
  const double offset = params.with_bias ? 0 : -range.least, top = range.largest + offset;
  write_irradiance_levels(shown, interference, {offset, top > 0 ? 1 / top : 0}, hologram.levels, hologram.level);
  hologram.filter = off_axis_filter(carrier, hologram.grid, params.with_bias);
  hologram.illumination = largest > 0 ? std::pow(top / interference.reference, 2) : 0;

  observer.fact("modulus_max", Fact(largest));
  observer.fact("carrier_u", Fact(carrier.x));
  observer.fact("carrier_v", Fact(carrier.y));
  tell_band_power(power_inside(shown, *hologram.filter), hologram, params.with_bias, observer);
}

template void encode_off_axis(const ShownPixels<Field>&, const EncodeParams&, const Observer&, Hologram&);
template void encode_off_axis(const ShownPixels<DeviceSamples>&, const EncodeParams&, const Observer&, Hologram&);

void tell_band_power(double inside, const Hologram& hologram, bool with_bias, const Observer& observer) {
  observer.fact("band_power", Fact(inside));
  const double wavelength = hologram.wavelength;
  if (inside < 0.99)
    observer.warn(fmt::format(
        "the {} hologram keeps {:.3g} % of the field's power; the rest is at angles beyond ±{} in x and ±{} in y, "
        "outside the band of the signal; make the scene narrower{}",
        hologram.encoder, 100 * inside, format_angle(std::asin(std::min(1.0, hologram.filter->half_u * wavelength))),
        format_angle(std::asin(std::min(1.0, hologram.filter->half_v * wavelength))),
        with_bias ? ", or use with_bias = false" : ""));
}

}  // namespace holotrace
