#pragma once

#include <cstddef>
#include <string>

#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/opencl/device.h"

namespace holotrace {

/// A field whose samples are on an OpenCL device: complex floats, shape (ny, nx).
struct DeviceField {
  Device* device = nullptr;
  Field head{};  ///< all of the field but its samples
  DeviceBuffer samples{};
};

/// All of a field but its samples.
Field head_of(const Field& field);

/// That of its light on another window at z, as a propagation leaves it.
Field head_on(const Field& field, const Grid& window, double z);

/// Memory on a device for a field with that head; its samples are undefined.
/// @param what    what it is for, in the error for memory that is short
/// @throws Error  as Device does; so do the functions below
DeviceField make_device_field(Device& device, Field head, const std::string& what = "a field");

/// A copy on a device. Transfer: 8 bytes per sample.
DeviceField send(Device& device, const Field& field, const std::string& what = "a field");

/// A copy on the processor. Transfer: 8 bytes per sample.
Field fetch(const DeviceField& field);

/// Sets all samples to 0.
void clear(DeviceField& field);

/// Copies complex floats, row by row those of a box, into the field, on its device.
void put(const DeviceBuffer& from, const PixelBox& box, DeviceField& to);

/// Σ|u|² of the samples in a box, within 1e-6 of it for rows of up to a million samples. Transfer: 4 bytes per row.
double energy(const DeviceField& field, const PixelBox& box);

/// Optical power Σ|u|²·pitch² [W], with the same error and transfer.
double power(const DeviceField& field);

/// Work items of a group along a row of samples.
inline constexpr size_t samples_of_group = 64;

/// One work item for each sample of so many rows: get_global_id(0) is its column, or beyond the last one, and
/// get_global_id(1) its row. Their place in memory is that of sample_place_kernel.h, also for more than 2³¹ samples.
inline WorkSize items_of_rows(int columns, int rows) {
  return {(size_t(columns) + samples_of_group - 1) / samples_of_group, size_t(rows), samples_of_group, 1};
}

/// One group of work items for each row, which adds it up.
inline WorkSize groups_of_rows(int rows) { return {1, size_t(rows), samples_of_group, 1}; }

}  // namespace holotrace
