#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/slm/encode/sample_loops.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// A field that a panel is to show, U or its conjugate, with the moments of |U|. Field: on the processor, or on a device
/// (DeviceSamples). An encoder is written once for both; its loops over pixels are overloads: those of the processor are beside
/// the encoders, those of devices in device_levels.h, low_pass.h and here.
template <class AnyField>
struct ShownPixels {
  const AnyField& field;
  ModulusMoments moments;
  bool is_conjugate = false;
};

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

// The moduli of a field on an OpenCL device, in single precision. Errors are those of Device. Transfers, beside those of
// each_band, are said at each.

/// The power of two that scales moduli of up to `largest` to 1 … 2, exactly, so that their squares are within single
/// precision; 1 for 0. It is within 2^±126: moduli below 1e-38 stay smaller.
float unit_for(double largest);

/// The moments of |U| over the panel, within 1e-6 of them. They are not finite if a sample is not; any finite samples will do.
/// Samples whose parts are below 1e-38 may count as 0.
/// Transfer: 16 bytes per row.
ModulusMoments modulus_moments(const DeviceField& field);
ModulusMoments modulus_moments(const DeviceSamples& field);

/// The number of samples in each of so many equal steps of modulus from 0 to `largest`, and last those of `largest` itself.
/// A modulus within 2e-7 of `largest` of a step's edge may count for its neighbour.
/// @param at_once  samples, in whole rows, that are counted in 32 bits
/// Transfer: 4 bytes per step in and out, as often.
std::vector<int64_t> count_moduli(const DeviceField& field, double largest, int steps,
                                  int64_t at_once = int64_t(1) << 31);
std::vector<int64_t> count_moduli(const DeviceSamples& field, double largest, int steps);

/// Scales the samples on the device to moduli of at most 1: u/max(top, |u|).
/// @return Σ(|u|² − top²) of the samples above `top`
/// Transfer: 4 bytes per row.
double clip_moduli(const DeviceField& field, double top);
double clip_moduli(DeviceSamples& field, double top);

}  // namespace holotrace
