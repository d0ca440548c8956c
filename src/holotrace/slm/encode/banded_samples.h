#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <optional>

#include "holotrace/data/field.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// Rows of a field, and columns of its spectrum, that an encoder has on a device at a time.
struct EncodeBands {
  int rows = 0;     ///< an even number, or all
  int columns = 0;  ///< 1 without a spectrum

  bool fit() const { return rows > 0 && columns > 0; }
};

/// The largest bands for an encoder of encodes_on_devices.
/// @param memory   of the device that is free [bytes]; half of it is left to transforms
/// @param largest  what one buffer may have [bytes]
EncodeBands encode_bands(const EncodeParams& params, const Grid& grid, double wavelength, double memory,
                         double largest);

/// Memory for the sums of a row (device_moments.h, device_levels.h).
inline constexpr double bytes_of_row_sums = 16;

/// The memory that the smallest bands need: two rows, or a column [bytes].
double least_encode_memory(const EncodeParams& params, const Grid& grid, double wavelength);

/// Memory for tables of rows and columns, with a spectrum: scales or a reference wave, roots of unity, and two lines that a
/// transform works on; counts of moduli [bytes].
double encode_table_bytes(const EncodeParams& params, const Grid& grid, double wavelength);

/// A field on the processor whose rows go to an OpenCL device band by band, because the whole does not fit there. Its
/// encoders give the bytes of a field that fits (ShownPixels).
struct BandedSamples {
  Device* device = nullptr;
  std::shared_ptr<const Field> field;
  EncodeBands bands;
  std::optional<double> top{};  ///< rows arrive scaled to moduli of at most 1 by clip_moduli(band, top)
};

inline const Grid& grid_of(const BandedSamples& field) { return field.field->grid; }

/// Calls work(band, its first row) for each band from the top, under the device's lock. Transfer: 8 bytes per sample.
void for_each_band(const BandedSamples& field, const std::function<void(DeviceField& band, int first)>& work);

}  // namespace holotrace
