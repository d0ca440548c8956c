#pragma once

#include <string>

#include "holotrace/data/light_field.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

/// Writes a focal stack as HDF5: the dataset "focal_stack" of float32, of the shape (planes, ny, nx, 3), or (planes,
/// ny, nx) for one channel; row 0 on top. Its attributes are "pitch_m", "distances_m" (one per plane), and "unit",
/// which is "W/m2/sr". The same stack gives the same bytes.
/// @throws Error  as check_focal_stack, for another extension than .h5, and where write_atomically throws
void save_focal_stack(const std::string& path, const FocalStack& stack);

/// Reads such a file, from any program: all kinds of real numbers are accepted. "unit" is not needed.
/// @throws Error  naming the file, if it is missing, truncated or not HDF5, lacks the dataset or an attribute, has
///                another shape, does not fit in memory, and as check_focal_stack
FocalStack load_focal_stack(const std::string& path, Outside outside = Outside::refused);

/// Whether a file is HDF5 and has the dataset "focal_stack".
bool is_focal_stack_file(const std::string& path);

}  // namespace holotrace
