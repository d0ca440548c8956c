#include "holotrace/slm/encode/iterate/descent_device.h"

#include <algorithm>
#include <complex>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/slm/encode/iterate/frame_share.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/wave/propagate/propagation_cost.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/shared/fastest_device.h"

namespace holotrace {
namespace {

// Of all updates, for a share of the frames.
struct DescentWork {
  double on_processor = 0;  // [s]
  double kept = 0;          // factors of propagations and targets, sent to each device [bytes]
  double moved = 0;         // read and written in its memory [bytes]
  double carried = 0;       // frames that come and go, because they do not fit in its memory [bytes]
  double exchanged = 0;     // light in planes, between several devices [bytes]
  double updates = 0;
};

// The job, and how many of its frames one device has.
struct Share {
  const std::vector<TargetPlane>& targets;
  const DescentSetup& setup;
  size_t frames_of_all, frames;
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

// Planes with pupils count as if they had none, and all updates take as many samples as the last ones. The panel's effects
// and views count neither for the processor nor for the device.
DescentWork work_of(const Share& share, const Device* device) {
  const auto& [targets, setup, frames_of_all, frames] = share;
  const EncodeParams& params = setup.params;
  const SampleGroup group = samples_of_update(frames_of_all, params.subpixels, 0, false);
  const double samples = double(samples_of(group, params.subpixels > 1 ? 1 : 4).size());
  const Grid grid = samples_of_panel(setup);
  DescentWork work;
  work.updates = iterations_of(params);
  const double pixels = double(grid.pixels()), of_frames = double(frames) * work.updates;
  const double arrays = setup.slm.modulation == Modulation::complex ? 2 : 1;
  const double of_array = double(setup.slm.grid.pixels()) * sizeof(float);
  double planes = 0, transfers = 0;
  for (const TargetPlane& target : targets) {
    const auto plan = plan_propagator<float>(grid, target.wavelength, target.z, {});
    // There, one transform shared by all samples and one for each; and the same back.
    const double turns = turns_of(target, targets, params), propagations = (1 + samples) * turns * of_frames;
    if (!device) {
      work.on_processor += propagations * seconds_to_propagate(plan);
      continue;
    }
    const DevicePropagationCost cost = device_propagation_cost(*device, plan);
    work.moved += propagations * cost.moved + 4 * sample * pixels * samples * turns * of_frames;
    work.kept += cost.kept + 8 * pixels;
    planes += turns;
    transfers = std::max(transfers, cost.work - cost.fields);
  }
  if (!device) return work;
  work.moved += 8 * sample * pixels * of_frames;  // drives, moments and slopes
  // Parts of the mean come from the others to the first device, and the factor goes back (DeviceLight).
  if (frames < frames_of_all) work.exchanged = 4 * of_array * planes * work.updates;
  const double beside = work.kept + transfers + of_array * (planes + 5) + sample * pixels;
  const double of_levels = bytes_of_drives(size_t(arrays)) * double(setup.slm.grid.pixels());
  const auto bytes = [&](double kept_frames, double kept_planes) {
    return beside + kept_frames * (of_levels + sample * pixels * (1 + kept_planes * samples));
  };
  if (bytes(double(frames), planes) <= device->memory_left()) return work;
  if (bytes(1, 1) > device->memory_left()) work.carried = std::numeric_limits<double>::infinity();
  // Its light is computed again for the slopes; FrameShare says what goes and comes.
  work.moved *= 1.5;
  work.carried += of_array * arrays * (4 * planes + 8) * of_frames;
  return work;
}

// Starts of the kernels of an update, and waiting for its sums, on slow drivers [s].
constexpr double seconds_to_start = 2e-3;

double seconds_on(Device& device, const std::vector<TargetPlane>& targets, const DescentSetup& setup, size_t frames,
                  size_t devices) {
  const DeviceRates rates = device_rates(device);
  const DescentWork work = work_of({targets, setup, frames, (frames + devices - 1) / devices}, &device);
  return work.moved / rates.moved_bytes +
         (work.kept * double(devices) + work.carried + work.exchanged) / rates.bytes + work.updates * seconds_to_start;
}

// Devices, the number of the first one's equals that do it in the least time, and that time.
struct DeviceCount {
  size_t devices = 1;
  double seconds = 0;
};

DeviceCount fastest_count(Device& device, const std::vector<TargetPlane>& targets, const DescentSetup& setup,
                          size_t frames) {
  DeviceCount best{1, seconds_on(device, targets, setup, frames, 1)};
  const std::vector<int> open = open_devices();
  double opening = 0;
  size_t count = 1;
  for (const int number : equal_devices(list_devices(), device.info().number)) {
    if (number == device.info().number) continue;
    if (++count > frames) break;
    if (std::find(open.begin(), open.end(), number) == open.end()) opening += seconds_to_open_device;
    const double seconds = opening + seconds_on(device, targets, setup, frames, count);
    if (seconds < best.seconds) best = {count, seconds};
  }
  return best;
}

std::vector<Device*> fastest_for(const std::vector<TargetPlane>& targets, const DescentSetup& setup, size_t frames) {
  Device* const fastest =
      fastest_device(work_of({targets, setup, frames, frames}, nullptr).on_processor,
                     [&](Device& device) { return fastest_count(device, targets, setup, frames).seconds; });
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

}  // namespace

std::vector<Device*> devices_for_descent(const std::vector<TargetPlane>& targets, const DescentSetup& setup,
                                         size_t frames) {
  const DeviceChoice& choice = setup.params.device;
  if (choice.kind == DeviceKind::cpu) return {};
  if (choice.kind == DeviceKind::all) return open_equal_devices(0, frames);
  if (choice.kind == DeviceKind::opencl) return {&open_device(choice.number)};
  return fastest_for(targets, setup, frames);
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
