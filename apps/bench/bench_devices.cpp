// The steps of holotrace bench on an OpenCL device.

#include <fmt/format.h>

#include "bench/bench.h"
#include "holotrace/base/units.h"
#include "holotrace/estimate/machine/device_peak.h"
#include "holotrace/estimate/machine/timed_jobs.h"
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

}  // namespace

std::vector<BenchStep> device_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  if (options.device.kind != DeviceKind::opencl) return steps;
  const auto add = [&](const DeviceJob& job) {
    steps.push_back({"tiled on " + device_text(options.device), [=] { return bench_on_device(options, job); }});
  };
  steps.push_back(
      {"propagate on " + device_text(options.device), [=] { return bench_propagation_on_device(options); }});
  add({options.is_quick ? 200 : 1000, 1e-3});
  if (options.is_quick) return steps;
  add({10000, 1e-3});
  add({10000, 1e-4});
  return steps;
}

}  // namespace holotrace
