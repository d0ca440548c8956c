#include "holotrace/io/field/light_field_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/io/field/hdf5_access.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/child_process.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

namespace {

/// A dataset of pictures.
struct PictureDataset {
  const char* name;
  const char* noun;   ///< in messages
  const char* shape;  ///< of its numbers, for one channel
  size_t leading;     ///< number of dimensions before rows and columns of a picture
};
constexpr PictureDataset stack_dataset{"focal_stack", "a focal stack", "planes, rows, columns", 1};
constexpr PictureDataset field_dataset{"light_field", "a light field", "rows, columns, pixel rows, pixel columns", 2};

/// The leading dimensions, then rows, columns and channels of each picture.
using PictureShape = std::vector<hsize_t>;

size_t pictures_in(const PictureShape& shape) {
  size_t count = 1;
  for (size_t i = 0; i + 3 < shape.size(); ++i) count *= size_t(shape[i]);
  return count;
}

double picture_samples(const PictureShape& shape) {
  double samples = 1;
  for (const hsize_t size : shape) samples *= double(size);
  return samples;
}

/// Calls transfer(shape in memory, place in the file) for picture k. @return whether it succeeded
template <class Transfer>
bool for_picture(hid_t data, const PictureShape& shape, size_t k, const Transfer& transfer) {
  PictureShape start(shape.size(), 0), block = shape;
  for (size_t i = shape.size() - 3; i-- > 0; k /= size_t(shape[i])) start[i] = k % shape[i], block[i] = 1;
  const Handle memory(H5Screate_simple(3, block.data() + shape.size() - 3, nullptr), H5Sclose);
  const Handle place(H5Dget_space(data), H5Sclose);
  H5Sselect_hyperslab(place, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr);
  return transfer(memory, place) >= 0;
}

void write_pictures(const std::string& path, const PictureDataset& kind, const PictureShape& shape,
                    const std::vector<Image>& pictures, const nlohmann::ordered_json& metadata) {
  const Silence silence;
  Handle file(create_hdf5(path), H5Fclose);
  {
    const int rank = int(shape.size()) - (shape.back() == 1 ? 1 : 0);
    const Handle space(H5Screate_simple(rank, shape.data(), nullptr), H5Sclose);
    const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(properties, false);
    const Handle data(H5Dcreate2(file, kind.name, H5T_IEEE_F32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                      H5Dclose);
    require_written(data.valid(), path);
    write_attributes(data, metadata, path);
    write_word(data, "unit", "W/m2/sr", path);
    for (size_t k = 0; k < pictures.size(); ++k)
      require_written(for_picture(data, shape, k,
                                  [&](hid_t memory, hid_t place) {
                                    return H5Dwrite(data, H5T_NATIVE_FLOAT, memory, place, H5P_DEFAULT,
                                                    pictures[k].values.data());
                                  }),
                      path);
  }
  close_written(file, path);
}

/// The shape of a dataset. @throws Error, naming the file, for another one
PictureShape picture_shape(hid_t data, const PictureDataset& kind, const std::string& path) {
  const Handle space(H5Dget_space(data), H5Sclose);
  const int found = H5Sget_simple_extent_ndims(space);
  const size_t rank = found > 0 ? size_t(found) : 0, least = kind.leading + 2;
  PictureShape shape(std::max(rank, least + 1), 0);
  if (rank > 0) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  shape.resize(rank);
  const PictureShape as_found = shape;
  if (rank == least) shape.push_back(1);
  bool fits = shape.size() == least + 1 && (shape.back() == 1 || shape.back() == 3);
  constexpr hsize_t limit = 1u << 30;
  for (const hsize_t size : shape) fits = fits && size > 0 && size < limit;
  require(fits, "{}: expected the shape ({}) or ({}, 3) of \"{}\", got ({})", path, kind.shape, kind.shape, kind.name,
          fmt::join(as_found, ", "));
  return shape;
}

void send_pictures(const Hdf5Dataset& data, const PictureShape& shape, const std::string& path, ToParent& out) {
  const double count = double(pictures_in(shape)), bytes = picture_samples(shape) / count * sizeof(float);
  constexpr double slowest = 1e7, of_picture = 1e-4;  // [bytes/s]; [s]
  out.allow(10 + count * (bytes / slowest + of_picture), bytes + 2 * data.chunk_bytes() + double(1 << 28));
  std::vector<float> values(size_t(bytes) / sizeof(float));
  for (size_t k = 0; k < size_t(count); ++k) {
    const auto read = [&](hid_t memory, hid_t place) {
      return H5Dread(data, H5T_NATIVE_FLOAT, memory, place, H5P_DEFAULT, values.data());
    };
    require(for_picture(data, shape, k, read),
            "{}: expected {} x {} pixels in picture {}, but they cannot be read; the file is truncated or damaged",
            path, shape[shape.size() - 2], shape[shape.size() - 3], k + 1);
    out.bytes(values.data(), values.size() * sizeof(float));
  }
}

/// Reads a dataset in a child process. `fill(shape)` makes room for the pictures of a noun whose metadata are set, and returns them.
template <class Noun, class Fill>
Noun load_pictures(const std::string& path, const PictureDataset& kind, Outside outside, const Fill& fill) {
  check_file_exists(path, kind.noun);
  Noun noun;
  const auto read = [&](ToParent& out) {
    const Silence silence;
    const Hdf5Dataset data(path, kind.name, outside);
    const Handle type(H5Dget_type(data), H5Tclose);
    const H5T_class_t samples = H5Tget_class(type);
    require(samples == H5T_FLOAT || samples == H5T_INTEGER,
            "{}: expected real numbers in \"{}\", got another kind; convert them to float32", path, kind.name);
    const PictureShape shape = picture_shape(data, kind, path);
    require_all_samples(data, picture_samples(shape), path);
    for (const hsize_t size : shape) out.value(size);
    out.text(metadata_bytes(data.metadata(all_metadata<Noun>(), path)));
    send_pictures(data, shape, path, out);
  };
  read_in_child(path, read, [&](FromChild& from) {
    PictureShape shape(kind.leading + 3);
    constexpr hsize_t limit = 1u << 30;  // a child whose memory is damaged may send any numbers
    for (hsize_t& size : shape) {
      size = from.value<hsize_t>();
      require(size > 0 && size < limit, "{}: expected {}, but it is damaged", path, kind.noun);
    }
    constexpr double of_block = 64;  // of the heap, around the samples of each picture
    require_memory(picture_samples(shape) * sizeof(float) + double(pictures_in(shape)) * (sizeof(Image) + of_block),
                   fmt::format("{} in {}", kind.noun, path));
    const nlohmann::json metadata = metadata_from_bytes(from.text(), path);
    MetadataReader reader(metadata, path, fmt::format("add it in SI units, as an attribute of \"{}\"", kind.name));
    members(reader, noun);
    for (Image& picture : fill(noun, shape)) from.bytes(picture.values.data(), picture.values.size() * sizeof(float));
  });
  return noun;
}

/// Makes room for all pictures of a shape, with the pitch of their grid.
std::vector<Image>& make_room(std::vector<Image>& pictures, const PictureShape& shape, Grid& grid) {
  const size_t last = shape.size() - 1;
  grid.nx = int(shape[last - 1]), grid.ny = int(shape[last - 2]);
  for (size_t k = 0; k < pictures_in(shape); ++k)
    pictures.emplace_back(grid.ny, grid.nx, int(shape[last])).pitch = grid.pitch;
  return pictures;
}

template <class Check>
void check_in_file(const std::string& path, const Check& check) {
  try {
    check();
  } catch (const Error& error) {
    fail("{}: {}", path, error.what());
  }
}

bool has_dataset(const std::string& path, const char* name) try {
  if (extension_of(path) != ".h5" || !is_file(path)) return false;
  bool has_it = false;
  const auto read = [&](ToParent& out) {
    const Silence silence;
    const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    out.value(file.valid() && H5Lexists(file, name, H5P_DEFAULT) > 0);
  };
  read_in_child(path, read, [&](FromChild& from) { has_it = from.value<bool>(); });
  return has_it;
} catch (const Error&) {
  return false;  // damaged: the reader of fields says so
}

}  // namespace

void save_focal_stack(const std::string& path, const FocalStack& stack) {
  check_focal_stack(stack);
  require(extension_of(path) == ".h5", "expected .h5 for a focal stack, got {}", path);
  const PictureShape shape{stack.pictures.size(), hsize_t(stack.grid.ny), hsize_t(stack.grid.nx),
                           hsize_t(stack.pictures.front().channels)};
  write_atomically(path, [&](const std::string& temporary) {
    write_pictures(temporary, stack_dataset, shape, stack.pictures, metadata_of(stack));
  });
}

FocalStack load_focal_stack(const std::string& path, Outside outside) {
  FocalStack stack = load_pictures<FocalStack>(
      path, stack_dataset, outside, [&](FocalStack & read, const PictureShape& shape) -> auto& {
        require(read.distances.size() == shape[0],
                "{}: expected {} number(s) in \"distances_m\", one per plane, got {}", path, shape[0],
                read.distances.size());
        return make_room(read.pictures, shape, read.grid);
      });
  check_in_file(path, [&] { check_focal_stack(stack); });
  return stack;
}

void save_light_field(const std::string& path, const LightField& field) {
  check_light_field(field);
  check_radiance(field);
  require(extension_of(path) == ".h5", "expected .h5 for a light field, got {}", path);
  require(std::abs(field.cell_width() / field.cell_height() - 1) < 1e-9,
          "expected square cells in a light field to save, got {} x {} m", field.cell_width(), field.cell_height());
  LightField keys = field.without_views();
  keys.lens.pitch = field.cell_width();
  const PictureShape shape{hsize_t(field.rows), hsize_t(field.columns), hsize_t(field.plane.ny),
                           hsize_t(field.plane.nx), hsize_t(field.views.front().channels)};
  write_atomically(path, [&](const std::string& temporary) {
    write_pictures(temporary, field_dataset, shape, field.views, metadata_of(keys));
  });
}

LightField load_light_field(const std::string& path, Outside outside) {
  LightField field = load_pictures<LightField>(
      path, field_dataset, outside, [](LightField & read, const PictureShape& shape) -> auto& {
        read.rows = read.lens.ny = int(shape[0]);
        read.columns = read.lens.nx = int(shape[1]);
        return make_room(read.views, shape, read.plane);
      });
  check_in_file(path, [&] { check_light_field(field), check_radiance(field); });
  return field;
}

bool is_focal_stack_file(const std::string& path) { return has_dataset(path, stack_dataset.name); }
bool is_light_field_file(const std::string& path) { return has_dataset(path, field_dataset.name); }

}  // namespace holotrace
