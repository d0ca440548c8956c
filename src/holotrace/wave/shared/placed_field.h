#pragma once

#include <functional>
#include <memory>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// Computes a field on the processor, if the device (chosen by `auto`) that has its samples fails.
/// @param observer  gets the progress and the warnings
using ComputeAgain = std::function<Field(const Observer& observer)>;

/// A field on its way from stage to stage. Its samples are on the processor, or still on the OpenCL device that computed
/// them, so that the next stage there need not send them. Samples that a stage needs elsewhere are transferred once, and
/// kept in both places. A copy shares them; it may be used by other threads. Threads that ask at the same time for samples
/// that are not there may transfer or compute them each; one result is kept.
class PlacedField {
 public:
  explicit PlacedField(Field field);
  explicit PlacedField(std::shared_ptr<const Field> field);
  /// @param again  what to do if the samples cannot be fetched; without it, that is an error
  explicit PlacedField(DeviceField field, ComputeAgain again = {});

  /// Refers to `field` without a copy; `field` must live longer than this object and its copies.
  static PlacedField of(const Field& field);

  /// All of the field but its samples.
  const Field& head() const;

  /// Whether the field has no samples at all: no light.
  bool is_empty() const { return head().grid.pixels() == 0; }

  /// The field on the processor.
  /// @throws Error  as fetch does. If the field can be computed again, a warning says what failed instead, and the samples
  ///                on the device are given up
  std::shared_ptr<const Field> on_processor(const Observer& observer = {}) const;

  /// Whether its samples are on that device.
  bool is_on(const Device& device) const;

  /// The same. Samples on a device are given up; their memory is free unless others still use them.
  std::shared_ptr<const Field> only_on_processor(const Observer& observer = {}) const;

  /// The field on a device, where all that is kept for later makes room for it (make_room, stage_on_device.h).
  /// @throws Error  as send and on_processor do
  std::shared_ptr<const DeviceField> on(Device& device, const Observer& observer = {}) const;

  /// Seconds that its samples are expected to take on their way to the processor, or to a device, by the rates of
  /// stage_on_device.h; infinite for a device without rates, or if it fails when they are measured.
  double seconds_to_processor() const;
  double seconds_to(Device& device) const;

 private:
  friend Field into_field(PlacedField field, const Observer& observer);
  struct State;
  std::shared_ptr<State> state_;
};

/// The field on the processor; it is not copied if no other copy of the placed field is left.
Field into_field(PlacedField field, const Observer& observer = {});

}  // namespace holotrace
