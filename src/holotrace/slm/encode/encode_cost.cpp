#include "holotrace/slm/encode/encode_cost.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <optional>
#include <thread>

#include "holotrace/slm/encode/banded_samples.h"
#include "holotrace/slm/encode/device_low_pass.h"
#include "holotrace/slm/encode/frequency_band.h"
#include "holotrace/slm/encode/stop.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/shared/device_room.h"
#include "holotrace/wave/shared/fastest_device.h"

namespace holotrace {
namespace {

constexpr double bytes_of_sample = sizeof(std::complex<float>), bytes_of_level = sizeof(uint16_t);

// Starts of the kernels and waiting for them, on slow drivers [s].
constexpr double seconds_to_start_kernels = 1e-3;

}  // namespace

EncodeCost encode_cost(const EncodeParams& params, const Grid& grid, double wavelength) {
  const double pixels = double(grid.pixels());
  const double results = params.method == Encoding::complex ? 2 : 1;
  EncodeCost cost;
  // The field is read twice for its moments, and once for each level.
  cost.on_processor.samples = (1 + results) * pixels;
  cost.moved = ((2 + results) * bytes_of_sample + results * bytes_of_level) * pixels;
  cost.returned = results * bytes_of_level * pixels;
  cost.memory = bytes_of_level * pixels + bytes_of_row_sums * grid.ny;
  cost.passes = 1 + results;  // moments, and each of the levels
  cost.moved_in_bands = cost.returned + cost.passes * bytes_of_sample * pixels;
  const std::optional<SpectralFilter> stop = stop_of(params, grid, wavelength);
  if (!stop) return cost;
  const double transform = grid.ny * fft_operations(grid.nx) + grid.nx * fft_operations(grid.ny);
  const bool is_limited = params.method == Encoding::double_phase;
  const LowPassCost spectrum = is_limited ? low_pass_cost(grid, *stop) : power_inside_cost(grid, *stop);
  cost.on_processor.fft_operations = (is_limited ? 2 : 1) * transform;
  cost.on_processor.samples += (is_limited ? 4 : 2) * pixels;  // the stop, moduli, levels; irradiances
  cost.moved += spectrum.moved + (is_limited ? 5 : 1) * bytes_of_sample * pixels;
  // Once more for the range of irradiances, and for the spectrum; within a stop also back, and for moments, counts, and clipping.
  const double more_passes = is_limited ? 5 : params.method == Encoding::off_axis ? 2 : 1;
  const double columns_within = pass_band(grid, *stop).x.count;
  cost.passes += more_passes;
  cost.moved_in_bands += bytes_of_sample * (more_passes * pixels + (is_limited ? 4 : 2) * columns_within * grid.ny);
  cost.memory = std::max(spectrum.memory, cost.memory + (is_limited ? bytes_of_sample * pixels : 0)) +
                encode_table_bytes(params, grid, wavelength);
  return cost;
}

bool fits_whole(const Device& device, const PlacedField& field, const EncodeParams& params) {
  const Field& head = field.head();
  const double of_field = bytes_of_sample * double(head.grid.pixels());
  const double more = field.is_on(device) ? 0 : of_field;
  return encode_cost(params, head.grid, head.wavelength).memory + more <= possible_room(device) &&
         of_field <= device.info().largest_buffer;
}

Device* fastest_to_encode(const PlacedField& field, const EncodeParams& params) {
  const Field& head = field.head();
  const EncodeCost cost = encode_cost(params, head.grid, head.wavelength);
  const int threads = int(std::max(1U, std::thread::hardware_concurrency()));
  const double on_processor = predict_seconds(cost.on_processor, summation_rates(), threads);
  return fastest_device(field.seconds_to_processor() + on_processor, [&](Device& device) {
    const DeviceRates rates = device_rates(device);
    const double kernels = cost.moved / rates.moved_bytes + seconds_to_start_kernels;
    if (fits_whole(device, field, params)) return field.seconds_to(device) + kernels + cost.returned / rates.bytes;
    const double given_up = field.is_on(device) ? bytes_of_sample * double(head.grid.pixels()) : 0;
    const EncodeBands bands = encode_bands(params, head.grid, head.wavelength, possible_room(device) + given_up,
                                           device.info().largest_buffer);
    if (!bands.fit()) return std::numeric_limits<double>::infinity();
    const double starts = cost.passes * std::ceil(head.grid.ny / double(bands.rows)) * seconds_to_start_kernels;
    return field.seconds_to_processor() + kernels + starts + cost.moved_in_bands / rates.bytes;
  });
}

}  // namespace holotrace
