#include "holotrace/slm/encode/iterate/iteration_devices.h"

#include <algorithm>
#include <complex>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/iterate/frames_on_device.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

// The job, and how many of its frames one device has.
struct Share {
  const std::vector<TargetPlane>& targets;
  const DescentSetup& setup;
  size_t frames_of_all, frames;

  // Samples of each pixel in a plane. All updates count as the last ones.
  double samples() const {
    const SampleGroup group = samples_of_update(setup.params.subpixels, 0, false);
    return double(samples_of(group, setup.params.subpixels > 1 ? 1 : 4).size());
  }
  double pixels() const { return double(setup.slm.grid.pixels()); }
};

// What a device does for a share in all updates.
struct DescentWork {
  double kept = 0;       // factors of propagations and targets, sent to each device [bytes]
  double moved = 0;      // read and written in its memory [bytes]
  double carried = 0;    // frames that come and go, because they do not fit in its memory [bytes]
  double exchanged = 0;  // light in planes, between several devices [bytes]
};

// The fraction of updates that use a plane: the planes of its wavelength have their turns equally often.
double turns_of(const TargetPlane& plane, const std::vector<TargetPlane>& targets, const EncodeParams& params) {
  const auto is_of_colour = [&](const TargetPlane& other) { return other.wavelength == plane.wavelength; };
  const auto planes = std::count_if(targets.begin(), targets.end(), is_of_colour);
  return params.planes_per_update == 0 ? 1 : std::min(1.0, double(params.planes_per_update) / double(planes));
}

constexpr double sample = sizeof(std::complex<float>);

Grid samples_of_panel(const DescentSetup& setup) {
  Grid grid = setup.slm.grid;
  grid.nx *= setup.params.subpixels;
  grid.ny *= setup.params.subpixels;
  grid.pitch /= setup.params.subpixels;
  return grid;
}

// Planes with pupils count as if they had none. The panel's effects and views count neither for the processor nor for the
// device. There, one transform is shared by all samples and one is for each; and the same back.
double seconds_on_processor(const Share& share) {
  const Grid grid = samples_of_panel(share.setup);
  double seconds = 0;
  for (const TargetPlane& target : share.targets)
    seconds += (1 + share.samples()) * turns_of(target, share.targets, share.setup.params) *
               seconds_to_propagate(plan_propagator<float>(grid, target.wavelength, target.z, {}));
  return seconds * double(share.frames) * iterations_of(share.setup.params);
}

// What a propagation to each target takes on a device.
struct TargetCost {
  DeviceUse use;
  double fields;  // bytes of both, which are counted apart
};
using TargetCosts = std::vector<TargetCost>;

TargetCosts costs_on(const Device& device, const std::vector<TargetPlane>& targets, const DescentSetup& setup) {
  TargetCosts costs;
  for (const TargetPlane& target : targets) {
    const auto plan = plan_propagator<float>(samples_of_panel(setup), target.wavelength, target.z, {});
    costs.push_back({forecast_propagation(device, plan), bytes_of_fields(plan)});
  }
  return costs;
}

DescentWork work_on(const Device& device, const Share& share, const TargetCosts& costs) {
  const EncodeParams& params = share.setup.params;
  const Grid grid = samples_of_panel(share.setup);
  const double of_light = sample * double(grid.pixels()), samples = share.samples(), updates = iterations_of(params),
               of_frames = double(share.frames) * updates;
  DescentWork work;
  double planes = 0, transforms = 0;  // planes of an update; memory of the transforms
  for (size_t k = 0; k < costs.size(); ++k) {
    const auto& [use, fields] = costs[k];
    const double turns = turns_of(share.targets[k], share.targets, params);
    work.moved += turns * of_frames * ((1 + samples) * double(use.bytes_moved) + 4 * of_light * samples);
    work.kept += double(use.bytes_held) + 8 * double(grid.pixels());
    planes += turns;
    transforms = std::max(transforms, double(use.most_released()) - fields);
  }
  work.moved += 8 * of_light * of_frames;  // drives, moments and slopes
  // Parts of the mean come from the others to the first device, and the factor goes back (DeviceLight).
  const double of_values = sizeof(float) * share.pixels();
  if (share.frames < share.frames_of_all) work.exchanged = 4 * of_values * planes * updates;
  // As FramesOnDevice decides.
  const double arrays = share.setup.slm.modulation == Modulation::complex ? 2 : 1;
  const auto bytes = [&](double frames, double kept_planes) {
    return work.kept + transforms + of_values * (planes + 5) + of_light +
           frames * (bytes_of_drives(size_t(arrays)) * share.pixels() + of_light * (1 + kept_planes * samples));
  };
  if (bytes(double(share.frames), planes) <= possible_room(device)) return work;
  if (bytes(1, 1) > possible_room(device)) work.carried = std::numeric_limits<double>::infinity();
  work.moved *= 1.5;  // light is computed again for the slopes
  work.carried += of_values * arrays * (4 * planes + 8) * of_frames;
  return work;
}

// Starts of the kernels of an update, and waiting for its sums, on slow drivers [s].
constexpr double seconds_to_start = 2e-3;

double seconds_on(Device& device, const Share& share, const TargetCosts& costs, size_t devices) {
  const DeviceRates rates = device_rates(device);
  const DescentWork work = work_on(device, share, costs);
  return work.moved / rates.moved_bytes + (work.kept * double(devices) + work.carried + work.exchanged) / rates.bytes +
         iterations_of(share.setup.params) * seconds_to_start;
}

// Devices, the number of the first one's equals that do it in the least time, and that time.
struct DeviceCount {
  size_t devices = 1;
  double seconds = 0;
};

DeviceCount fastest_count(Device& device, const std::vector<TargetPlane>& targets, const DescentSetup& setup,
                          size_t frames) {
  const TargetCosts costs = costs_on(device, targets, setup);
  const auto seconds_of = [&](size_t devices) {
    return seconds_on(device, {targets, setup, frames, (frames + devices - 1) / devices}, costs, devices);
  };
  DeviceCount best{1, seconds_of(1)};
  const std::vector<int> open = open_devices();
  double opening = 0;
  size_t count = 1;
  for (const int number : equal_devices(list_devices(), device.info().number)) {
    if (number == device.info().number) continue;
    if (++count > frames) break;
    if (std::find(open.begin(), open.end(), number) == open.end()) opening += seconds_to_open_device;
    const double seconds = opening + seconds_of(count);
    if (seconds < best.seconds) best = {count, seconds};
  }
  return best;
}

std::vector<Device*> fastest_for(const std::vector<TargetPlane>& targets, const DescentSetup& setup, size_t frames) {
  Device* const fastest = fastest_device(seconds_on_processor({targets, setup, frames, frames}), [&](Device& device) {
    return fastest_count(device, targets, setup, frames).seconds;
  });
  if (!fastest) return {};
  std::vector<Device*> devices{fastest};
  const size_t count = fastest_count(*fastest, targets, setup, frames).devices;
  try {
    if (count > 1) devices = open_equal_devices(fastest->info().number, count);
  } catch (const Error&) {
    // One of its equals does not work: it does it alone.
  }
  return devices;
}

std::vector<Device*> chosen_for(const std::vector<TargetPlane>& targets, const DescentSetup& setup, size_t frames) {
  const DeviceChoice& choice = setup.params.device;
  if (choice.kind == DeviceKind::cpu) return {};
  if (choice.kind == DeviceKind::all) return open_equal_devices(0, frames);
  if (choice.kind == DeviceKind::opencl) return {&open_device(choice.number)};
  return fastest_for(targets, setup, frames);
}

// The numbers of those of several equal devices that a process of a machine has.
std::vector<int> part_of(const std::vector<int>& equals, const PlaceOnMachine& place) {
  std::vector<int> part;
  for (size_t i = size_t(place.number); i < equals.size(); i += size_t(place.count)) part.push_back(equals[i]);
  if (part.empty()) part.push_back(equals[size_t(place.number) % equals.size()]);
  return part;
}

// The processes of a machine that use a device, which take all of its equals in turn.
int processes_on(int device, const PlaceOnMachine& place) {
  const int equals = int(equal_devices(list_devices(), device).size());
  return (place.count + equals - 1) / equals;
}

// Iterations use all memory that there is: what is kept there for later is soon made again.
std::vector<Device*> emptied(const std::vector<Device*>& devices) {
  for (Device* device : devices) make_room(*device, std::numeric_limits<double>::infinity());
  return devices;
}

}  // namespace

std::vector<Device*> devices_for_descent(const std::vector<TargetPlane>& targets, const DescentSetup& setup,
                                         size_t frames) {
  return emptied(chosen_for(targets, setup, frames));
}

DeviceChoice common_device(const std::vector<TargetPlane>& targets, const DescentSetup& setup,
                           const SharedCount& frames, const PlaceOnMachine& place) {
  const DeviceChoice& choice = setup.params.device;
  if (choice.kind != DeviceKind::automatic) return choice;
  const Share share{targets, setup, frames.all, frames.own};
  // The processes of a machine have its cores together, and take turns on its devices if there are fewer of them.
  const Device* const fastest = fastest_device(place.count * seconds_on_processor(share), [&](Device& device) {
    return processes_on(device.info().number, place) *
           seconds_on(device, share, costs_on(device, share.targets, share.setup), 1);
  });
  return fastest ? DeviceChoice{DeviceKind::opencl, fastest->info().number} : DeviceChoice{};
}

std::vector<Device*> devices_of_process(const DeviceChoice& choice, const PlaceOnMachine& place, size_t frames) {
  if (choice.kind == DeviceKind::cpu) return {};
  std::vector<int> numbers{equal_device(list_devices(), choice.number, place.number)};
  if (choice.kind == DeviceKind::all) numbers = part_of(equal_devices(list_devices(), 0), place);
  if (numbers.size() > frames) numbers.resize(frames);
  std::vector<Device*> devices;
  for (const int number : numbers) {
    Device& device = open_device(number);
    const int sharing = processes_on(number, place);
    if (sharing > 1) device.limit_memory(device.info().memory / sharing);
    devices.push_back(&device);
  }
  return emptied(devices);
}

Device* device_for_projections(const std::vector<TargetPlane>& targets, const DescentSetup& setup) {
  require_one_device(setup.params.device, " for Gerchberg–Saxton");
  EncodeParams params = setup.params;
  params.planes_per_update = 0;
  params.subpixels = 1;
  const std::vector<Device*> devices = devices_for_descent(targets, {setup.slm, params}, 1);
  return devices.empty() ? nullptr : devices.front();
}

}  // namespace holotrace
