#include "holotrace/wave/propagate/propagate_on_device.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/wave/propagate/banded_propagation.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/propagate/irradiance.h"
#include "holotrace/wave/propagate/kept_propagators.h"
#include "holotrace/wave/propagate/propagation_cost.h"
#include "holotrace/wave/propagate/propagator_cache.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/shared/fastest_device.h"

namespace holotrace {
namespace {

using Kept = KeptPropagators<DevicePropagator>;

// Those of each device. Never destroyed: at the end of the program, drivers may have shut down before.
struct DeviceCaches {
  std::mutex mutex;
  std::map<const Device*, std::unique_ptr<Kept>> by_device;
};

DeviceCaches& caches() {
  static auto& all = *new DeviceCaches;
  return all;
}

Kept& kept_on(const Device& device) {
  const std::lock_guard lock(caches().mutex);
  std::unique_ptr<Kept>& kept = caches().by_device[&device];
  if (!kept) kept = std::make_unique<Kept>();
  return *kept;
}

std::atomic<double> given_device_limit = std::numeric_limits<double>::infinity();

// Drops those beyond the limit on every device.
void drop_beyond(double bytes) {
  std::vector<Kept*> all;  // a drop waits for the device, whose user may wait for the caches
  {
    const std::lock_guard lock(caches().mutex);
    for (const auto& [device, kept] : caches().by_device) all.push_back(kept.get());
  }
  for (Kept* const kept : all) kept->drop_beyond(bytes);
}

// The propagator as it is on the device, or as it will be sent there.
struct Prepared {
  KeptPropagator<DevicePropagator> kept;
  std::shared_ptr<const Propagator<float>> host{};
};

Prepared prepare(const Device& device, const PropagationQuestion& q) {
  Prepared prepared;
  if (auto found = kept_on(device).find(q))
    prepared.kept = std::move(*found);
  else
    prepared.host = cached_propagator<float>(q.grid, q.wavelength, q.distance, q.params, prepared.kept.listener());
  return prepared;
}

// The propagator on the device, with memory left for a field; none if the device's memory is too small for it, also without
// all others.
DevicePropagator* ready_propagator(Device& device, const PropagationQuestion& question, Prepared& prepared) {
  Kept& kept = kept_on(device);
  KeptPropagator<DevicePropagator>& ready = prepared.kept;
  if (!ready.propagator)
    if (const auto found = kept.find(question)) ready = *found;  // another thread has sent it meanwhile
  const DevicePropagationCost cost =
      ready.propagator ? ready.propagator->cost() : device_propagation_cost(device, *prepared.host);
  const double needed = cost.work + (ready.propagator ? 0 : cost.kept);
  if (needed > device.memory_left()) kept.drop_beyond(ready.propagator ? cost.kept : 0);  // this one was used last
  if (needed > device.memory_left() || cost.largest > device.info().largest_buffer) return nullptr;
  if (!ready.propagator) {
    ready.propagator = std::make_shared<DevicePropagator>(device, *prepared.host);
    kept.keep(question, ready, cost.kept, device_propagator_bytes(device));
  }
  return ready.propagator.get();
}

// A start of kernels and waiting for them, on slow drivers [s].
constexpr double seconds_to_start = 1e-3;

Device* fastest_for(const PropagationQuestion& question) {
  const auto plan = plan_propagator<float>(question.grid, question.wavelength, question.distance, question.params);
  return fastest_device(seconds_to_propagate(plan), [&](Device& device) {
    const DeviceRates rates = device_rates(device);
    DevicePropagationCost cost = device_propagation_cost(device, plan);
    double sent = kept_on(device).find(question) ? 0 : cost.kept;
    const double memory = device.memory_left() + double(device.use().bytes_held);  // once all others are dropped
    if (cost.kept + cost.work > memory || cost.largest > device.info().largest_buffer) {
      cost = banded_propagation_cost(device, plan, memory);
      sent = cost.kept;
    }
    return cost.moved / rates.moved_bytes + (cost.fields + sent) / rates.bytes + seconds_to_start;
  });
}

// A propagation, and how its result comes from a prepared propagator.
template <class Result>
struct Task {
  const Field& field;
  double distance;
  const PropagateParams& params;
  Result (DevicePropagator::*result)(const Field&, const Observer&);
  Result (*of_field)(Field);  // the same from the field

  PropagationQuestion question() const { return {field.grid, field.wavelength, distance, params}; }
};

// Band by band, on a device whose memory is too small for the whole.
template <class Result>
Result run_in_bands(Device& device, const Task<Result>& task, Prepared& prepared, const Observer& observer) {
  if (!prepared.host) {
    const PropagationQuestion q = task.question();
    prepared.host = cached_propagator<float>(q.grid, q.wavelength, q.distance, q.params, {});
    prepared.kept.propagator.reset();
  }
  const auto lock = device.lock();
  kept_on(device).drop_beyond(0);
  return task.of_field(BandedPropagation(device, prepared.host)(task.field, observer));
}

template <class Result>
std::optional<Result> run_whole(Device& device, const Task<Result>& task, Prepared& prepared,
                                const Observer& observer) {
  const auto lock = device.lock();
  DevicePropagator* const ready = ready_propagator(device, task.question(), prepared);
  if (!ready) return std::nullopt;
  return (ready->*task.result)(task.field, observer);
}

template <class Result>
Result run_on(Device& device, const Task<Result>& task, const Observer& observer) {
  // Before the device is locked: it runs on many threads, which may be waiting for the device.
  Prepared prepared = prepare(device, task.question());
  prepared.kept.tell(observer);
  try {
    std::optional<Result> there = run_whole(device, task, prepared, observer);
    if (!there) there = run_in_bands(device, task, prepared, observer);
    observer.fact("device", device.info().name);
    return std::move(*there);
  } catch (const Error&) {
    kept_on(device).drop_beyond(0);
    throw;
  }
}

template <class Result>
std::optional<Result> run_on_chosen(const Task<Result>& task, const Observer& observer) {
  const DeviceChoice& choice = task.params.device;
  require_one_device(choice, " for a propagation");
  if (choice.kind == DeviceKind::cpu) return std::nullopt;
  if (choice.kind == DeviceKind::opencl) return run_on(open_device(choice.number), task, observer);
  Device* const device = fastest_for(task.question());
  if (!device) return std::nullopt;
  try {
    return run_on(*device, task, observer);
  } catch (const Error& error) {
    observer.warn(fmt::format("the device auto: the processor took over, because {}", error.what()));
    return std::nullopt;
  }
}

}  // namespace

std::optional<Field> propagate_on_device(const Field& field, double distance, const PropagateParams& params,
                                         const Observer& observer) {
  return run_on_chosen<Field>(
      {field, distance, params, &DevicePropagator::operator(), [](Field there) { return there; }}, observer);
}

std::optional<Array2D<float>> irradiance_on_device(const Field& field, double distance, const PropagateParams& params,
                                                   const Observer& observer) {
  return run_on_chosen<Array2D<float>>(
      {field, distance, params, &DevicePropagator::irradiance, [](Field there) { return irradiance_of(there); }},
      observer);
}

void refuse_device_for_double(const PropagateParams& params) {
  require_one_device(params.device, " for a propagation");
  require(params.device.kind != DeviceKind::opencl,
          "expected a field in single precision to propagate on an OpenCL device, got one in double precision; use the "
          "device cpu, or leave out --double (in Python: a complex64 array)");
}

double device_propagator_bytes(const Device& device) {
  return std::min(device.info().memory / 4, given_device_limit.load());
}

void limit_device_propagators(double bytes) {
  given_device_limit = bytes;
  drop_beyond(bytes);
}

void drop_device_propagators() { drop_beyond(0); }

}  // namespace holotrace
