#include <array>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/hdf5_access.h"
#include "holotrace/io/field/metadata.h"

namespace holotrace {
namespace {

template <class Real>
hid_t native_real() {
  return sizeof(Real) == 4 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
}

// Makes the dataset "field" with its metadata, for the fields' grid and wavelengths, without samples.
template <class Real>
hid_t create_dataset(hid_t file, const std::vector<BasicField<Real>>& stack, hid_t properties,
                     const std::string& path) {
  const BasicField<Real>& field = stack.front();
  const Handle stored(complex_type(sizeof(Real), sizeof(Real) == 4 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE), H5Tclose);
  const std::array<hsize_t, 3> shape{stack.size(), hsize_t(field.grid.ny), hsize_t(field.grid.nx)};
  const bool is_one = stack.size() == 1;
  const Handle space(H5Screate_simple(is_one ? 2 : 3, shape.data() + (is_one ? 1 : 0), nullptr), H5Sclose);
  H5Pset_obj_track_times(properties, false);
  const hid_t data = H5Dcreate2(file, "field", stored, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  require_written(data >= 0, path);
  write_attributes(data, stack_metadata(stack), path);
  return data;
}

}  // namespace

template <class Real>
void write_fields_hdf5(const std::string& path, const std::vector<BasicField<Real>>& stack) {
  const Silence silence;
  const Grid& grid = stack.front().grid;
  Handle file(create_hdf5(path), H5Fclose);
  {
    const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    const Handle data(create_dataset(file, stack, properties, path), H5Dclose);
    const Handle memory(complex_type(sizeof(Real), native_real<Real>()), H5Tclose);
    const std::array<hsize_t, 3> block{1, hsize_t(grid.ny), hsize_t(grid.nx)};
    for (hsize_t n = 0; n < stack.size(); ++n) {
      const std::array<hsize_t, 3> start{n, 0, 0};
      const Handle field_space(H5Screate_simple(2, block.data() + 1, nullptr), H5Sclose);
      const Handle place(H5Dget_space(data), H5Sclose);
      if (stack.size() > 1) H5Sselect_hyperslab(place, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr);
      require_written(H5Dwrite(data, memory, field_space, place, H5P_DEFAULT, stack[n].samples.values.data()) >= 0,
                      path);
    }
  }
  close_written(file, path);
}

void create_fields_hdf5(const std::string& path, const std::vector<Field>& headers, int chunk_rows) {
  const Silence silence;
  Handle file(create_hdf5(path), H5Fclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const std::array<hsize_t, 3> chunk{1, hsize_t(chunk_rows), hsize_t(headers.front().grid.nx)};
  const bool is_one = headers.size() == 1;
  H5Pset_chunk(properties, is_one ? 2 : 3, chunk.data() + (is_one ? 1 : 0));
  H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY);  // every chunk gets its place from the start
  H5Pset_fill_time(properties, H5D_FILL_TIME_NEVER);
  { const Handle data(create_dataset(file, headers, properties, path), H5Dclose); }
  close_written(file, path);
}

std::vector<uint64_t> chunk_offsets_hdf5(const std::string& path, const std::vector<Field>& headers, int chunk_rows) {
  const Silence silence;
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const Handle data(file.valid() ? H5Dopen2(file, "field", H5P_DEFAULT) : -1, H5Dclose);
  require(data.valid(), "{}: expected an unfinished HDF5 field, got other bytes; delete it", path);
  const size_t first = headers.size() == 1 ? 1 : 0;  // a single field has no axis of wavelengths
  std::vector<uint64_t> offsets;
  for (hsize_t n = 0; n < headers.size(); ++n)
    for (hsize_t row = 0; row < hsize_t(headers.front().grid.ny); row += hsize_t(chunk_rows)) {
      const std::array<hsize_t, 3> at{n, row, 0};
      haddr_t address = HADDR_UNDEF;
      hsize_t size = 0;
      require(
          H5Dget_chunk_info_by_coord(data, at.data() + first, nullptr, &address, &size) >= 0 && address != HADDR_UNDEF,
          "{}: expected an unfinished HDF5 field with room for row {}, got none; delete the file", path, row);
      offsets.push_back(address);
    }
  return offsets;
}

template void write_fields_hdf5(const std::string&, const std::vector<Field>&);
template void write_fields_hdf5(const std::string&, const std::vector<FieldDouble>&);

}  // namespace holotrace
