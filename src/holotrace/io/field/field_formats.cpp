#include "holotrace/io/field/field_formats.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/npy.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

template <class Real>
constexpr const char* dtype_of = sizeof(Real) == 4 ? "<c8" : "<c16";

// Distances in the file between neighbouring samples (n, row, column) of an array (count, ny, nx) [samples].
struct Strides {
  size_t array, row, column;
};

// In C order the last index varies fastest, in Fortran order the first.
Strides strides_of(const std::vector<int64_t>& shape, bool fortran_order) {
  const size_t count = size_t(shape[0]), ny = size_t(shape[1]), nx = size_t(shape[2]);
  return fortran_order ? Strides{1, count, count * ny} : Strides{ny * nx, nx, 1};
}

template <class From, class To>
void copy_samples(const char* first, const Strides& strides, Array2D<std::complex<To>>& values) {
  for (int j = 0; j < values.ny; ++j)
    for (int i = 0; i < values.nx; ++i) {
      std::complex<From> sample;
      std::memcpy(&sample, first + (size_t(j) * strides.row + size_t(i) * strides.column) * sizeof sample,
                  sizeof sample);
      values(j, i) = std::complex<To>(sample);
    }
}

}  // namespace

template <class Real>
void write_npy(NewFile& file, const std::vector<const Array2D<std::complex<Real>>*>& stack) {
  std::vector<int64_t> shape{stack.front()->ny, stack.front()->nx};
  if (stack.size() > 1) shape.insert(shape.begin(), int64_t(stack.size()));
  const std::string header = npy_header(dtype_of<Real>, shape);
  file.put(header.data(), header.size());
  for (const auto* values : stack) file.put(values->values.data(), values->size() * sizeof(std::complex<Real>));
  file.check();
}

template <class Real>
std::vector<Array2D<std::complex<Real>>> read_npy(const std::string& path) {
  const std::string bytes = read_text(path);
  const NpyHeader header = read_npy_header(bytes, path);
  const bool is_single = header.dtype == "<c8", is_double = header.dtype == "<c16";
  require(is_single || is_double,
          "{}: expected complex64 or complex128 ('<c8' or '<c16'), got '{}'; convert it with numpy.astype", path,
          header.dtype);
  std::vector<int64_t> shape = header.shape;
  if (shape.size() == 2) shape.insert(shape.begin(), 1);
  require(shape.size() == 3 && std::all_of(shape.begin(), shape.end(), [](int64_t n) { return n > 0 && n < 1 << 30; }),
          "{}: expected the shape (ny, nx) or (wavelengths, ny, nx), got {}", path, format_shape(header.shape));
  const size_t count = size_t(shape[1]) * size_t(shape[2]), sample = is_single ? 8 : 16;
  const size_t present = bytes.size() - header.data_begin;
  const double expected = double(shape[0]) * double(count) * double(sample);  // may exceed 64 bits
  require(double(present) == expected,
          "{}: expected {} bytes of samples for shape {}, got {}; the file is truncated or damaged, write it again",
          path, expected, format_shape(header.shape), present);
  const double samples = double(shape[0]) * double(count);
  require_memory(double(bytes.size()) + samples * sizeof(std::complex<Real>), path);
  const Strides strides = strides_of(shape, header.fortran_order);
  std::vector<Array2D<std::complex<Real>>> stack;
  for (size_t n = 0; n < size_t(shape[0]); ++n) {
    const char* data = bytes.data() + header.data_begin + n * strides.array * sample;
    Array2D<std::complex<Real>>& values = stack.emplace_back(int(shape[1]), int(shape[2]));
    if (is_single)
      copy_samples<float>(data, strides, values);
    else
      copy_samples<double>(data, strides, values);
  }
  return stack;
}

template void write_npy(NewFile&, const std::vector<const Array2D<std::complex<float>>*>&);
template void write_npy(NewFile&, const std::vector<const Array2D<std::complex<double>>*>&);
template std::vector<Array2D<std::complex<float>>> read_npy(const std::string&);
template std::vector<Array2D<std::complex<double>>> read_npy(const std::string&);

void save_field_exr(const std::string& path, const Field& field) {
  ExrHeader header{field.grid.nx, field.grid.ny, {"real", "imag"}, {}, {}};
  flat_metadata(metadata_of(field), [&](const std::string& name, const nlohmann::ordered_json& value) {
    if (value.is_string())
      header.texts[name] = value;
    else
      header.numbers[name] = value;
  });
  write_exr(path, header, reinterpret_cast<const float*>(field.samples.values.data()));
}

bool is_field_exr(const std::string& path) {
  const std::optional<PictureHeader> header = read_picture_header(path);
  return header && header->channel("real") >= 0 && header->channel("imag") >= 0;
}

Field read_field_exr(const std::string& path) {
  const std::optional<Picture> picture = read_picture(path);
  require(picture.has_value(), "{}: expected an OpenEXR field, but it is not an image or is truncated; write it again",
          path);
  const int real = picture->channel("real"), imag = picture->channel("imag");
  require(real >= 0 && imag >= 0, "{}: expected the channels \"real\" and \"imag\" of a field, got other channels",
          path);

  Array2D<std::complex<float>> samples(picture->rows, picture->columns);
  const auto& values = std::get<std::vector<float>>(picture->samples);
  for (size_t i = 0; i < samples.size(); ++i) {
    const float* sample = values.data() + i * picture->channels.size();
    samples.values[i] = {sample[real], sample[imag]};
  }
  const auto find = [&](const std::string& name, const nlohmann::ordered_json&) -> nlohmann::json {
    if (const auto number = picture->numbers.find(name); number != picture->numbers.end()) return number->second;
    if (const auto text = picture->texts.find(name); text != picture->texts.end()) return text->second;
    return nullptr;
  };
  Field field = stack_of<float>(from_flat_metadata(all_metadata<Field>(), find), 1, path,
                                "add it in SI units, as an attribute")[0];
  take_samples(field, std::move(samples));
  return field;
}

}  // namespace holotrace
