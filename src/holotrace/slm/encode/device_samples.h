#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "holotrace/data/field.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// A field that an encoder has on an OpenCL device: all of it, or if that does not fit, one band of its rows after the other,
/// which come from the processor. The same holds for the columns of its spectrum. Levels do not depend on the number of parts.
struct DeviceSamples {
  Device* device = nullptr;
  Field head{};                                ///< all of the field but its samples
  int parts = 1;                               ///< in which rows and columns are there
  std::shared_ptr<const DeviceField> there{};  ///< the samples, for one part
  std::shared_ptr<const Field> here{};         ///< the samples, for more; a device that only counts needs none
  std::optional<double> top{};                 ///< bands arrive scaled to moduli of at most 1 by clip_moduli

  /// The field on the device that has it, or with `parts` > 1 on the processor.
  static DeviceSamples whole(std::shared_ptr<const DeviceField> field);
  static DeviceSamples in_parts(Device& device, std::shared_ptr<const Field> field, int parts);

  /// Rows of a band: an even number, because a pattern of two rows begins with each; or all.
  int rows_at_once() const;

  /// Columns of the spectrum that are transformed together, of so many.
  int columns_at_once(int columns) const;
};

/// Calls work(band, its first row) for each band from the top, under the device's lock. Transfer: for more than one part
/// 8 bytes per sample.
void each_band(const DeviceSamples& field, const std::function<void(const DeviceField& band, int first)>& work);

}  // namespace holotrace
