#pragma once

#include "holotrace/data/params/encode.h"
#include "holotrace/data/summation_rates.h"
#include "holotrace/wave/shared/placed_field.h"

namespace holotrace {

/// What an encoder of encodes_on_devices takes: operations of the processor; on a device, the bytes that its kernels read
/// and write, those that return, and the memory beside the field. If it goes there band by band (banded_samples.h), the
/// bytes of all bands that go there and return, without tables.
struct EncodeCost {
  SummationWork on_processor;
  double moved = 0, returned = 0, memory = 0;
  double moved_in_bands = 0;
  double passes = 0;  ///< over all bands of rows
};

/// @throws Error  for a reference that is too steep for the pitch (off_axis.h)
EncodeCost encode_cost(const EncodeParams& params, const Grid& grid, double wavelength);

/// Whether the device has room for the whole field and what its encoder takes, once all that is kept for later is dropped.
bool fits_whole(const Device& device, const PlacedField& field, const EncodeParams& params);

/// The device that is expected to encode the field sooner than the processor; none if the processor is. The field's way
/// there counts, and that of the levels back, or of all bands there and back. Transforms of lines that a device does not hold in local memory
/// (line_transform.h) take longer than predicted.
Device* fastest_to_encode(const PlacedField& field, const EncodeParams& params);

}  // namespace holotrace
