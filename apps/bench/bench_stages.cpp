// The steps of holotrace bench that move fields: propagate, encode, show.

#include <fmt/format.h>

#include <memory>

#include "bench/bench.h"
#include "holotrace/base/units.h"
#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/io/scene/slm_file.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/shared/cost_model.h"

namespace holotrace {
namespace {

using namespace literals;

std::string size_of(const Grid& grid) { return fmt::format("{}x{}", grid.nx, grid.ny); }

// Two transforms of the padded field, counted in full. The transform skips parts that are known to be zero, which
// appears as a larger fraction of the ceiling.
template <class Real>
BenchRow bench_propagation(const BenchOptions& options, const Grid& panel, const char* precision, bool is_cached) {
  const auto field = convert<Real>(timed_field(panel));
  const auto propagator = make_propagator<Real>(panel, 532_nm, 0.3_m);
  propagate(field, propagator);  // plans are made here
  const double amount = 2 * fft_operations(double(propagator.padded_nx) * propagator.padded_ny);
  const auto work = [&] {
    if (is_cached)
      propagate(field, propagator);
    else
      propagate(field, make_propagator<Real>(panel, 532_nm, 0.3_m));
  };
  const Timing timing = time_work(options, work, amount, measure_fft_in_cache);
  const std::string job = fmt::format("{} padded {}x{}, {}{}", size_of(panel), propagator.padded_nx,
                                      propagator.padded_ny, precision, is_cached ? "" : ", transfer made");
  return make_row("propagate", job, timing, amount, "operations", "FFT in cache, float");
}

BenchRow bench_encode(const BenchOptions& options) {
  const Slm slm = slm_preset("pluto");
  const Field field = timed_field(slm.grid);
  // a complex sample is read, a level is written
  const double bytes = double(slm.grid.pixels()) * (sizeof(std::complex<float>) + sizeof(uint16_t));
  const double bandwidth = measure_memory_bandwidth();  // takes longer than encoding: measured only once
  const Timing timing = time_work(
      options, [&] { encode(field, slm, {}); }, bytes, [&] { return bandwidth; });
  return make_row("encode", size_of(slm.grid) + ", phase", timing, bytes, "bytes", "memory");
}

BenchRow bench_show(const BenchOptions& options, int subpixels) {
  const Slm slm = slm_preset("pluto");
  const Hologram hologram = encode(timed_field(slm.grid), slm, {});
  const ShowParams params{.subpixels = subpixels};
  show(hologram, slm, params);  // plans are made here
  const double amount = fft_operations(double(slm.grid.pixels()) * subpixels * subpixels);
  const Timing timing = time_work(
      options, [&] { show(hologram, slm, params); }, amount, measure_fft_in_cache);
  return make_row("show", fmt::format("{}, subpixels {}", size_of(slm.grid), subpixels), timing, amount, "operations",
                  "FFT in cache, float");
}

// All effects of a panel with the orders 3×3, on 5 × 5 points per pixel.
BenchRow bench_effects(const BenchOptions& options) {
  const Slm slm = slm_preset("pluto");
  const Hologram hologram = encode(timed_field(slm.grid), slm, {});
  const ShowParams params{.subpixels = 3, .effects = {"calibration", "crosstalk", "gaps", "aberration"}};
  show(hologram, slm, params);  // plans are made here
  const double amount = fft_operations(double(slm.grid.pixels()) * 9);
  const Timing timing = time_work(
      options, [&] { show(hologram, slm, params); }, amount, measure_fft_in_cache);
  return make_row("show", size_of(slm.grid) + ", subpixels 3, 5x5 points, effects", timing, amount, "operations",
                  "FFT in cache, float");
}

}  // namespace

std::vector<BenchStep> propagate_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  const auto add = [&](const Grid& panel, bool is_cached) {
    steps.push_back({"propagate", [=] { return bench_propagation<float>(options, panel, "float", is_cached); }});
  };
  add(timed_full_hd, true);
  add(timed_full_hd, false);
  if (options.is_quick) return steps;
  steps.push_back({"propagate", [=] { return bench_propagation<double>(options, timed_full_hd, "double", true); }});
  add(timed_ultra_hd, true);
  return steps;
}

std::vector<BenchStep> show_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  steps.push_back({"encode", [=] { return bench_encode(options); }});
  steps.push_back({"show", [=] { return bench_show(options, 1); }});
  if (options.is_quick) return steps;
  steps.push_back({"show", [=] { return bench_show(options, 3); }});
  steps.push_back({"show", [=] { return bench_effects(options); }});
  return steps;
}

}  // namespace holotrace
