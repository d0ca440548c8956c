#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <tuple>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/hdf5_access.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/child_process.h"
#include "holotrace/io/files/file.h"

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

// Fields from HDF5, read in a child process: libhdf5 crashes or hangs at some damaged files.

namespace {

// What precedes the metadata and the samples in the pipe.
struct Head {
  hsize_t count = 1, ny = 0, nx = 0;
  bool is_transposed = false;
};

ComplexNames names_in(hid_t data, const std::string& path) {
  const Handle type(H5Dget_type(data), H5Tclose);
  const std::optional<ComplexNames> names = complex_names(type);
  require(names.has_value(),
          "{}: expected complex samples {{r, i}} or {{real, imag}} in \"field\", got another kind of number; convert "
          "them to complex64",
          path);
  return *names;
}

Head read_head(const Hdf5Dataset& data, const std::string& path) {
  Head head;
  const Handle space(H5Dget_space(data), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  std::array<hsize_t, 3> shape{1, 0, 0};
  if (rank == 2 || rank == 3) H5Sget_simple_extent_dims(space, shape.data() + (rank == 2), nullptr);
  std::tie(head.count, head.ny, head.nx) = std::tuple_cat(shape);
  constexpr hsize_t limit = 1u << 30;
  require((rank == 2 || rank == 3) && head.count > 0 && head.ny > 0 && head.nx > 0 && head.count < limit &&
              head.ny < limit && head.nx < limit,
          "{}: expected the shape (ny, nx) or (wavelengths, ny, nx), got {} dimensions of {} × {}", path, rank, head.ny,
          head.nx);
  require_all_samples(data, double(head.count) * double(head.ny) * double(head.nx), path);
  head.is_transposed = H5Aexists(data, "MATLAB_class") > 0;  // MATLAB stores columns, one after the other
  return head;
}

template <class Real>
void transpose(BasicField<Real>& field) {
  const Array2D<std::complex<Real>> columns = std::move(field.samples);
  std::swap(field.grid.nx, field.grid.ny);
  field.samples = Array2D<std::complex<Real>>(field.grid.ny, field.grid.nx);
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) field.samples(j, i) = columns(i, j);
}

// Sends the samples in blocks of whole rows. Blocks are whole chunks, so that none is read or unpacked twice.
template <class Real>
void send_samples(const Hdf5Dataset& data, const Head& head, const ComplexNames& names, const std::string& path,
                  ToParent& out) {
  constexpr double block_bytes = 4 << 20;
  const double row = double(head.nx) * 2 * sizeof(Real), chunk_rows = double(data.chunk_rows(1));
  const double wanted = std::max(1.0, std::ceil(block_bytes / row / chunk_rows)) * chunk_rows;
  const auto rows = hsize_t(std::min(wanted, double(head.ny)));
  const double bytes = double(head.count) * double(head.ny) * row, slowest = 1e7;  // [bytes/s], unpacking included
  out.allow(10 + bytes / slowest, 2 * data.chunk_bytes() + 2 * double(rows) * row + double(1 << 28));

  const Handle memory(complex_type(sizeof(Real), sizeof(Real) == 4 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE, names),
                      H5Tclose);
  const Handle place(H5Dget_space(data), H5Sclose);
  const bool is_one = H5Sget_simple_extent_ndims(place) == 2;
  std::vector<std::complex<Real>> samples(rows * head.nx);
  for (hsize_t n = 0; n < head.count; ++n)
    for (hsize_t first = 0; first < head.ny; first += rows) {
      const std::array<hsize_t, 3> start{n, first, 0}, block{1, std::min(rows, head.ny - first), head.nx};
      const Handle block_space(H5Screate_simple(2, block.data() + 1, nullptr), H5Sclose);
      H5Sselect_hyperslab(place, H5S_SELECT_SET, start.data() + is_one, nullptr, block.data() + is_one, nullptr);
      require(H5Dread(data, memory, block_space, place, H5P_DEFAULT, samples.data()) >= 0,
              "{}: expected {} × {} complex samples, but they cannot be read; the file is truncated or damaged", path,
              head.nx, head.ny);
      out.bytes(samples.data(), block[1] * block[2] * sizeof samples[0]);
    }
}

}  // namespace

template <class Real>
std::vector<BasicField<Real>> read_fields_hdf5(const std::string& path, Outside outside) {
  std::vector<BasicField<Real>> stack;
  const std::string beside = sidecar_path(path);  // for programs that write no attributes
  nlohmann::json metadata = nlohmann::json::object();
  if (is_there(beside)) {
    const nlohmann::json given = read_metadata(beside);
    for (const auto& [key, value] : given.items())
      if (value.is_number() || value.is_array()) metadata[key] = value;
  }
  const auto read = [&](ToParent& out) {
    const Silence silence;
    const Hdf5Dataset data(path, "field", outside, true);
    const ComplexNames names = names_in(data, path);
    const Head head = read_head(data, path);
    out.value(head);
    out.text(metadata_bytes(data.metadata(all_stack_metadata(), path)));
    send_samples<Real>(data, head, names, path, out);
  };
  read_in_child(path, read, [&](FromChild& from) {
    const Head head = from.value<Head>();
    metadata.update(metadata_from_bytes(from.text(), path));
    // A child whose memory is damaged may send any numbers.
    require(
        head.count > 0 && head.ny > 0 && head.nx > 0 && head.ny < 1 << 30 && head.nx < 1 << 30 && head.count < 1 << 30,
        "{}: expected a field, but it is damaged", path);
    require_memory(double(head.count) * double(head.ny) * double(head.nx) * 2 * sizeof(Real), path);
    stack = stack_of<Real>(
        metadata, head.count, path,
        fmt::format("add it in SI units, as an attribute of \"field\", as a variable beside it or as a key of {}",
                    beside));
    for (BasicField<Real>& field : stack) {
      Array2D<std::complex<Real>> samples(int(head.ny), int(head.nx));
      from.bytes(samples.values.data(), samples.values.size() * sizeof samples.values[0]);
      take_samples(field, std::move(samples));
      if (head.is_transposed) transpose(field);
    }
  });
  return stack;
}

template std::vector<Field> read_fields_hdf5(const std::string&, Outside);
template std::vector<FieldDouble> read_fields_hdf5(const std::string&, Outside);

}  // namespace holotrace
