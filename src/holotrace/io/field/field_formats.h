#pragma once

#include <complex>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/new_file.h"

// One pair of functions per file format of fields; field_file.cpp selects it by extension. write_… and create_…
// fill the file in place, for use inside write_atomically.

namespace holotrace {

/// Gives a field samples, and its grid their shape.
template <class Real>
void take_samples(BasicField<Real>& field, Array2D<std::complex<Real>> samples) {
  field.grid.nx = samples.nx;
  field.grid.ny = samples.ny;
  field.samples = std::move(samples);
}

/// Fields that share one grid, plane, image side and filter, one per wavelength.
template <class Real>
void write_fields_hdf5(const std::string& path, const std::vector<BasicField<Real>>& stack);
template <class Real>
std::vector<BasicField<Real>> read_fields_hdf5(const std::string& path, Outside outside);

/// Makes a file like write_fields_hdf5, in chunks of that many whole rows, with a fixed place for every sample, but no
/// samples. The same headers give the same bytes.
/// @param headers  fields without samples, of one grid
void create_fields_hdf5(const std::string& path, const std::vector<Field>& headers, int chunk_rows);

/// Offsets of the chunks of such a file [bytes]: those of the first field from the top down, then of the next field.
std::vector<uint64_t> chunk_offsets_hdf5(const std::string& path, const std::vector<Field>& headers, int chunk_rows);

/// Writes the file under its name, completely or not at all.
void save_field_exr(const std::string& path, const Field& field);
Field read_field_exr(const std::string& path);

/// Whether an EXR file has the channels of a field.
bool is_field_exr(const std::string& path);

/// Fills a file with complex arrays of one size in NumPy's format 1.0, C order, little endian: shape (ny, nx) for one
/// array, (count, ny, nx) for several.
/// Reference: numpy.lib.format (NEP 1).
template <class Real>
void write_npy(NewFile& file, const std::vector<const Array2D<std::complex<Real>>*>& stack);

/// Reads complex64 or complex128, shape (ny, nx) or (count, ny, nx), in C order or in Fortran order (which NumPy writes
/// for an array that was transposed).
/// @throws Error naming the file for any other content, and for a file that is too short for its shape
template <class Real>
std::vector<Array2D<std::complex<Real>>> read_npy(const std::string& path);

}  // namespace holotrace
