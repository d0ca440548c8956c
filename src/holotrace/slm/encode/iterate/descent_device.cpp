#include "holotrace/slm/encode/iterate/descent_device.h"

#include <algorithm>
#include <complex>

#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/wave/propagate/propagation_cost.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/shared/fastest_device.h"

namespace holotrace {
namespace {

// Of all updates.
struct DescentWork {
  double on_processor = 0;  // [s]
  double kept = 0;          // factors of propagations and targets, sent to a device [bytes]
  double moved = 0;         // read and written in its memory [bytes]
  double updates = 0;
};

// The fraction of updates that use a plane: the planes of its wavelength have their turns equally often.
double turns_of(const TargetPlane& plane, const std::vector<TargetPlane>& targets, const EncodeParams& params) {
  const auto is_of_colour = [&](const TargetPlane& other) { return other.wavelength == plane.wavelength; };
  const auto planes = std::count_if(targets.begin(), targets.end(), is_of_colour);
  return params.planes_per_update == 0 ? 1 : std::min(1.0, double(params.planes_per_update) / double(planes));
}

// Planes with pupils count as if they had none, and all updates take as many samples as the last ones. The panel's effects
// and views count neither for the processor nor for the device.
DescentWork work_of(const std::vector<TargetPlane>& targets, const DescentSetup& setup, size_t frames,
                    const Device* device) {
  constexpr double sample = sizeof(std::complex<float>);
  const EncodeParams& params = setup.params;
  const SampleGroup group = samples_of_update(frames, params.subpixels, 0, false);
  const double samples = double(samples_of(group, params.subpixels > 1 ? 1 : 4).size());
  Grid grid = setup.slm.grid;
  grid.nx *= params.subpixels;
  grid.ny *= params.subpixels;
  grid.pitch /= params.subpixels;
  DescentWork work;
  work.updates = iterations_of(params);
  const double pixels = double(grid.pixels()), of_frames = double(frames) * work.updates;
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
  }
  work.moved += 8 * sample * pixels * of_frames;  // drives, moments and slopes
  return work;
}

// Starts of the kernels of an update, and waiting for its sums, on slow drivers [s].
constexpr double seconds_to_start = 2e-3;

Device* fastest_for(const std::vector<TargetPlane>& targets, const DescentSetup& setup, size_t frames) {
  return fastest_device(work_of(targets, setup, frames, nullptr).on_processor, [&](Device& device) {
    const DeviceRates rates = device_rates(device);
    const DescentWork work = work_of(targets, setup, frames, &device);
    return work.moved / rates.moved_bytes + work.kept / rates.bytes + work.updates * seconds_to_start;
  });
}

}  // namespace

Device* device_for_descent(const std::vector<TargetPlane>& targets, const DescentSetup& setup, size_t frames) {
  const DeviceChoice& choice = setup.params.device;
  if (choice.kind == DeviceKind::cpu) return nullptr;
  if (choice.kind == DeviceKind::opencl) return &open_device(choice.number);
  return fastest_for(targets, setup, frames);
}

Device* device_for_projections(const std::vector<TargetPlane>& targets, const DescentSetup& setup) {
  EncodeParams params = setup.params;
  params.planes_per_update = 0;
  params.subpixels = 1;
  return device_for_descent(targets, {setup.slm, params}, 1);
}

}  // namespace holotrace
