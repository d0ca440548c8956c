#pragma once

#include <complex>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/shared/device_field.h"
#include "holotrace/wave/tiles/tile_error.h"

namespace holotrace {

/// The tile-separable sum on a device (tile_sum.cl): a group of work items sums one tile. Its tiles have other shapes
/// than those of the processor, and their products are in single precision.

/// The largest tile of the device's shapes whose expected error, with a margin of 25 %, is below the tolerance; the most
/// accurate one if none is.
TileChoice choose_device_tile(const Device& device, const std::vector<DrawnPixel>& pixels, const SumGoal& goal);

/// Computes the pixels of `bounds`; their old values are overwritten.
///
/// If the panel has too few tiles for a large device, slices of the waves are summed at once, and added up on the device.
/// If memory for all waves or all samples is short, the samples are computed in bands of rows and the waves sent in
/// parts. The sum does not depend on that: same device, waves and bounds, same bytes.
///
/// @param waves   at least one, all with boxes within `bounds`
/// @throws Error  as Device does
///
/// Transfers: 48 bytes per wave to the device, 8 bytes per sample back. Cost: see multiply_adds_per_wave_pixel.
void sum_tiles_on_device(Device& device, const std::vector<PreparedWave>& waves, const LitGrid& panel, TileShape shape,
                         const PixelBox& bounds, Array2D<std::complex<float>>& samples, const Observer& observer);

/// The same into a field on its device, where the samples stay.
void sum_tiles_on_device(const std::vector<PreparedWave>& waves, TileShape shape, const PixelBox& bounds,
                         DeviceField& field, const Observer& observer);

/// Bytes that a sum sends to a device and fetches from it, if its memory holds all waves.
double transferred_bytes(size_t waves, const PixelBox& bounds);

/// Multiply-adds, or operations of the same cost, per wave and pixel: 3 of the products, and a share of the factors'
/// and of each wave's work.
double multiply_adds_per_wave_pixel(TileShape shape);

/// The kernel of that shape. @param function  "sum_tiles" or "multiply_factors"
Kernel tile_kernel(TileShape shape, const char* function);

}  // namespace holotrace
