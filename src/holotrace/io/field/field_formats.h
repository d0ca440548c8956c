#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/io/files/outside.h"

// One pair of functions per file format of fields; field_file.cpp selects it by extension. write_… and create_…
// fill the file in place, for use inside write_atomically.

namespace holotrace {

/// The wavelengths of the cones of a stack's fields, if they differ; otherwise empty, and the first one is that of all.
template <class Real>
std::vector<double> different_cones(const std::vector<BasicField<Real>>& stack) {
  std::vector<double> cones;
  bool do_differ = false;
  for (const auto& field : stack) {
    cones.push_back(field.label.cone_wavelength);
    do_differ |= field.label.cone_wavelength != stack.front().label.cone_wavelength;
  }
  return do_differ ? cones : std::vector<double>();
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

}  // namespace holotrace
