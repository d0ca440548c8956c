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
#include "holotrace/wave/propagate/device_propagator.h"
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

// Sends a propagator to the device. If memory is short, all others are dropped.
void send(Device& device, const Propagator<float>& host, KeptPropagator<DevicePropagator>& to) {
  const DevicePropagationCost cost = device_propagation_cost(device, host);
  if (cost.kept + cost.work > device.memory_left()) kept_on(device).drop_beyond(0);
  to.propagator = std::make_shared<DevicePropagator>(device, host);
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

// The propagator on the device, with memory left for a field.
DevicePropagator& ready_propagator(Device& device, const PropagationQuestion& question, Prepared& prepared) {
  Kept& kept = kept_on(device);
  KeptPropagator<DevicePropagator>& ready = prepared.kept;
  if (!ready.propagator)
    if (const auto found = kept.find(question)) ready = *found;  // another thread has sent it meanwhile
  if (!ready.propagator) {
    send(device, *prepared.host, ready);
    kept.keep(question, ready, ready.propagator->cost().kept, device_propagator_bytes(device));
  } else if (const DevicePropagationCost cost = ready.propagator->cost(); cost.work > device.memory_left()) {
    kept.drop_beyond(cost.kept);  // all others: this is the one that was used last
  }
  return *ready.propagator;
}

// A start of kernels and waiting for them, on slow drivers [s].
constexpr double seconds_to_start = 1e-3;

Device* fastest_for(const PropagationQuestion& question) {
  const auto plan = plan_propagator<float>(question.grid, question.wavelength, question.distance, question.params);
  return fastest_device(seconds_to_propagate(plan), [&](Device& device) {
    const DeviceRates rates = device_rates(device);
    const DevicePropagationCost cost = device_propagation_cost(device, plan);
    const double sent = kept_on(device).find(question) ? 0 : cost.kept;
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

  PropagationQuestion question() const { return {field.grid, field.wavelength, distance, params}; }
};

template <class Result>
Result run_on(Device& device, const Task<Result>& task, const Observer& observer) {
  const PropagationQuestion question = task.question();
  // Before the device is locked: it runs on many threads, which may be waiting for the device.
  Prepared prepared = prepare(device, question);
  prepared.kept.tell(observer);
  const auto lock = device.lock();
  try {
    Result there = (ready_propagator(device, question, prepared).*task.result)(task.field, observer);
    observer.fact("device", device.info().name);
    return there;
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
  return run_on_chosen<Field>({field, distance, params, &DevicePropagator::operator()}, observer);
}

std::optional<Array2D<float>> irradiance_on_device(const Field& field, double distance, const PropagateParams& params,
                                                   const Observer& observer) {
  return run_on_chosen<Array2D<float>>({field, distance, params, &DevicePropagator::irradiance}, observer);
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
