#include "holotrace/slm/encode/iterate/gradient_descent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/members.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/iterate/device_arrays.h"
#include "holotrace/slm/encode/iterate/frame_descent.h"
#include "holotrace/slm/encode/iterate/iteration_devices.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"
#include "holotrace/slm/encode/iterate/shared_frames.h"

namespace holotrace {
namespace {

double decibels(double loss) { return 10 * std::log10(std::max(loss, 1e-30)); }

// PSNR over all colours that have light, each relative to its own peak.
double psnr(const WavelengthDescents& colours) {
  double error = 0, weight = 0;
  for (const auto& colour : colours) {
    if (colour->peak() == 0) continue;
    error += colour->error() / (colour->peak() * colour->peak());
    weight += colour->weight();
  }
  return 10 * std::log10(weight / std::max(error, 1e-30));
}

void set_illumination(const WavelengthDescent& colour, bool is_joint, Hologram& frame) {
  const double illumination = colour.power() > 0 ? colour.scale() * colour.scale() : 0;
  if (colour.wavelength() == frame.wavelength) frame.illumination = illumination;
  if (is_joint) frame.colours.push_back({colour.wavelength(), illumination});
}

void tell_quality(const WavelengthDescents& colours, const Observer& observer, std::vector<Hologram>& frames) {
  double light = 0;
  for (Hologram& frame : frames) frame.colours.clear();
  for (const auto& colour : colours) {
    for (Hologram& frame : frames) set_illumination(*colour, colours.size() > 1, frame);
    light += colour->light();
  }
  observer.fact("psnr_db", Fact(psnr(colours)));
  observer.fact("target_efficiency", Fact(light / double(colours.size())));
}

// The planes that updates carry light to: those of the targets; of views alone, those of their pupils.
std::vector<TargetPlane> planes_to_reach(const TargetSet& targets) {
  if (!targets.planes.empty()) return targets.planes;
  std::vector<TargetPlane> planes;
  for (const double wavelength : wavelengths_of(targets))
    planes.push_back(
        {.z = targets.views.front().pupils.front().centre.z, .wavelength = wavelength, .amplitude = {}, .weight = {}});
  return planes;
}

// A descent and the file that keeps its state.
class KeptDescent {
 public:
  KeptDescent(FrameDescent& descent, const IterationDevices& place, const Checkpoint& checkpoint, IterationState job)
      : descent_(descent), place_(place), checkpoint_(checkpoint), job_(std::move(job)) {
    const std::optional<IterationState> state = checkpoint.load(job_);
    if (state) place.compute([&] { descent.restore(*state); });
  }

  void save() const {
    IterationState state = place_.compute([&] { return descent_.state(); });
    state.job = job_.job;
    state.description = job_.description;
    checkpoint_.save(state);
  }

  void after_update(int iterations) const {
    const bool is_stopping = descent_.updates() < iterations && checkpoint_.is_stopping && checkpoint_.is_stopping();
    if (is_stopping || (checkpoint_.is_due && checkpoint_.is_due())) save();
    if (is_stopping)
      fail("stopped after {} of {} iterations, which the checkpoint keeps; give the same command again to go on",
           descent_.updates(), iterations);
  }

 private:
  FrameDescent& descent_;
  const IterationDevices& place_;
  const Checkpoint& checkpoint_;
  IterationState job_;
};

// What a caller wants of a descent beside its levels.
struct Listeners {
  const Observer& observer;
  const Checkpoint& checkpoint;
  double most_loss;  // of the first levels
};

// The processes of a descent, and the device that they have chosen.
struct Processes {
  ProcessLinks* links = nullptr;  // none: this one is alone
  DeviceChoice device{};
};

std::unique_ptr<FrameArrays> arrays_on(const IterationDevices& place, const DescentSetup& setup,
                                       const std::vector<Hologram>& frames, const OtherFrames& others, size_t fixed) {
  if (!place.devices.empty())
    return std::make_unique<DeviceFrames>(place.devices, setup.slm, setup.params, frames, others, fixed);
  return std::make_unique<ProcessorFrames>(setup.slm, setup.params, frames, others, fixed);
}

void judge_on(const IterationDevices& place, const TargetSet& targets, const DescentSetup& setup,
              const Observer& observer, std::vector<Hologram>& frames) {
  std::unique_ptr<FrameArrays> arrays;
  const WavelengthDescents colours = place.compute([&] {
    arrays = arrays_on(place, setup, frames, {}, 0);
    WavelengthDescents judged = wavelength_descents(targets, setup, frames.front(), *arrays);
    for (const auto& colour : judged) colour->judge();
    return judged;
  });
  tell_quality(colours, observer, frames);
}

bool descend_on(const IterationDevices& place, const Processes& processes, const TargetSet& targets,
                const DescentSetup& setup, std::vector<Hologram>& frames, const Listeners& listeners) {
  const auto& [observer, checkpoint, most_loss] = listeners;
  const int iterations = iterations_of(setup.params);
  SharedFrames* shared = nullptr;
  const int here = processes.links ? std::min(processes.links->here().count, int(frames.size())) : 1;
  const auto own_arrays = [&](const std::vector<Hologram>& own, const OtherFrames& others, size_t fixed) {
    if (place.devices.empty())
      require_memory_for_descent(planes_to_reach(targets).size(), setup.slm, setup.params, own, here);
    return arrays_on(place, setup, own, others, fixed);
  };
  const auto arrays = [&]() -> std::unique_ptr<FrameArrays> {
    if (!processes.links) return own_arrays(frames, {}, setup.start.fixed);
    auto made = std::make_unique<SharedFrames>(*processes.links, setup, processes.device, frames, own_arrays);
    shared = made.get();
    return made;
  };
  const auto made = place.compute([&] { return std::make_unique<FrameDescent>(targets, setup, frames, arrays()); });
  FrameDescent& descent = *made;
  std::optional<KeptDescent> kept;
  if (checkpoint) kept.emplace(descent, place, checkpoint, descent_job(targets, setup, frames));
  if (kept && descent.updates() == 0) kept->save();  // a file that cannot be written is refused now
  if (descent.updates() > 0)
    observer.progress(double(descent.updates()) / descent.last_update());  // time left is from here
  while (descent.updates() < descent.last_update()) {
    place.compute([&] { descent.update(); });
    if (descent.losses().front() > most_loss) {
      if (shared) shared->finish();
      return false;
    }
    observer.status(fmt::format("loss {:.1f} dB", decibels(descent.losses().back())));
    observer.progress(double(descent.updates()) / descent.last_update());
    if (kept) kept->after_update(iterations);
  }
  if (kept) kept->save();
  place.compute([&] {
    descent.judge();
    descent.write(frames);
  });
  if (shared) shared->finish();
  std::vector<double> convergence = descent.losses();
  convergence.push_back(descent.loss());
  observer.fact("iterations", descent.updates());
  tell_devices(place.devices, observer);
  if (shared) observer.fact("processes", int64_t(shared->processes()));
  observer.fact("loss_first", Fact(convergence.front()));
  observer.fact("loss_last", Fact(convergence.back()));
  observer.curve("convergence", convergence);
  tell_quality(descent.wavelengths(), observer, frames);
  return true;
}

}  // namespace

bool descend(const TargetSet& targets, const Slm& slm, const EncodeParams& params, const Observer& observer,
             std::vector<Hologram>& frames, const Checkpoint& checkpoint, ProcessLinks* links,
             const DescentStart& start, double most_loss) {
  const DescentSetup setup{slm, params, start};
  const Listeners listeners{observer, checkpoint, most_loss};
  if (links && links->count() > 1 && frames.size() > 1) {
    const size_t own = ranges_of_frames(frames.size(), links->count()).front().count();
    const DeviceChoice device = common_device(planes_to_reach(targets), setup, {frames.size(), own}, links->here());
    const IterationDevices place{devices_of_process(device, links->here(), own)};
    return descend_on(place, {links, device}, targets, setup, frames, listeners);
  }
  const std::vector<Device*> devices = devices_for_descent(planes_to_reach(targets), setup, frames.size());
  return on_devices_or_processor(devices, params.device, observer, [&](const IterationDevices& place) {
    return descend_on(place, {}, targets, setup, frames, listeners);
  });
}

void judge(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params,
           const Observer& observer, std::vector<Hologram>& frames, Device* device) {
  const std::vector<Device*> devices = device ? std::vector{device} : std::vector<Device*>();
  on_devices_or_processor(devices, params.device, observer, [&](const IterationDevices& place) {
    judge_on(place, {targets}, {slm, params}, observer, frames);
  });
}

IterationState descent_job(const TargetSet& targets, const DescentSetup& setup, const std::vector<Hologram>& frames) {
  constexpr int schedule = 3;  // changes with what updates do
  const auto& [slm, params, start] = setup;
  Slm panel = slm;  // without its names
  panel.name = panel.preset = panel.source = "";
  panel.own_effects.clear();
  BasicWriter<FnvHash> hash;
  hash(std::string(HOLOTRACE_VERSION), schedule, panel, iterations_of(params), stop_width(params),
       params.step > 0 || start.is_near ? params.step : sgd_step, params.least_gain, params.planes_per_update,
       params.subpixels, params.seed, start.is_near, start.is_near ? params.next_iterations : 0, uint64_t(start.fixed),
       targets.planes, targets.views);
  if (targets.draw_views)
    for (const double wavelength : wavelengths_of(targets)) hash(targets.draw_views(0, wavelength));
  for (const Hologram& frame : frames)
    hash(frame.levels, frame.modulation, frame.wavelength, frame.level, frame.modulus_level);
  return {.job = hash.sink.value(),
          .description = fmt::format(
              "{} frame(s) of {} × {} pixels and {} levels at {}, {} target plane(s), {} iterations", frames.size(),
              slm.grid.nx, slm.grid.ny, frames.front().levels, format_length(frames.front().wavelength),
              targets.planes.size() + targets.views.size(), iterations_of(params))};
}

}  // namespace holotrace
