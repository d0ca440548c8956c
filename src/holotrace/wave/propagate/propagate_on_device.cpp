#include "holotrace/wave/propagate/propagate_on_device.h"

#include <algorithm>
#include <atomic>
#include <complex>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/propagate/propagator_cache.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

struct ReadyPropagator {
  DevicePropagator propagator;
  DeviceUse use;  // as it was forecast
};
using Kept = KeptPropagators<ReadyPropagator>;

// Those of each device. Never destroyed: at the end of the program, drivers may have shut down before.
struct DeviceCaches {
  std::mutex mutex;
  std::map<const Device*, std::unique_ptr<Kept>> by_device;
};

Kept& kept_on(const Device& device);

DeviceCaches& caches() {
  static auto& all = *[] {
    keep_until_room_is_short({.bytes = [](const Device& device) { return kept_on(device).bytes(); },
                              .drop = [](const Device& device) { kept_on(device).drop_beyond(0); }});
    return new DeviceCaches;
  }();
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
  KeptPropagator<ReadyPropagator> kept;
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

// The propagator on the device, with memory left for a field, of which so many bytes are there already; none if the
// device's memory is too small for it, also without all others.
DevicePropagator* ready_propagator(Device& device, const PropagationQuestion& question, Prepared& prepared,
                                   double present) {
  Kept& kept = kept_on(device);
  KeptPropagator<ReadyPropagator>& ready = prepared.kept;
  if (!ready.propagator)
    if (const auto found = kept.find(question)) ready = *found;  // another thread has sent it meanwhile
  const DeviceUse use =
      ready.propagator ? ready.propagator->use : forecast_propagation(device, *prepared.host, device.memory_left());
  const double held = double(use.bytes_held),
               needed = double(use.most_released()) - present + (ready.propagator ? 0 : held);
  if (needed > device.memory_left()) kept.drop_beyond(ready.propagator ? held : 0);  // this one was used last
  if (needed > device.memory_left() || double(use.largest_buffer) > device.info().largest_buffer) return nullptr;
  if (!ready.propagator) {
    ready.propagator =
        std::make_shared<ReadyPropagator>(ReadyPropagator{DevicePropagator(device, *prepared.host), use});
    kept.keep(question, ready, held, device_propagator_bytes(device));
  }
  return &ready.propagator->propagator;
}

// A start of kernels and waiting for them, on slow drivers [s].
constexpr double seconds_to_start = 1e-3;

// What whole(propagator) returns on a device; if its memory is too small for that, what in_bands(propagator of the
// processor) returns. @param present  bytes of the input that are there already
template <class Whole, class InBands>
auto with_propagator(Device& device, const PropagationQuestion& q, double present, const Observer& observer,
                     const Whole& whole, const InBands& in_bands) {
  // Before the device is locked: it runs on many threads, which may be waiting for the device.
  Prepared prepared = prepare(device, q);
  prepared.kept.tell(observer);
  try {
    {
      const auto lock = device.lock();
      if (DevicePropagator* const ready = ready_propagator(device, q, prepared, present)) return whole(*ready);
    }
    if (!prepared.host) {
      prepared.host = cached_propagator<float>(q.grid, q.wavelength, q.distance, q.params, {});
      prepared.kept.propagator.reset();
    }
    const auto lock = device.lock();
    kept_on(device).drop_beyond(0);
    return in_bands(prepared.host);
  } catch (const Error&) {
    kept_on(device).drop_beyond(0);
    throw;
  }
}

// A field of the processor that is to be propagated.
struct Task {
  const Field& field;
  double distance;
  const PropagateParams& params;
};

// What result(field at the output window) returns, for a field on a device or, if its memory is too small for the whole, on
// the processor.
template <class Result>
auto run_on_chosen(const Task& task, const Observer& observer, const Result& result) {
  const Field& field = task.field;
  const double distance = task.distance;
  const PropagateParams& params = task.params;
  require_one_device(params.device, " for a propagation");
  const PropagationQuestion question(field.grid, field.wavelength, distance, params);
  const auto fastest = [&] {
    const PropagationForecast forecast(field.grid, field.wavelength, distance, params);
    const double in = double(field.samples.size()) * sizeof(std::complex<float>);
    return fastest_device(forecast.on_processor(), [&](Device& device) {
      return (in + forecast.bytes_out()) / device_rates(device).bytes + forecast.on_device(device);
    });
  };
  return on_chosen_device(params.device, observer, fastest, [&](Device& device) {
    return with_propagator(
        device, question, 0, observer,
        [&](DevicePropagator& propagator) {
          return result(propagator(send(device, field, "a propagation"), observer));
        },
        [&](const auto& propagator) { return result(BandedPropagation(device, propagator)(field, observer)); });
  });
}

}  // namespace

DeviceField propagate(const DeviceField& field, double distance, const PropagateParams& params,
                      const Observer& observer) {
  const Field& head = field.head;
  if (const auto shift = whole_shift(head.grid, head.wavelength, distance, params)) {
    const auto lock = field.device->lock();
    make_room(*field.device, double(shift->window.pixels()) * sizeof(std::complex<float>));
    return on_window(field, *shift);
  }
  return with_propagator(
      *field.device, {head.grid, head.wavelength, distance, params}, double(field.samples.bytes()), observer,
      [&](DevicePropagator& propagator) { return propagator(field, observer); },
      [&](const auto& propagator) {
        return send(*field.device, BandedPropagation(*field.device, propagator)(fetch(field), observer));
      });
}

std::optional<Field> propagate_on_device(const Field& field, double distance, const PropagateParams& params,
                                         const Observer& observer) {
  struct Result {
    Field operator()(const DeviceField& there) const { return fetch(there); }
    Field operator()(Field here) const { return here; }
  };
  return run_on_chosen({field, distance, params}, observer, Result());
}

std::optional<Array2D<float>> irradiance_on_device(const Field& field, double distance, const PropagateParams& params,
                                                   const Observer& observer) {
  struct Result {
    Array2D<float> operator()(const DeviceField& there) const {
      const DeviceBuffer irradiance = irradiance_of(there);
      auto here = Array2D<float>::unset(there.head.grid.ny, there.head.grid.nx);
      there.device->read(irradiance, here.values.data(), irradiance.bytes());
      return here;
    }
    Array2D<float> operator()(const Field& here) const { return irradiance_of(here); }
  };
  return run_on_chosen({field, distance, params}, observer, Result());
}

PropagationForecast::PropagationForecast(const Grid& grid, double wavelength, double distance,
                                         const PropagateParams& params)
    : question_(grid, wavelength, distance, params),
      bytes_out_(double(propagation_output(grid, params).pixels()) * sizeof(std::complex<float>)) {
  if (!whole_shift(grid, wavelength, distance, params))
    plan_ = plan_propagator<float>(grid, wavelength, distance, params);
}

double PropagationForecast::on_processor() const { return plan_ ? seconds_to_propagate(*plan_) : 0; }

double PropagationForecast::on_device(Device& device) const {
  if (!plan_) return 0;
  const auto kept = kept_on(device).find(question_);
  DeviceUse use = kept ? kept->propagator->use : forecast_propagation(device, *plan_);
  if (double(use.most_held) > device.memory() || double(use.largest_buffer) > device.info().largest_buffer) {
    // Once all others are dropped. The fields are sent for every band; the caller counts them once.
    use = forecast_banded_propagation(device, *plan_, device.memory());
    use.bytes_in -= std::min(use.bytes_in, size_t(bytes_of_fields(*plan_)));
  } else if (kept) {
    use.bytes_in = use.transfers = 0;
  }
  return predict_seconds(use, device_rates(device)) + seconds_to_start;
}

double PropagationForecast::bytes_out() const { return bytes_out_; }

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
