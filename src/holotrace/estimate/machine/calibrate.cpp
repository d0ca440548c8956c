#include "holotrace/estimate/machine/calibrate.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <vector>

#include "holotrace/base/column_fft.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/data/rates.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/wave/planes/plane_plan.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/tiles/device_tiles.h"
#include "holotrace/wave/tiles/packed_product.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {
namespace {

constexpr size_t terms = summation_terms.size();

// Row i, column k: fraction of run i that its work of kind k would take if one unit of it took seconds_if_all.
struct Parts {
  std::vector<std::array<double, terms>> of_run;
  std::array<double, terms> seconds_if_all{};  // least time over the runs that one unit could take [s]
};

Parts parts_of(const std::vector<TimedWork>& timed) {
  Parts parts;
  for (const TimedWork& run : timed) {
    require(run.seconds > 0, "expected a timed run of more than 0 s, got {} s", run.seconds);
    bool has_work = false;
    for (size_t k = 0; k < terms; ++k) {
      const double count = run.work.*summation_terms[k].count;
      if (count <= 0) continue;
      has_work = true;
      const double all = run.seconds / count;
      if (parts.seconds_if_all[k] == 0 || all < parts.seconds_if_all[k]) parts.seconds_if_all[k] = all;
    }
    require(has_work, "expected a timed run with some work, got one with none");
  }
  for (const TimedWork& run : timed) {
    auto& row = parts.of_run.emplace_back();
    for (size_t k = 0; k < terms; ++k)
      row[k] = run.work.*summation_terms[k].count * parts.seconds_if_all[k] / run.seconds;
  }
  return parts;
}

// Coordinate descent: sets each unknown in turn to its best value ≥ 0. The problem is convex, with few unknowns.
std::array<double, terms> least_squares(const Parts& parts) {
  std::array<double, terms> x{};
  for (int sweep = 0; sweep < 20000; ++sweep)
    for (size_t k = 0; k < terms; ++k) {
      double numerator = 0, denominator = 0;
      for (const auto& row : parts.of_run) {
        double rest = 1;
        for (size_t other = 0; other < terms; ++other)
          if (other != k) rest -= row[other] * x[other];
        numerator += row[k] * rest;
        denominator += row[k] * row[k];
      }
      if (denominator > 0) x[k] = std::max(0.0, numerator / denominator);
    }
  return x;
}

}  // namespace

SummationRates fit_rates(const std::vector<TimedWork>& timed) {
  const Parts parts = parts_of(timed);
  const std::array<double, terms> x = least_squares(parts);
  SummationRates rates;
  double faster = 0;
  int measured = 0;
  for (size_t k = 0; k < terms; ++k) {
    if (parts.seconds_if_all[k] == 0) continue;
    double& rate = rates.*summation_terms[k].rate;
    const double usual = rate;
    rate = 1 / (parts.seconds_if_all[k] * std::max(x[k], 0.01));
    if (usual <= 0) continue;
    faster += std::log(rate / usual);
    ++measured;
  }
  for (size_t k = 0; k < terms; ++k)
    if (parts.seconds_if_all[k] == 0 && measured > 0) rates.*summation_terms[k].rate *= std::exp(faster / measured);
  return rates;
}

namespace {

constexpr double wavelength = timed_wavelength, pitch = timed_full_hd.pitch;

// The fastest of many runs: other work on the machine can only slow a run down.
TimedWork fastest(const SummationWork& work, const std::function<void()>& run) {
  run();
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 9; ++i) best = std::min(best, seconds_of(run));
  return {work, best};
}

TimedWork time_exact() {
  const Grid panel{64, 64, pitch};
  const Sources sources = timed_waves(panel, 32, 0.19, 0.21);
  return fastest({.exact_terms = 32.0 * 64 * 64}, [&] { sum_exact(sources, panel); });
}

// Times the sum of waves on a single tile.
TimedWork time_tile(const TilePlan& plan, int count) {
  const Grid panel{plan.shape.columns, plan.shape.rows, pitch};
  const std::vector<PreparedWave> waves = prepare_waves(timed_waves(panel, count, 0.19, 0.21), panel);
  Array2D<std::complex<float>> samples(panel.ny, panel.nx);
  TileWorkspace workspace;
  list_waves(waves, {0, panel.nx, 0, panel.ny}, workspace.waves);
  return fastest(count * double(panel.pixels()) * tile_work(plan), [&] {
    sum_tile(workspace.waves, {panel, wavelength}, plan, {0, panel.nx, 0, panel.ny}, workspace, samples);
  });
}

// Times spreading of waves to the grids of a tile; every wave lights the whole tile. The waves fill more than the
// caches that a core has for itself.
TimedWork time_spreading(int nodes, int width) {
  const PlanesPlan plan{.tile = 120, .width = width, .nodes = nodes};
  const Grid panel{plan.tile, plan.tile, pitch};
  constexpr int count = 1 << 16;
  const SortedWaves waves =
      sort_waves(prepare_waves(timed_waves(panel, count, 0.19, 0.21), panel), plan, wavelength, pitch);
  const PlanesTables tables(plan, wavelength, pitch);
  PlanesWorkspace workspace;
  workspace.grids.assign(tables.grid_size(), 0.0F);
  const SummationWork work{.plane_waves = double(count), .spreads = count * spreads_per_wave(plan)};
  return fastest(work, [&] {
    size_t packet = 0;
    spread_waves(waves.waves, waves.slabs.front(), tables,
                 {{0, panel.nx, 0, panel.ny}, panel.x(plan.tile / 2), panel.y(plan.tile / 2)}, packet, workspace);
  });
}

// Times the transform that grids of tiles of 120 pixels get (plane_tile.h), in cache.
TimedWork time_fft() {
  constexpr int length = 240, blocks = 16;
  const ColumnFft<float> transform(length);
  const AlignedVector<std::complex<float>> lines(transform.work_size(), {1.0F, 0.0F});
  AlignedVector<std::complex<float>> transformed(lines.size()), spare(lines.size());
  return fastest({.fft_operations = blocks * column_block * fft_operations(length)}, [&] {
    for (int block = 0; block < blocks; ++block)
      transform(FftDirection::backward, lines.data(), transformed.data(), spare.data());
  });
}

TimedWork time_samples() {
  constexpr size_t count = 1 << 16;
  AlignedVector<std::complex<float>> a(count, {1.0F, 0.0F});
  const AlignedVector<std::complex<float>> b(count, {0.6F, 0.8F});
  return fastest({.samples = double(count)}, [&] {
    for (size_t i = 0; i < count; ++i)
      a[i] = {a[i].real() * b[i].real() - a[i].imag() * b[i].imag(),
              a[i].real() * b[i].imag() + a[i].imag() * b[i].real()};
  });
}

}  // namespace

std::vector<TimedWork> time_summation() {
  std::vector<TimedWork> timed;
  tbb::task_arena one_thread(1);
  one_thread.execute([&] {
    timed.push_back(time_exact());
    // Tiles of many shapes separate products from factors, and both from the fixed cost of each wave.
    for (const TileShape& tile : {TileShape{128, 120}, {64, 60}, {32, 30}, {32, 12}})
      timed.push_back(time_tile({tile}, 512));
    if (packed_unit() != PackedUnit::none)
      for (const TileShape& tile : {TileShape{128, 120}, {64, 60}, {32, 30}})
        for (const TileProducts products : {TileProducts::bf16, TileProducts::split_bf16})
          timed.push_back(time_tile({tile, products}, 512));
    for (const int width : {4, 5, 8})
      for (const int nodes : {1, 2, 4, 8}) timed.push_back(time_spreading(nodes, width));
    timed.push_back(time_fft());
    timed.push_back(time_samples());
  });
  return timed;
}

SummationRates calibrate_summation() {
  SummationRates rates = fit_rates(time_summation());
  for (const SummationTerm& term : summation_terms) rates.*term.rate = coarse_rate(rates.*term.rate);
  return rates;
}

std::string calibration_key() {
  constexpr int kernels = 2;  // raised when what the rates count changes
  return fmt::format("holotrace {}, kernels {}; {}; {}; {}{}", HOLOTRACE_VERSION, kernels, cpu_name(),
                     tile_sum_instruction_set(), has_avx512_bf16() ? "AVX512_BF16 " : "",
                     enable_amx_bf16() ? "AMX_BF16" : "");
}

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
      return double(forecast_propagation(device, plan).bytes_moved) / std::max(seconds, 1e-9);
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
