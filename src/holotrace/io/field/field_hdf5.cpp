#include <array>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/hdf5_access.h"
#include "holotrace/io/field/metadata.h"

namespace holotrace {
namespace {

constexpr const char* filter_names[] = {"filter_u0_per_m", "filter_v0_per_m", "filter_half_u_per_m",
                                        "filter_half_v_per_m"};

hid_t complex_type(size_t bytes, hid_t real) {
  const hid_t type = H5Tcreate(H5T_COMPOUND, 2 * bytes);
  H5Tinsert(type, "r", 0, real);
  H5Tinsert(type, "i", bytes, real);
  return type;
}

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
  std::vector<double> wavelengths;
  for (const auto& one : stack) wavelengths.push_back(one.wavelength);
  write_number(data, "pitch_m", field.grid.pitch, path);
  write_numbers(data, "wavelengths_m", wavelengths, path);
  write_number(data, "z_m", field.z, path);
  if (field.grid.centre_x != 0) write_number(data, "centre_x_m", field.grid.centre_x, path);
  if (field.grid.centre_y != 0) write_number(data, "centre_y_m", field.grid.centre_y, path);
  write_word(data, "image", image_side_name(field.image), path);
  if (!field.name.empty()) write_word(data, "name", field.name, path);
  if (field.frame > 0) write_number(data, "frame", field.frame, path);
  if (field.cone_wavelength > 0) write_number(data, "cone_wavelength_m", field.cone_wavelength, path);
  if (field.filter) {
    const SpectralFilter& f = *field.filter;
    const double values[] = {f.u0, f.v0, f.half_u, f.half_v};
    for (int i = 0; i < 4; ++i) write_number(data, filter_names[i], values[i], path);
  }
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
          "{}: expected a place for row {}, got none; delete the file", path, row);
      offsets.push_back(address);
    }
  return offsets;
}

template <class Real>
std::vector<BasicField<Real>> read_fields_hdf5(const std::string& path) {
  const Silence silence;
  const Hdf5Dataset data(path, "field");
  const Handle type(H5Dget_type(data), H5Tclose);
  require(H5Tget_class(type) == H5T_COMPOUND && H5Tget_nmembers(type) == 2 && H5Tget_member_index(type, "r") >= 0 &&
              H5Tget_member_index(type, "i") >= 0,
          "{}: expected complex samples {{r, i}} in \"field\", got another kind of number; convert them to complex64",
          path);
  const Handle space(H5Dget_space(data), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  std::array<hsize_t, 3> shape{};
  if (rank == 2 || rank == 3) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  const bool has_wavelengths = rank == 3;
  const hsize_t count = has_wavelengths ? shape[0] : 1, ny = shape[has_wavelengths],
                nx = shape[size_t(has_wavelengths) + 1];
  require((rank == 2 || rank == 3) && count > 0 && ny > 0 && nx > 0 && count < (1u << 30) && ny < (1u << 30) &&
              nx < (1u << 30),
          "{}: expected the shape (ny, nx) or (wavelengths, ny, nx), got {} dimensions of {} × {}", path, rank, ny, nx);

  require_all_samples(data, double(count) * double(ny * nx), path);
  const std::vector<double> wavelengths = read_numbers(data, "wavelengths_m", hssize_t(count), path);
  BasicField<Real> field;
  field.grid = {int(nx), int(ny), read_number(data, "pitch_m", path)};
  if (H5Aexists(data, "z_m") > 0) field.z = read_number(data, "z_m", path);
  if (H5Aexists(data, "centre_x_m") > 0) field.grid.centre_x = read_number(data, "centre_x_m", path);
  if (H5Aexists(data, "centre_y_m") > 0) field.grid.centre_y = read_number(data, "centre_y_m", path);
  if (H5Aexists(data, "image") > 0) field.image = image_side_from(read_word(data, "image", path), path);
  if (H5Aexists(data, "name") > 0) field.name = read_word(data, "name", path);
  if (H5Aexists(data, "frame") > 0) field.frame = frame_from(read_number(data, "frame", path), path);
  if (H5Aexists(data, "cone_wavelength_m") > 0) field.cone_wavelength = read_number(data, "cone_wavelength_m", path);
  if (H5Aexists(data, filter_names[0]) > 0)
    field.filter = SpectralFilter{read_number(data, filter_names[0], path), read_number(data, filter_names[1], path),
                                  read_number(data, filter_names[2], path), read_number(data, filter_names[3], path)};
  const Handle memory(complex_type(sizeof(Real), native_real<Real>()), H5Tclose);
  std::vector<BasicField<Real>> stack;
  for (hsize_t n = 0; n < count; ++n) {
    field.wavelength = wavelengths[n];
    BasicField<Real>& one = stack.emplace_back(field);
    one.samples = Array2D<std::complex<Real>>(one.grid.ny, one.grid.nx);
    const std::array<hsize_t, 3> start{n, 0, 0}, block{1, ny, nx};
    const Handle field_space(H5Screate_simple(2, block.data() + 1, nullptr), H5Sclose);
    const Handle place(H5Dget_space(data), H5Sclose);
    if (has_wavelengths) H5Sselect_hyperslab(place, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr);
    require(H5Dread(data, memory, field_space, place, H5P_DEFAULT, one.samples.values.data()) >= 0,
            "{}: expected {} × {} complex samples, but they cannot be read; the file is truncated or damaged", path, nx,
            ny);
  }
  return stack;
}

template void write_fields_hdf5(const std::string&, const std::vector<Field>&);
template void write_fields_hdf5(const std::string&, const std::vector<FieldDouble>&);
template std::vector<Field> read_fields_hdf5(const std::string&);
template std::vector<FieldDouble> read_fields_hdf5(const std::string&);

}  // namespace holotrace
