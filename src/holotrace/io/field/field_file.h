#pragma once

#include <string>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

/// Writes fields that differ only in wavelength (a field in colour), with their geometry. The extension selects the
/// format:
///
/// - `.npy`  complex64 or complex128, shape (ny, nx) for one wavelength, (wavelengths, ny, nx) for several, as
///           numpy.load reads it, and beside it NAME.npy.json {pitch_m, wavelengths_m, z_m, image, centre_x_m, centre_y_m,
///           name, frame, filter}. The centre is left out if it is on the axis, other keys if they are empty.
/// - `.h5`   dataset "field" {r, i} of that shape, as h5py reads it, with the same metadata as attributes
/// - `.exr`  float channels "real" and "imag", with the same metadata as attributes; one wavelength in single
///           precision only
///
/// @throws Error for no field, fields of different grids, planes, image sides, filters, names or frames, another
///         extension, and where write_atomically throws
template <class Real>
void save_fields(const std::string& path, const std::vector<BasicField<Real>>& stack);

/// Reads what save_fields wrote, one field per wavelength. complex128 samples are rounded to complex64.
/// @param outside  whether an HDF5 file may have its samples in files outside its folder
/// @throws Error naming the file if it or its sidecar is missing or truncated, has another kind of
///         number or a shape other than (ny, nx) or (wavelengths, ny, nx), or has samples that are not finite
std::vector<Field> load_fields(const std::string& path, Outside outside = Outside::refused);

/// Like load_fields, in double precision. complex64 samples are widened.
std::vector<FieldDouble> load_fields_double(const std::string& path, Outside outside = Outside::refused);

/// Like save_fields, for one field.
template <class Real>
void save_field(const std::string& path, const BasicField<Real>& field);

/// Like load_fields, for one field. @throws Error also for several wavelengths
Field load_field(const std::string& path, Outside outside = Outside::refused);
FieldDouble load_field_double(const std::string& path, Outside outside = Outside::refused);

/// Whether a file is a field rather than an image: .npy and .h5 are fields, and an EXR with channels "real" and "imag".
bool is_field_file(const std::string& path);

/// Writes stacks of fields as NAME, NAME_2, … (save_fields). A file NAME_2 that an earlier call with that name did not
/// write is set aside (set_aside). The sidecar NAME.EXT.json of the first records which files those are.
/// @return  a sentence for each file that was set aside
template <class Real>
std::vector<std::string> save_field_series(const std::string& path,
                                           const std::vector<std::vector<BasicField<Real>>>& stacks);

}  // namespace holotrace
