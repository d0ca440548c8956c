#include "holotrace/slm/encode/device_low_pass.h"

#include <complex>
#include <utility>
#include <vector>

#include "holotrace/slm/encode/device_moments.h"
#include "holotrace/slm/encode/low_pass_lines.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

// The spectrum of a field within a stop, times `unit`: column by column, each with the frequencies of y that pass. There is
// room for ny of them, and as much again.
struct Spectrum {
  DeviceField bins;
  DeviceBuffer room;
  float unit = 1;
};

DeviceBuffer room_for(Device& device, const Grid& grid, const PassBand& passing) {
  return device.make_buffer(size_t(passing.x.count) * size_t(grid.ny) * sizeof(Complex), "a stop");
}

Spectrum spectrum_of(const ShownPixels<DeviceField>& shown, const PassBand& passing, LineTransforms& lines) {
  Device& device = *shown.field.device;
  const Grid& grid = shown.field.head.grid;
  const auto& [x, y] = passing;
  Spectrum spectrum;
  spectrum.unit = unit_for(shown.moments.largest);
  const DeviceBuffer scales = device.upload(std::vector<Complex>(size_t(grid.nx), spectrum.unit), "a stop");
  spectrum.bins = {&device, {}, room_for(device, grid, passing)};
  spectrum.bins.head.grid.nx = y.count;
  spectrum.bins.head.grid.ny = x.count;
  spectrum.room = room_for(device, grid, passing);
  const DeviceBuffer& rows = spectrum.bins.samples;  // until they are transposed
  lines.run(rows_to_spectrum(grid, passing, scales), grid.ny, shown.field.samples, rows);
  lines.transpose(grid.ny, x.count, rows, spectrum.room);
  lines.run(columns_to_spectrum(grid, passing), x.count, spectrum.room, spectrum.bins.samples);
  device.finish();  // before the scales are released
  return spectrum;
}

double part_of_power(const ShownPixels<DeviceField>& shown, const Spectrum& spectrum) {
  const DeviceField& bins = spectrum.bins;
  const double inside = energy(bins, {0, bins.head.grid.nx, 0, bins.head.grid.ny});
  return part_of_power(inside, shown.moments, double(spectrum.unit), shown.field.head.grid);
}

constexpr double bytes_of_bin = sizeof(Complex);

}  // namespace

ScaledField within_stop(const ShownPixels<DeviceField>& shown, const SpectralFilter& stop, const Observer& observer) {
  Device& device = *shown.field.device;
  const auto lock = device.lock();
  const Grid& grid = shown.field.head.grid;
  const PassBand passing = pass_band(grid, stop);
  const int columns = passing.x.count;
  LineTransforms lines(device);
  const Spectrum spectrum = spectrum_of(shown, passing, lines);
  observer.fact("band_power", Fact(part_of_power(shown, spectrum)));
  // The transforms do not scale: there and back, they multiply by the number of samples.
  ScaledField inside{make_device_field(device, shown.field.head, "a field within a stop"),
                     double(spectrum.unit) * double(grid.pixels())};
  lines.run(columns_from_spectrum(grid, passing), columns, spectrum.bins.samples, spectrum.room);
  const DeviceBuffer& rows = spectrum.bins.samples;
  lines.transpose(columns, grid.ny, spectrum.room, rows);
  lines.run(rows_from_spectrum(grid, passing), grid.ny, rows, inside.light.samples);
  device.finish();  // before the work space is released
  return inside;
}

double power_inside(const ShownPixels<DeviceField>& shown, const SpectralFilter& filter) {
  const auto lock = shown.field.device->lock();
  LineTransforms lines(*shown.field.device);
  return part_of_power(shown, spectrum_of(shown, pass_band(shown.field.head.grid, filter), lines));
}

LowPassCost low_pass_cost(const Grid& grid, const SpectralFilter& stop) {
  LowPassCost cost = power_inside_cost(grid, stop);
  const double pixels = double(grid.pixels()), columns = pass_band(grid, stop).x.count;
  cost.memory += bytes_of_bin * pixels;
  cost.moved += bytes_of_bin * (pixels + 5 * columns * grid.ny);
  return cost;
}

LowPassCost power_inside_cost(const Grid& grid, const SpectralFilter& filter) {
  const double pixels = double(grid.pixels()), columns = pass_band(grid, filter).x.count;
  LowPassCost cost;
  cost.memory = bytes_of_bin * 2 * columns * grid.ny;
  cost.moved = bytes_of_bin * (pixels + 6 * columns * grid.ny);
  return cost;
}

}  // namespace holotrace
