// The steps of holotrace bench on an OpenCL device.

#include <fmt/format.h>

#include <memory>

#include "bench/bench.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/estimate/machine/device_peak.h"
#include "holotrace/estimate/machine/timed_jobs.h"
#include "holotrace/slm/encode/iterate/device_arrays.h"
#include "holotrace/slm/encode/iterate/frame_descent.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/sample_error.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/tiles/device_tiles.h"

namespace holotrace {
namespace {

struct DeviceJob {
  int waves;
  double tolerance;
};

// As on the processor, a sum of complex products by tiles takes four real multiply-adds for each wave and pixel.
BenchRow bench_on_device(const BenchOptions& options, const DeviceJob& job) {
  Device& device = open_device(options.device.number);
  const Grid panel = timed_full_hd;
  const Sources sources = timed_waves(panel, job.waves, 0.19, 0.21);
  SynthesizeParams params{.method = SynthesisMethod::tiled, .tolerance = job.tolerance};
  params.device = options.device;
  const double amount = double(waves_pixels(sources, panel));
  Field field;
  BenchRow row;
  Observer observer;
  observer.on_fact = [&row](const std::string& name, const Fact& value) {
    std::visit([&](const auto& v) { row.facts[name] = v; }, value);
  };
  const DeviceUse before = device.use();
  field = synthesize(sources, panel, params, observer);
  const DeviceUse after = device.use();
  const Timing timing = time_work(
      options, [&] { field = synthesize(sources, panel, params); }, amount,
      [&] { return measure_device_peak(device).multiply_adds / 4; });
  const auto facts = row.facts;
  row = make_row(
      "tiled on " + device_text(options.device),
      fmt::format("{}x{}, {} waves, 0.19-0.21 m, {:g}", panel.nx, panel.ny, short_count(job.waves), job.tolerance),
      timing, amount, "waves·pixels", "multiply-adds of the device / 4");
  row.error = sampled_error(field, sources, 200);
  row.facts = facts;
  row.facts["device"] = device.info().name;
  row.facts["bytes_in"] = after.bytes_in - before.bytes_in;
  row.facts["bytes_out"] = after.bytes_out - before.bytes_out;
  return row;
}

// A propagation does few operations on each sample: the memory of a device sets its pace. The fields' transfers count in
// its time.
BenchRow bench_propagation_on_device(const BenchOptions& options) {
  using namespace literals;
  Device& device = open_device(options.device.number);
  const Grid panel = options.is_quick ? Grid{480, 270, 8_um} : timed_full_hd;
  const Field field = timed_field(panel);
  const auto propagator = make_propagator<float>(panel, 532_nm, 0.3_m);
  DevicePropagator on_device(device, propagator);
  Field there = on_device(field);  // kernels are compiled here
  const DeviceUse before = device.use();
  there = on_device(field);
  const DeviceUse after = device.use();
  const double amount = on_device.cost().moved;
  const Timing timing = time_work(
      options, [&] { there = on_device(field); }, amount, [&] { return measure_device_peak(device).memory; });
  BenchRow row =
      make_row("propagate on " + device_text(options.device),
               fmt::format("{}x{} padded {}x{}, float", panel.nx, panel.ny, propagator.padded_nx, propagator.padded_ny),
               timing, amount, "bytes", "memory of the device");
  row.facts["device"] = device.info().name;
  row.facts["bytes_in"] = after.bytes_in - before.bytes_in;
  row.facts["bytes_out"] = after.bytes_out - before.bytes_out;
  return row;
}

std::vector<Hologram> random_frames(const Slm& slm, double wavelength, int frames) {
  std::vector<Hologram> holograms(static_cast<size_t>(frames));
  CounterRandom random(1, 0, 0);
  for (Hologram& hologram : holograms) {
    hologram.grid = slm.grid;
    hologram.levels = slm.levels;
    hologram.wavelength = wavelength;
    hologram.level = Array2D<uint16_t>(slm.grid.ny, slm.grid.nx);
    for (uint16_t& level : hologram.level.values) level = uint16_t(slm.levels * random.uniform());
  }
  return holograms;
}

// An update of gradient descent. Nearly all of its work is that of propagations, whose bytes are those that count.
BenchRow bench_descent_on_device(const BenchOptions& options) {
  using namespace literals;
  Device& device = open_device(options.device.number);
  const Slm slm{.grid = options.is_quick ? Grid{480, 270, 8_um} : timed_full_hd};
  const EncodeParams params{.method = Encoding::sgd, .target_distances = {0.3_m}, .iterations = 100000};
  const int frames = options.is_quick ? 1 : 8;
  const std::vector<Hologram> start = random_frames(slm, 532_nm, frames);
  const TargetSet targets{targets_of(timed_field(slm.grid), params)};
  FrameDescent descent(targets, {slm, params}, start, std::make_unique<DeviceFrames>(device, slm, params, start));
  descent.update();  // kernels are compiled here
  const DeviceUse before = device.use();
  descent.update();
  const DeviceUse after = device.use();
  // There and back: a transform that all samples share, and one for each of four samples, or of two for many frames.
  const auto plan = plan_propagator<float>(slm.grid, 532_nm, 0.3_m, {});
  const double amount = frames * (frames < 4 ? 5.0 : 3.0) * device_propagation_cost(device, plan).moved;
  const auto update = [&] {
    descent.update();
    device.finish();  // an update returns before its last kernels end
  };
  const Timing timing = time_work(options, update, amount, [&] { return measure_device_peak(device).memory; });
  BenchRow row = make_row("sgd on " + device_text(options.device),
                          fmt::format("{}x{}, {} frame(s), one update", slm.grid.nx, slm.grid.ny, frames), timing,
                          amount, "bytes", "memory of the device");
  row.facts["device"] = device.info().name;
  row.facts["bytes_in"] = after.bytes_in - before.bytes_in;
  row.facts["bytes_out"] = after.bytes_out - before.bytes_out;
  return row;
}

}  // namespace

std::vector<BenchStep> device_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  if (options.device.kind != DeviceKind::opencl) return steps;
  const auto add = [&](const DeviceJob& job) {
    steps.push_back({"tiled on " + device_text(options.device), [=] { return bench_on_device(options, job); }});
  };
  steps.push_back(
      {"propagate on " + device_text(options.device), [=] { return bench_propagation_on_device(options); }});
  steps.push_back({"sgd on " + device_text(options.device), [=] { return bench_descent_on_device(options); }});
  add({options.is_quick ? 200 : 1000, 1e-3});
  if (options.is_quick) return steps;
  add({10000, 1e-3});
  add({10000, 1e-4});
  return steps;
}

}  // namespace holotrace
