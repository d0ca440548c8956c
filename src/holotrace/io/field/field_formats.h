#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/data/field.h"

// One pair of functions per file format of fields; field_file.cpp picks by extension. Writers fill
// the file in place, for use inside write_atomically.

namespace holotrace {

/// Fields of one grid, plane, image side and filter, by wavelength.
template <class Real>
void write_fields_hdf5(const std::string& path, const std::vector<BasicField<Real>>& stack);
template <class Real>
std::vector<BasicField<Real>> read_fields_hdf5(const std::string& path);

/// A file as write_fields_hdf5 makes, in chunks of that many whole rows, with a fixed place for every sample and none
/// of them written yet: the same bytes for the same headers.
/// @param headers  fields without samples, of one grid
void create_fields_hdf5(const std::string& path, const std::vector<Field>& headers, int chunk_rows);

/// Where the chunks of such a file begin [bytes]: of the first field from the top on, then of the next.
std::vector<uint64_t> chunk_offsets_hdf5(const std::string& path, const std::vector<Field>& headers, int chunk_rows);

void write_field_exr(const std::string& path, const Field& field);
Field read_field_exr(const std::string& path);

/// Whether an EXR file has the channels of a field.
bool is_field_exr(const std::string& path);

}  // namespace holotrace
