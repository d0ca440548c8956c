#pragma once

#include <atomic>
#include <complex>
#include <functional>
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

/// Light that is added to the sums of bands on a device, beside that of the waves.
struct LightOnDevice {
  /// If any. It may leave the samples unfinished once another device has failed, which sets `is_stopped`.
  std::function<void(const PixelBox& band, const DeviceBuffer& samples, const Observer& observer,
                     const std::atomic<bool>& is_stopped)>
      add;
  double bytes = 0;  ///< memory that it needs at least
};

/// Such light for all devices of a sum. It is computed in whole blocks of rows, from the top of the bounds on.
struct MoreLight {
  std::function<LightOnDevice(Device& device)> make{};  ///< if any; called on a thread of that device
  int rows = 1;                                         ///< of a block
};

/// Rows that each device sums if they share `rows` rows: a multiple of a tile's. They are whole blocks of other light, too, if a
/// device then has less to do than if both devices compute the block in which their shares meet.
int rows_of_share(int rows, size_t devices, TileShape shape, int block);

/// Most rows of other light that one device then computes.
int rows_computed_by_one(int rows, size_t devices, TileShape shape, int block);

/// Rows of a band that has `most` rows at most: whole tiles, and whole blocks, too, if there is room.
int rows_of_band(double most, TileShape shape, int block);

/// Computes the pixels of `bounds`; their old values are overwritten.
///
/// If the panel has too few tiles for a large device, slices of the waves are summed at once, and added up on the device.
/// If memory for all waves or all samples is short, the samples are computed in bands of rows and the waves sent in
/// parts. Several devices compute rows of their own at the same time, each on a thread of its own. The sum does not
/// depend on that: same kind of device, waves and bounds, same bytes.
///
/// @param devices  at least one; they must be equal (equal_devices)
/// @param waves   all with boxes within `bounds`
/// @throws Error  as Device does
///
/// Transfers: 48 bytes per wave to each device, 8 bytes per sample back. Cost: see multiply_adds_per_wave_pixel.
void sum_tiles_on_devices(const std::vector<Device*>& devices, PreparedWaves waves, const LitGrid& panel,
                          TileShape shape, const PixelBox& bounds, Array2D<std::complex<float>>& samples,
                          const Observer& observer, const MoreLight& more = {});

/// The same on one device.
inline void sum_tiles_on_device(Device& device, PreparedWaves waves, const LitGrid& panel, TileShape shape,
                                const PixelBox& bounds, Array2D<std::complex<float>>& samples, const Observer& observer,
                                const MoreLight& more = {}) {
  sum_tiles_on_devices({&device}, waves, panel, shape, bounds, samples, observer, more);
}

/// The same into a field on its device, where the samples stay.
void sum_tiles_on_device(PreparedWaves waves, TileShape shape, const PixelBox& bounds, DeviceField& field,
                         const Observer& observer, const MoreLight& more = {});

/// Bytes that a sum sends to a device and fetches from it, if its memory holds all waves.
double transferred_bytes(size_t waves, const PixelBox& bounds);

/// Multiply-adds, or operations of the same cost, per wave and pixel: 3 of the products, and a share of the factors'
/// and of each wave's work.
double multiply_adds_per_wave_pixel(TileShape shape);

/// The kernel of that shape. @param function  "sum_tiles" or "multiply_factors"
Kernel tile_kernel(TileShape shape, const char* function);

/// The text of tile_factor_kernel.h, for kernels that are compiled together with it.
const char* tile_factor_source();

}  // namespace holotrace
