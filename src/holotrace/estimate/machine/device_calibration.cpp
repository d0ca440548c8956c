#include "holotrace/estimate/machine/device_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "holotrace/data/summation_rates.h"
#include "holotrace/estimate/machine/peak_rate.h"
#include "holotrace/estimate/machine/timed_jobs.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/tiles/device_tiles.h"

namespace holotrace {
namespace {

constexpr TileShape shape{64, 64};
constexpr double long_enough = 0.02;  // [s]: hundreds of times what a launch takes

template <class Run>
double fastest(const Run& run) {
  double best = seconds_of(run);
  for (int i = 0; i < 3; ++i) best = std::min(best, seconds_of(run));
  return best;
}

// Bytes per second of transfers, there and back.
double transfer_rate(Device& device) {
  std::vector<char> bytes(size_t(16) << 20);
  const DeviceBuffer buffer = device.upload(bytes, "a measurement");
  const double seconds = fastest([&] {
    device.write(buffer, bytes.data(), bytes.size());
    device.read(buffer, bytes.data(), bytes.size());
  });
  return 2.0 * double(bytes.size()) / seconds;
}

// Every wave lights the whole panel. The number of waves grows until the sum takes long enough.
double multiply_add_rate(Device& device, double bytes_per_second) {
  const Grid panel{1024, 512, timed_full_hd.pitch};
  for (int count = 64;; count *= 4) {
    const std::vector<PreparedWave> waves = prepare_waves(timed_waves(panel, count, 0.19, 0.21), panel);
    Array2D<std::complex<float>> samples(panel.ny, panel.nx);
    const auto run = [&] {
      sum_tiles_on_device(device, waves, {panel, timed_wavelength}, shape, {0, panel.nx, 0, panel.ny}, samples, {});
    };
    run();  // compiles the kernel
    const double transfers = 8.0 * double(panel.pixels()) / bytes_per_second, seconds = fastest(run) - transfers;
    if (seconds > long_enough || count >= 65536)
      return count * double(panel.pixels()) * multiply_adds_per_wave_pixel(shape) / std::max(seconds, 1e-9);
  }
}

// Bytes per second of the kernels of a propagation. The field grows until they take long enough; it is on the device. A
// paraxial transfer function takes the processor little time.
double propagation_rate(Device& device) {
  const PropagateParams paraxial{PropagationMethod::fresnel};
  for (int side = 256;; side *= 2) {
    const Grid grid{side, side, timed_full_hd.pitch};
    DevicePropagator propagator(device, make_propagator<float>(grid, timed_wavelength, 1e-3, paraxial));
    const std::vector<std::complex<float>> zeros(size_t(grid.pixels()));
    const DeviceBuffer from = device.upload(zeros, "a measurement"), to = device.upload(zeros, "a measurement");
    const auto run = [&] { propagator.run(from, to); };
    run();  // compiles the kernels
    const double seconds = fastest(run);
    if (seconds > long_enough || side >= 2048) {
      const auto plan = plan_propagator<float>(grid, timed_wavelength, 1e-3, paraxial);
      return device_propagation_cost(device, plan).moved / std::max(seconds, 1e-9);
    }
  }
}

}  // namespace

DeviceRates calibrate_device(Device& device) {
  const auto lock = device.lock();
  const double bytes = transfer_rate(device);
  return {coarse_rate(multiply_add_rate(device, bytes)), coarse_rate(bytes), coarse_rate(propagation_rate(device))};
}

std::string device_calibration_key(const DeviceInfo& info) {
  return fmt::format("{}, {} compute units, driver {}, {}, holotrace {}", info.name, info.compute_units, info.driver,
                     info.platform, HOLOTRACE_VERSION);
}

}  // namespace holotrace
