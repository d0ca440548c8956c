// The steps of holotrace bench on an OpenCL device.

#include <fmt/format.h>

#include <complex>
#include <functional>
#include <memory>

#include "bench/bench.h"
#include "holotrace/base/cycles.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/slm/encode/iterate/device_arrays.h"
#include "holotrace/slm/encode/iterate/frame_descent.h"
#include "holotrace/slm/encode/iterate/projection_arrays.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/slm/panel/panel_field_by_device.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "holotrace/wave/sum_exact.h"
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

// A stage that does few operations on each sample, so that the memory of a device sets its pace.
struct MemoryStage {
  const char* name;
  std::string job;
  double bytes;  // that its kernels read and write
  std::function<void()> run;
};

// Transfers count in its time.
BenchRow time_on_device(const BenchOptions& options, const MemoryStage& stage) {
  Device& device = open_device(options.device.number);
  stage.run();  // kernels are compiled here
  const DeviceUse before = device.use();
  stage.run();
  const DeviceUse after = device.use();
  const auto run = [&] {
    stage.run();
    device.finish();  // a stage may return before its last kernels end
  };
  const Timing timing = time_work(options, run, stage.bytes, [&] { return measure_device_peak(device).memory; });
  BenchRow row = make_row(fmt::format("{} on {}", stage.name, device_text(options.device)), stage.job, timing,
                          stage.bytes, "bytes", "memory of the device");
  row.facts["device"] = device.info().name;
  row.facts["bytes_in"] = after.bytes_in - before.bytes_in;
  row.facts["bytes_out"] = after.bytes_out - before.bytes_out;
  return row;
}

Grid bench_panel(const BenchOptions& options) {
  return options.is_quick ? Grid{480, 270, timed_full_hd.pitch} : timed_full_hd;
}

// From the processor and back.
BenchRow bench_propagation_on_device(const BenchOptions& options) {
  using namespace literals;
  const Grid panel = bench_panel(options);
  const Field field = timed_field(panel);
  const auto propagator = make_propagator<float>(panel, 532_nm, 0.3_m);
  Device& device = open_device(options.device.number);
  DevicePropagator on_device(device, propagator);
  return time_on_device(
      options,
      {"propagate",
       fmt::format("{}x{} padded {}x{}, float", panel.nx, panel.ny, propagator.padded_nx, propagator.padded_ny),
       double(forecast_propagation(device, propagator).bytes_moved), [&] { on_device(field); }});
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

// Bytes of a propagation over 0.3 m to the same window.
double moved_bytes(Device& device, const Grid& grid, const PropagateParams& params = {}) {
  using namespace literals;
  return double(forecast_propagation(device, plan_propagator<float>(grid, 532_nm, 0.3_m, params)).bytes_moved);
}

// An update of gradient descent. Nearly all of its work is that of propagations, whose bytes are those that count.
BenchRow bench_descent_on_device(const BenchOptions& options) {
  using namespace literals;
  Device& device = open_device(options.device.number);
  const Slm slm{.grid = bench_panel(options)};
  const EncodeParams params{.method = Encoding::sgd, .target_distances = {0.3_m}, .iterations = 100000};
  const int frames = options.is_quick ? 1 : 8;
  const std::vector<Hologram> start = random_frames(slm, 532_nm, frames);
  const TargetSet targets{targets_of(timed_field(slm.grid), params)};
  FrameDescent descent(targets, {slm, params}, start,
                       std::make_unique<DeviceFrames>(std::vector{&device}, slm, params, start));
  // There and back: a transform that all samples share, and one for each of two samples.
  const double bytes = frames * 3.0 * moved_bytes(device, slm.grid);
  return time_on_device(options,
                        {"sgd", fmt::format("{}x{}, {} frame(s), one update", slm.grid.nx, slm.grid.ny, frames), bytes,
                         [&] { descent.update(); }});
}

// An iteration of Gerchberg–Saxton with one plane: as for gradient descent, a shared transform and four samples, there and
// back.
BenchRow bench_projection_on_device(const BenchOptions& options) {
  using namespace literals;
  Device& device = open_device(options.device.number);
  const Slm slm{.grid = bench_panel(options)};
  const EncodeParams params{.method = Encoding::gerchberg_saxton, .target_distances = {0.3_m}};
  const std::vector<TargetPlane> targets = targets_of(timed_field(slm.grid), params);
  Array2D<std::complex<float>> start(slm.grid.ny, slm.grid.nx);
  CounterRandom random(1, 0, 0);
  for (auto& u : start.values) u = std::complex<float>(cis_cycles(random.uniform()));
  DeviceProjection projection(device, {targets, slm, params}, start);
  const auto iterate = [&] {
    projection.show(0);
    projection.leave_residual(0, 1);
    projection.add_step(0, 1);
    projection.take_step();
  };
  return time_on_device(options, {"gerchberg-saxton", fmt::format("{}x{}, one iteration", slm.grid.nx, slm.grid.ny),
                                  5 * moved_bytes(device, slm.grid), iterate});
}

// The panel: levels go in, and the light stays.
BenchRow bench_show_on_device(const BenchOptions& options) {
  using namespace literals;
  const Slm slm{.grid = bench_panel(options)};
  const Hologram hologram = random_frames(slm, 532_nm, 1).front();
  const IlluminationState state{.wavelength = 532_nm};
  ShowParams params;
  params.device = options.device;
  const PanelModel panel(slm, params, Modulation::phase, slm.levels, 0, state);
  const Array2D<float> drive(slm.grid.ny, slm.grid.nx);
  const Device& device = open_device(options.device.number);
  const PanelForecast forecast = forecast_panel(device, panel, {drive}, true, possible_room(device));
  return time_on_device(options, {"show", fmt::format("{}x{}, light stays there", slm.grid.nx, slm.grid.ny),
                                  double(forecast.use.bytes_moved), [&] { show_light(hologram, slm, params, state); }});
}

// The camera: the light is there, and the picture comes out. The bytes are those of the propagation to the sensor.
BenchRow bench_look_on_device(const BenchOptions& options) {
  using namespace literals;
  Device& device = open_device(options.device.number);
  const Slm slm{.grid = bench_panel(options)};
  const PlacedField light(send(device, timed_field(slm.grid)), {});
  PropagateParams propagation;
  propagation.device = options.device;
  const Sensor sensor = sensor_of(shape_of(light.head()), slm, -0.3_m, propagation, {});
  return time_on_device(
      options,
      {"look", fmt::format("{}x{} to {}x{} pixels", slm.grid.nx, slm.grid.ny, sensor.pixels.nx, sensor.pixels.ny),
       moved_bytes(device, slm.grid, sensor.window), [&] { look(light, slm, 0.3_m, propagation, {}); }});
}

}  // namespace

std::vector<BenchStep> device_steps(const BenchOptions& options) {
  std::vector<BenchStep> steps;
  if (options.device.kind != DeviceKind::opencl) return steps;
  const auto add = [&](const DeviceJob& job) {
    steps.push_back({"tiled on " + device_text(options.device), [=] { return bench_on_device(options, job); }});
  };
  const auto add_stage = [&](const char* name, BenchRow (*bench)(const BenchOptions&)) {
    steps.push_back({fmt::format("{} on {}", name, device_text(options.device)), [=] { return bench(options); }});
  };
  add_stage("propagate", bench_propagation_on_device);
  add_stage("show", bench_show_on_device);
  add_stage("look", bench_look_on_device);
  add_stage("gerchberg-saxton", bench_projection_on_device);
  add_stage("sgd", bench_descent_on_device);
  add({options.is_quick ? 200 : 1000, 1e-3});
  if (options.is_quick) return steps;
  add({10000, 1e-3});
  add({10000, 1e-4});
  return steps;
}

}  // namespace holotrace
