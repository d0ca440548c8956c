// Fields from HDF5, read in a child process: libhdf5 crashes or hangs at some damaged files.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <tuple>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/printable.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/hdf5_access.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/child_process.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

// What precedes the samples in the pipe, beside texts and wavelengths.
struct Head {
  hsize_t count = 1, ny = 0, nx = 0;
  double pitch = 0, z = 0, centre_x = 0, centre_y = 0, frame = 0, cone_wavelength = 0;
  bool has_filter = false, is_transposed = false;
  std::array<double, 4> filter{};
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

// Numbers that belong to a field: attributes of its dataset, datasets beside it, or keys of the JSON file beside the
// file, for programs that write no attributes.
struct FieldNumbers {
  const Hdf5Dataset& data;
  const nlohmann::json& beside;
  const std::string& path;

  std::vector<double> all(const char* name) const {
    const std::vector<double> values = data.numbers(name);
    if (!values.empty() || !beside.contains(name)) return values;
    if (beside[name].is_number()) return {metadata_number(beside, sidecar_path(path), name)};
    return metadata_numbers(beside, sidecar_path(path), name);
  }

  std::vector<double> exactly(const char* name, size_t wanted) const {
    const std::vector<double> values = all(name);
    require(
        values.size() == wanted,
        "{}: expected {} number(s) \"{}\", got {}; add them in SI units, as an attribute of \"field\", as a variable "
        "beside it or as a key of {}",
        path, wanted, name, values.size(), sidecar_path(path));
    return values;
  }

  double one_or(const char* name, double fallback) const { return all(name).empty() ? fallback : exactly(name, 1)[0]; }
};

Head read_head(const Hdf5Dataset& data, const FieldNumbers& numbers, const std::string& path) {
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
  const auto number = [&](const char* name) { return numbers.one_or(name, 0); };
  head.pitch = numbers.exactly("pitch_m", 1)[0];
  head.z = number("z_m");
  head.centre_x = number("centre_x_m");
  head.centre_y = number("centre_y_m");
  head.frame = number("frame");
  head.cone_wavelength = number("cone_wavelength_m");
  head.has_filter = H5Aexists(data, filter_attributes[0]) > 0;
  for (size_t i = 0; head.has_filter && i < 4; ++i) head.filter[i] = read_number(data, filter_attributes[i], path);
  return head;
}

// The wavelengths of the cones of the fields.
std::vector<double> cones_of(const FieldNumbers& numbers, const Head& head) {
  if (numbers.all("cone_wavelengths_m").empty()) return std::vector<double>(head.count, head.cone_wavelength);
  return numbers.exactly("cone_wavelengths_m", head.count);
}

template <class Real>
void transpose(BasicField<Real>& field) {
  const Array2D<std::complex<Real>> columns = std::move(field.samples);
  std::swap(field.grid.nx, field.grid.ny);
  field.samples = Array2D<std::complex<Real>>(field.grid.ny, field.grid.nx);
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) field.samples(j, i) = columns(i, j);
}

std::string word(hid_t data, const char* name, const std::string& path) {
  return H5Aexists(data, name) > 0 ? read_word(data, name, path) : "";
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

template <class Real>
BasicField<Real> field_of(const Head& head, const std::string& image, const std::string& name,
                          const std::string& path) {
  // A child whose memory is damaged may send any numbers.
  require(head.ny > 0 && head.nx > 0 && head.ny < 1 << 30 && head.nx < 1 << 30,
          "{}: expected a field, but it is damaged", path);
  BasicField<Real> field;
  field.grid = {int(head.nx), int(head.ny), head.pitch};
  field.grid.centre_x = head.centre_x;
  field.grid.centre_y = head.centre_y;
  field.z = head.z;
  if (!image.empty()) field.image = image_side_from(image, path);
  field.label.name = printable(name);
  field.label.frame = frame_from(head.frame, path);
  field.label.cone_wavelength = head.cone_wavelength;
  if (head.has_filter) field.filter = SpectralFilter{head.filter[0], head.filter[1], head.filter[2], head.filter[3]};
  return field;
}

}  // namespace

template <class Real>
std::vector<BasicField<Real>> read_fields_hdf5(const std::string& path, Outside outside) {
  std::vector<BasicField<Real>> stack;
  std::error_code ignored;
  const bool has_sidecar = std::filesystem::exists(sidecar_path(path), ignored);
  const nlohmann::json beside = has_sidecar ? read_metadata(sidecar_path(path)) : nlohmann::json::object();
  const auto read = [&](ToParent& out) {
    const Silence silence;
    const Hdf5Dataset data(path, "field", outside, true);
    const FieldNumbers numbers{data, beside, path};
    const ComplexNames names = names_in(data, path);
    const Head head = read_head(data, numbers, path);
    out.value(head);
    out.text(word(data, "image", path));
    out.text(word(data, "name", path));
    out.list(numbers.exactly("wavelengths_m", head.count));
    out.list(cones_of(numbers, head));
    send_samples<Real>(data, head, names, path, out);
  };
  read_in_child(path, read, [&](FromChild& from) {
    const Head head = from.value<Head>();
    const std::string image = from.text(), name = from.text();
    const auto wavelengths = from.list<double>(), cones = from.list<double>();
    require(cones.size() == wavelengths.size(), "{}: expected a field, but it is damaged", path);
    BasicField<Real> field = field_of<Real>(head, image, name, path);
    require_memory(double(wavelengths.size()) * double(head.ny) * double(head.nx) * 2 * sizeof(Real), path);
    for (size_t n = 0; n < wavelengths.size(); ++n) {
      field.wavelength = wavelengths[n];
      field.label.cone_wavelength = cones[n];
      stack.push_back(field);
      stack.back().samples = Array2D<std::complex<Real>>(field.grid.ny, field.grid.nx);
      auto& values = stack.back().samples.values;
      from.bytes(values.data(), values.size() * sizeof values[0]);
      if (head.is_transposed) transpose(stack.back());
    }
  });
  return stack;
}

template std::vector<Field> read_fields_hdf5(const std::string&, Outside);
template std::vector<FieldDouble> read_fields_hdf5(const std::string&, Outside);

}  // namespace holotrace
