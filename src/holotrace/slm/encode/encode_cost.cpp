#include "holotrace/slm/encode/encode_cost.h"

#include <algorithm>
#include <complex>
#include <cstdint>
#include <limits>
#include <optional>
#include <thread>

#include "holotrace/slm/encode/device_low_pass.h"
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
  cost.memory = bytes_of_level * pixels;
  const std::optional<SpectralFilter> stop = stop_of(params, grid, wavelength);
  if (!stop) return cost;
  const double transform = grid.ny * fft_operations(grid.nx) + grid.nx * fft_operations(grid.ny);
  const bool is_limited = params.method == Encoding::double_phase;
  const LowPassCost spectrum = is_limited ? low_pass_cost(grid, *stop) : power_inside_cost(grid, *stop);
  cost.on_processor.fft_operations = (is_limited ? 2 : 1) * transform;
  cost.on_processor.samples += (is_limited ? 4 : 2) * pixels;  // the stop, moduli, levels; irradiances
  cost.moved += spectrum.moved + (is_limited ? 5 : 1) * bytes_of_sample * pixels;
  cost.memory = std::max(spectrum.memory, cost.memory + (is_limited ? bytes_of_sample * pixels : 0));
  return cost;
}

Device* fastest_to_encode(const PlacedField& field, const EncodeParams& params) {
  const Field& head = field.head();
  const EncodeCost cost = encode_cost(params, head.grid, head.wavelength);
  const int threads = int(std::max(1U, std::thread::hardware_concurrency()));
  const double on_processor = predict_seconds(cost.on_processor, summation_rates(), threads);
  return fastest_device(field.seconds_to_processor() + on_processor, [&](Device& device) {
    const bool is_there = field.seconds_to(device) == 0;
    const double of_field = bytes_of_sample * double(head.grid.pixels());
    if (cost.memory + (is_there ? 0 : of_field) > possible_room(device) || of_field > device.info().largest_buffer)
      return std::numeric_limits<double>::infinity();
    const DeviceRates rates = device_rates(device);
    return field.seconds_to(device) + cost.moved / rates.moved_bytes + cost.returned / rates.bytes +
           seconds_to_start_kernels;
  });
}

}  // namespace holotrace
