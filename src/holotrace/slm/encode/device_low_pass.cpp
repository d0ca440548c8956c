#include "holotrace/slm/encode/device_low_pass.h"

#include <complex>
#include <utility>
#include <vector>

#include "holotrace/slm/encode/device_moments.h"
#include "holotrace/slm/encode/frequency_band.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

// The frequencies of both axes that a stop passes.
struct Passing {
  FrequencyBand x, y;

  Passing(const Grid& grid, const SpectralFilter& stop)
      : x(band_within(grid.nx, grid.width(), stop.half_u)), y(band_within(grid.ny, grid.height(), stop.half_v)) {}
};

// The spectrum of a field within a stop, times `unit`: column by column, each with the frequencies of y that pass. There is
// room for ny of them, and as much again.
struct Spectrum {
  DeviceField bins;
  DeviceBuffer room;
  float unit = 1;
};

DeviceBuffer room_for(Device& device, const Grid& grid, const Passing& passing) {
  return device.make_buffer(size_t(passing.x.count) * size_t(grid.ny) * sizeof(Complex), "a stop");
}

Spectrum spectrum_of(const ShownPixels<DeviceField>& shown, const Passing& passing, LineTransforms& lines) {
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
  lines.run({grid.nx, FftDirection::forward, {grid.nx, 0, {&scales}}, {x.count, x.first}}, grid.ny, shown.field.samples,
            rows);
  lines.transpose(grid.ny, x.count, rows, spectrum.room);
  lines.run({grid.ny, FftDirection::forward, {grid.ny}, {y.count, y.first}}, x.count, spectrum.room,
            spectrum.bins.samples);
  device.finish();  // before the scales are released
  return spectrum;
}

// The fraction of a field's power in a part of its spectrum, by Parseval's theorem.
double part_of_power(const ShownPixels<DeviceField>& shown, const Spectrum& spectrum) {
  const DeviceField& bins = spectrum.bins;
  const double inside = energy(bins, {0, bins.head.grid.nx, 0, bins.head.grid.ny});
  const double all = shown.moments.square * double(spectrum.unit) * double(spectrum.unit);
  return all > 0 ? inside / (all * double(shown.field.head.grid.pixels())) : 1.0;
}

constexpr double bytes_of_bin = sizeof(Complex);

}  // namespace

ScaledField within_stop(const ShownPixels<DeviceField>& shown, const SpectralFilter& stop, const Observer& observer) {
  Device& device = *shown.field.device;
  const auto lock = device.lock();
  const Grid& grid = shown.field.head.grid;
  const Passing passing(grid, stop);
  const auto& [x, y] = passing;
  LineTransforms lines(device);
  const Spectrum spectrum = spectrum_of(shown, passing, lines);
  observer.fact("band_power", Fact(part_of_power(shown, spectrum)));
  // The transforms do not scale: there and back, they multiply by the number of samples.
  ScaledField inside{make_device_field(device, shown.field.head, "a field within a stop"),
                     double(spectrum.unit) * double(grid.pixels())};
  lines.run({grid.ny, FftDirection::backward, {y.count, y.first}, {grid.ny}}, x.count, spectrum.bins.samples,
            spectrum.room);
  const DeviceBuffer& rows = spectrum.bins.samples;
  lines.transpose(x.count, grid.ny, spectrum.room, rows);
  lines.run({grid.nx, FftDirection::backward, {x.count, x.first}, {grid.nx}}, grid.ny, rows, inside.light.samples);
  device.finish();  // before the work space is released
  return inside;
}

double normalise_modulus(double clipped_pixels, const Observer& observer, ScaledField& field) {
  const ModulusMoments moments = modulus_moments(field.light);
  double top = moments.largest;
  if (clipped_pixels > 0 && top > 0)
    top = modulus_to_clip(count_moduli(field.light, top, modulus_steps), top,
                          clipped_pixels * double(field.light.head.grid.pixels()));
  const double clipped = clip_moduli(field.light, top);
  tell_clipping(top / field.scale, moments.square > 0 ? clipped / moments.square : 0, observer);
  return top / field.scale;
}

double power_inside(const ShownPixels<DeviceField>& shown, const SpectralFilter& filter) {
  const auto lock = shown.field.device->lock();
  LineTransforms lines(*shown.field.device);
  return part_of_power(shown, spectrum_of(shown, Passing(shown.field.head.grid, filter), lines));
}

LowPassCost low_pass_cost(const Grid& grid, const SpectralFilter& stop) {
  LowPassCost cost = power_inside_cost(grid, stop);
  const double pixels = double(grid.pixels()), columns = Passing(grid, stop).x.count;
  cost.memory += bytes_of_bin * pixels;
  cost.moved += bytes_of_bin * (pixels + 5 * columns * grid.ny);
  return cost;
}

LowPassCost power_inside_cost(const Grid& grid, const SpectralFilter& filter) {
  const double pixels = double(grid.pixels()), columns = Passing(grid, filter).x.count;
  LowPassCost cost;
  cost.memory = bytes_of_bin * (2 * columns * grid.ny + 3.0 * (grid.nx + grid.ny));
  cost.moved = bytes_of_bin * (pixels + 6 * columns * grid.ny);
  return cost;
}

}  // namespace holotrace
