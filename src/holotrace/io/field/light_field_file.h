#pragma once

#include <string>

#include "holotrace/data/light_field.h"
#include "holotrace/io/files/file.h"

// Focal stacks and light fields as HDF5: one dataset of pictures, in float32, and attributes in SI units.

namespace holotrace {

/// Writes the dataset "focal_stack", of the shape (planes, ny, nx, 3), or (planes, ny, nx) for one channel; row 0 on top. Its
/// attributes are "pitch_m", "distances_m" (one per plane), and "unit", which is "W/m2/sr". The same stack gives the same bytes.
/// @throws Error  as check_focal_stack, for another extension than .h5, and where write_atomically throws
void save_focal_stack(const std::string& path, const FocalStack& stack);

/// Reads such a file, from any program: all kinds of real numbers are accepted. "unit" is not needed.
/// @throws Error  naming the file, if it is missing, truncated or not HDF5, lacks the dataset or an attribute, has
///                another shape, does not fit in memory, and as check_focal_stack
FocalStack load_focal_stack(const std::string& path, Outside outside = Outside::refused);

/// Writes the dataset "light_field", of the shape (rows, columns, ny, nx, 3), or without the last for one channel: the views of the
/// cells, row 0 on top. Its attributes are "cell_m" (side of a cell), "lens_x_m", "lens_y_m" and "lens_z_m" (middle of the lens; 0 if left
/// out), "pitch_m", "centre_x_m" and "centre_y_m" (of the pixels in their plane), "distance_m" of that plane from the panel, and "unit".
/// @throws Error  as save_focal_stack, and for cells that are no squares
void save_light_field(const std::string& path, const LightField& field);

/// Reads such a file, from any program. The panel of the light field is not set.
/// @throws Error  as load_focal_stack does, and as check_light_field
LightField load_light_field(const std::string& path, Outside outside = Outside::refused);

/// Whether a file is HDF5 and has the dataset "focal_stack", or "light_field".
bool is_focal_stack_file(const std::string& path);
bool is_light_field_file(const std::string& path);

}  // namespace holotrace
