#pragma once

#include <string>

#include "holotrace/data/field.h"

namespace holotrace {

/// Writes a field with its geometry. The extension picks the format:
///
/// - `.npy`  complex64 or complex128, shape (ny, nx), as numpy.load reads it, and beside it NAME.json
///           {pitch_m, wavelengths_m, z_m, image, filter}
/// - `.h5`   dataset "field" {r, i}, as h5py reads it, with the same metadata as attributes
/// - `.exr`  float channels "real" and "imag", with the same metadata as attributes; single precision only
///
/// @throws Error for another extension, and where write_atomically throws
template <class Real>
void save_field(const std::string& path, const BasicField<Real>& field);

/// Reads what save_field wrote. complex128 samples are rounded to complex64.
/// @throws Error naming the file for what is missing (also the sidecar), truncated, of another kind of
///         number or shape than (ny, nx) or (1, ny, nx), for several wavelengths, and for samples
///         that are not finite
Field load_field(const std::string& path);

/// As load_field, in double precision. complex64 samples are widened.
FieldDouble load_field_double(const std::string& path);

/// Whether a file is a field rather than an image: .npy and .h5 are, an EXR with channels "real" and "imag" is.
bool is_field_file(const std::string& path);

}  // namespace holotrace
