#pragma once

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

void write_field_exr(const std::string& path, const Field& field);
Field read_field_exr(const std::string& path);

/// Whether an EXR file has the channels of a field.
bool is_field_exr(const std::string& path);

}  // namespace holotrace
