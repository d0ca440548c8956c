#pragma once

#include <cstdint>

#include "holotrace/base/array.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/reference_wave.h"
#include "holotrace/slm/encode/shown_pixels.h"
#include "holotrace/wave/shared/device_field.h"

// What the loops over pixels of the encoders have in common on OpenCL devices, where they are kernels in single precision.
// Errors are those of Device.

namespace holotrace {

/// A kernel of pixel_levels.cl.
Kernel kernel_of_pixels(const char* name);

/// Calls run(band, its first row, work size, buffer) for the levels of the pixels of each band, and fetches them, unless `to` has
/// no values because the device only counts. Transfers:
/// those of each_band, and 2 bytes per pixel come back.
template <class Run>
void fetch_levels(const DeviceSamples& field, Array2D<uint16_t>& to, const Run& run) {
  each_band(field, [&](const DeviceField& band, int first) {
    const Grid& grid = band.head.grid;
    const DeviceBuffer levels = band.device->make_buffer(size_t(grid.pixels()) * sizeof(uint16_t), "levels");
    run(band, first, items_of_rows(grid.nx, grid.ny), levels);
    band.device->read(levels, to.size() > 0 ? to.row(first) : nullptr, levels.bytes());
  });
}

/// A reference wave at the rows of a band, for samples that are scaled by `unit`.
struct WaveThere {
  DeviceBuffer along_x, along_y;
  float unit = 1;
};

/// Transfer: 8 bytes per column and row of the band.
WaveThere send_wave(const ShownPixels<DeviceSamples>& shown, const ReferenceWave& wave, const DeviceField& band,
                    int first);

}  // namespace holotrace
