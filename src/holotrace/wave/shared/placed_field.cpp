#include "holotrace/wave/shared/placed_field.h"

#include <complex>
#include <limits>
#include <mutex>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

double bytes_of(const Field& head) { return double(head.grid.pixels()) * sizeof(std::complex<float>); }

// Rates are measured when they are first needed: a device that fails then is not one to wait for.
double seconds_to_move(const Field& head, Device& device) {
  try {
    return bytes_of(head) / device_rates(device).bytes;
  } catch (const Error&) {
    return std::numeric_limits<double>::infinity();
  }
}

}  // namespace

// Where the samples are. Nobody computes, transfers or releases memory of a device while it holds the mutex: those wait
// for other threads, which may ask for the same field.
struct PlacedField::State {
  struct Places {
    std::shared_ptr<Field> own{};  // here, if it was computed or fetched for this one
    std::shared_ptr<const Field> here{};
    std::shared_ptr<const DeviceField> there{};
    std::shared_ptr<const ComputeAgain> again{};
  };
  const Field head;

  State(Field head, Places places) : head(std::move(head)), places_(std::move(places)) {}

  Places places() {
    const std::lock_guard lock(mutex_);
    return places_;
  }
  // Puts the first field that comes; then it need not be computed again.
  std::shared_ptr<const Field> keep(Field field, bool is_lost) {
    auto kept = std::make_shared<Field>(std::move(field));
    Places dropped;
    const std::lock_guard lock(mutex_);
    if (!places_.here) places_.here = places_.own = std::move(kept);
    std::swap(dropped.again, places_.again);
    if (is_lost) std::swap(dropped.there, places_.there);
    return places_.here;
  }
  std::shared_ptr<const DeviceField> keep(std::shared_ptr<const DeviceField> sent) {
    std::shared_ptr<const DeviceField> dropped = sent;
    const std::lock_guard lock(mutex_);
    std::swap(dropped, places_.there);
    return sent;
  }
  // For the only owner of a field that is here.
  Field take() { return places_.own && places_.own.use_count() == 2 ? std::move(*places_.own) : *places_.here; }

 private:
  std::mutex mutex_{};
  Places places_;
};

PlacedField::PlacedField(Field field) {
  Field head = head_of(field);
  const auto own = std::make_shared<Field>(std::move(field));
  state_ = std::make_shared<State>(std::move(head), State::Places{own, own});
}

PlacedField::PlacedField(std::shared_ptr<const Field> field)
    : state_(std::make_shared<State>(head_of(*field), State::Places{{}, field})) {}

PlacedField::PlacedField(DeviceField field, ComputeAgain again) {
  Field head = field.head;
  State::Places places{{}, {}, std::make_shared<const DeviceField>(std::move(field))};
  if (again) places.again = std::make_shared<const ComputeAgain>(std::move(again));
  state_ = std::make_shared<State>(std::move(head), std::move(places));
}

PlacedField PlacedField::of(const Field& field) {
  return PlacedField(std::shared_ptr<const Field>(std::shared_ptr<const Field>(), &field));
}

const Field& PlacedField::head() const { return state_->head; }

std::shared_ptr<const Field> PlacedField::on_processor(const Observer& observer) const {
  const State::Places places = state_->places();
  if (places.here) return places.here;
  try {
    return state_->keep(fetch(*places.there), false);
  } catch (const Error& error) {
    if (!places.again) throw;
    warn_of_takeover(observer, error.what());
  }
  // The facts of its making were told before.
  return state_->keep((*places.again)({observer.on_progress, {}, observer.on_warning}), true);
}

std::shared_ptr<const Field> PlacedField::only_on_processor(const Observer& observer) const {
  auto here = on_processor(observer);
  state_->keep(std::shared_ptr<const DeviceField>());
  return here;
}

bool PlacedField::is_on(const Device& device) const {
  const auto there = state_->places().there;
  return there && there->device == &device;
}

std::shared_ptr<const DeviceField> PlacedField::on(Device& device, const Observer& observer) const {
  if (auto there = state_->places().there; there && there->device == &device) return there;
  const auto here = on_processor(observer);
  std::shared_ptr<const DeviceField> sent;
  {
    const auto lock = device.lock();
    make_room(device, bytes_of(head()));
    sent = std::make_shared<const DeviceField>(send(device, *here));
  }
  return state_->keep(std::move(sent));  // that may release memory of another device
}

double PlacedField::seconds_to_processor() const {
  const State::Places places = state_->places();
  return places.here ? 0 : seconds_to_move(head(), *places.there->device);
}

double PlacedField::seconds_to(Device& device) const {
  if (is_on(device)) return 0;
  return seconds_to_processor() + seconds_to_move(head(), device);
}

Field into_field(PlacedField field, const Observer& observer) {
  const auto here = field.on_processor(observer).get();
  return field.state_.use_count() == 1 ? field.state_->take() : *here;
}

}  // namespace holotrace
