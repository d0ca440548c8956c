#include "holotrace/wave/shared/placed_field.h"

#include <complex>
#include <mutex>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/shared/on_chosen_device.h"

namespace holotrace {
namespace {

double seconds_to_move(const Field& head, Device& device) {
  return double(head.grid.pixels()) * sizeof(std::complex<float>) / device_rates(device).bytes;
}

}  // namespace

struct PlacedField::State {
  Field head;
  std::function<Field()> again{};
  std::mutex mutex{};            // of the pointers below
  std::shared_ptr<Field> own{};  // here, if it was computed or fetched for this one
  std::shared_ptr<const Field> here{};
  std::shared_ptr<const DeviceField> there{};

  explicit State(Field head) : head(std::move(head)) {}
  void keep(Field field) { here = own = std::make_shared<Field>(std::move(field)); }
};

PlacedField::PlacedField(Field field) : state_(std::make_shared<State>(head_of(field))) {
  state_->keep(std::move(field));
}

PlacedField::PlacedField(std::shared_ptr<const Field> field) : state_(std::make_shared<State>(head_of(*field))) {
  state_->here = std::move(field);
}

PlacedField::PlacedField(DeviceField field, std::function<Field()> again)
    : state_(std::make_shared<State>(field.head)) {
  state_->again = std::move(again);
  state_->there = std::make_shared<const DeviceField>(std::move(field));
}

PlacedField PlacedField::of(const Field& field) {
  return PlacedField(std::shared_ptr<const Field>(std::shared_ptr<const Field>(), &field));
}

const Field& PlacedField::head() const { return state_->head; }

std::shared_ptr<const Field> PlacedField::on_processor(const Observer& observer) const {
  const std::lock_guard lock(state_->mutex);
  if (state_->here) return state_->here;
  try {
    state_->keep(fetch(*state_->there));
  } catch (const Error& error) {
    if (!state_->again) throw;
    warn_of_takeover(observer, error.what());
    state_->keep(state_->again());
  }
  return state_->here;
}

std::shared_ptr<const DeviceField> PlacedField::on(Device& device, const Observer& observer) const {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->there && state_->there->device == &device) return state_->there;
  }
  auto sent = std::make_shared<const DeviceField>(send(device, *on_processor(observer)));
  const std::lock_guard lock(state_->mutex);
  return state_->there = std::move(sent);
}

double PlacedField::seconds_to_processor() const {
  const std::lock_guard lock(state_->mutex);
  return state_->here ? 0 : seconds_to_move(state_->head, *state_->there->device);
}

double PlacedField::seconds_to(Device& device) const {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->there && state_->there->device == &device) return 0;
  }
  return seconds_to_processor() + seconds_to_move(state_->head, device);
}

Field into_field(PlacedField field, const Observer& observer) {
  field.on_processor(observer);
  PlacedField::State& state = *field.state_;
  // `own` and `here` are the two that hold it.
  if (field.state_.use_count() == 1 && state.own && state.own.use_count() == 2) return std::move(*state.own);
  return *state.here;
}

}  // namespace holotrace
