#pragma once

#include "holotrace/data/params/encode.h"
#include "holotrace/data/summation_rates.h"
#include "holotrace/wave/shared/placed_field.h"

namespace holotrace {

/// What an encoder of encodes_on_devices takes: operations of the processor; on a device, the bytes that its kernels read
/// and write, those that return, and the memory beside the field.
struct EncodeCost {
  SummationWork on_processor;
  double moved = 0, returned = 0, memory = 0;
};

/// @throws Error  for a reference that is too steep for the pitch (off_axis.h)
EncodeCost encode_cost(const EncodeParams& params, const Grid& grid, double wavelength);

/// The device that is expected to encode the field sooner than the processor; none if the processor is. The field's way
/// there counts, and that of the levels back. Transforms of lines that a device does not hold in local memory
/// (line_transform.h) take longer than predicted.
Device* fastest_to_encode(const PlacedField& field, const EncodeParams& params);

}  // namespace holotrace
