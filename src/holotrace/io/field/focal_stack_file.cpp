#include "holotrace/io/field/focal_stack_file.h"

#include <array>
#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/io/field/hdf5_access.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/child_process.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

namespace {

constexpr const char* dataset_name = "focal_stack";

using StackShape = std::array<hsize_t, 4>;  // planes, rows, columns, channels

/// Calls transfer(shape in memory, place in the file) for plane k. @return whether it succeeded
template <class Transfer>
bool for_plane(hid_t data, const StackShape& shape, size_t k, const Transfer& transfer) {
  const StackShape start{k, 0, 0, 0}, block{1, shape[1], shape[2], shape[3]};
  const Handle memory(H5Screate_simple(3, block.data() + 1, nullptr), H5Sclose);
  const Handle place(H5Dget_space(data), H5Sclose);
  H5Sselect_hyperslab(place, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr);
  return transfer(memory, place) >= 0;
}

void write_stack(const std::string& path, const FocalStack& stack) {
  const Silence silence;
  const Grid& grid = stack.grid;
  const int channels = stack.pictures.front().channels;
  const StackShape shape{stack.pictures.size(), hsize_t(grid.ny), hsize_t(grid.nx), hsize_t(channels)};
  Handle file(create_hdf5(path), H5Fclose);
  {
    const Handle space(H5Screate_simple(channels == 1 ? 3 : 4, shape.data(), nullptr), H5Sclose);
    const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(properties, false);
    const Handle data(H5Dcreate2(file, dataset_name, H5T_IEEE_F32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                      H5Dclose);
    require_written(data.valid(), path);
    write_attributes(data, metadata_of(stack), path);
    write_word(data, "unit", "W/m2/sr", path);
    for (size_t k = 0; k < stack.pictures.size(); ++k)
      require_written(for_plane(data, shape, k,
                                [&](hid_t memory, hid_t place) {
                                  return H5Dwrite(data, H5T_NATIVE_FLOAT, memory, place, H5P_DEFAULT,
                                                  stack.pictures[k].values.data());
                                }),
                      path);
  }
  close_written(file, path);
}

/// The shape of a stack's dataset. @throws Error, naming the file, for another one
StackShape shape_of(hid_t data, const std::string& path) {
  const Handle space(H5Dget_space(data), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  StackShape shape{0, 0, 0, 1};
  if (rank == 3 || rank == 4) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  constexpr hsize_t limit = 1u << 30;
  require((rank == 3 || rank == 4) && shape[1] > 0 && shape[2] > 0 && (shape[3] == 1 || shape[3] == 3) &&
              shape[0] < limit && shape[1] < limit && shape[2] < limit,
          "{}: expected the shape (planes, rows, columns) or (planes, rows, columns, 3) of \"{}\", got {} dimensions "
          "of {} x {} x {} x {}",
          path, dataset_name, rank, shape[0], shape[1], shape[2], shape[3]);
  require(shape[0] > 0, "{}: expected a focal stack of at least one plane, got none", path);
  return shape;
}

double samples_of(const StackShape& shape) {
  return double(shape[0]) * double(shape[1]) * double(shape[2]) * double(shape[3]);
}

void send_pictures(const Hdf5Dataset& data, const StackShape& shape, const std::string& path, ToParent& out) {
  const double plane = samples_of(shape) / double(shape[0]) * sizeof(float), slowest = 1e7;  // [bytes], [bytes/s]
  out.allow(10 + double(shape[0]) * plane / slowest, plane + 2 * data.chunk_bytes() + double(1 << 28));
  std::vector<float> values(size_t(plane) / sizeof(float));
  for (size_t k = 0; k < shape[0]; ++k) {
    const auto read = [&](hid_t memory, hid_t place) {
      return H5Dread(data, H5T_NATIVE_FLOAT, memory, place, H5P_DEFAULT, values.data());
    };
    require(for_plane(data, shape, k, read),
            "{}: expected {} x {} pixels in plane {}, but they cannot be read; the file is truncated or damaged", path,
            shape[2], shape[1], k + 1);
    out.bytes(values.data(), values.size() * sizeof(float));
  }
}

}  // namespace

void save_focal_stack(const std::string& path, const FocalStack& stack) {
  check_focal_stack(stack);
  require(extension_of(path) == ".h5", "expected .h5 for a focal stack, got {}", path);
  write_atomically(path, [&](const std::string& temporary) { write_stack(temporary, stack); });
}

FocalStack load_focal_stack(const std::string& path, Outside outside) {
  check_file_exists(path, "a focal stack");
  FocalStack stack;
  const auto read = [&](ToParent& out) {
    const Silence silence;
    const Hdf5Dataset data(path, dataset_name, outside);
    const Handle type(H5Dget_type(data), H5Tclose);
    const H5T_class_t kind = H5Tget_class(type);
    require(kind == H5T_FLOAT || kind == H5T_INTEGER,
            "{}: expected real numbers in \"{}\", got another kind; convert them to float32", path, dataset_name);
    const StackShape shape = shape_of(data, path);
    require_all_samples(data, samples_of(shape), path);
    out.value(shape);
    out.text(metadata_bytes(data.metadata(all_metadata<FocalStack>(), path)));
    send_pictures(data, shape, path, out);
  };
  read_in_child(path, read, [&](FromChild& from) {
    const auto shape = from.value<StackShape>();
    constexpr hsize_t limit = 1u << 30;  // a child whose memory is damaged may send any numbers
    require(shape[0] < limit && shape[1] < limit && shape[2] < limit && (shape[3] == 1 || shape[3] == 3),
            "{}: expected a focal stack, but it is damaged", path);
    require_memory(samples_of(shape) * sizeof(float), fmt::format("the focal stack {}", path));
    const nlohmann::json metadata = metadata_from_bytes(from.text(), path);
    MetadataReader reader(metadata, path, "add it in SI units, as an attribute of \"focal_stack\"");
    members(reader, stack);
    stack.grid.nx = int(shape[2]), stack.grid.ny = int(shape[1]);
    require(stack.distances.size() == shape[0], "{}: expected {} number(s) in \"distances_m\", one per plane, got {}",
            path, shape[0], stack.distances.size());
    for (size_t k = 0; k < shape[0]; ++k) {
      Image& picture = stack.pictures.emplace_back(stack.grid.ny, stack.grid.nx, int(shape[3]));
      picture.pitch = stack.grid.pitch;
      from.bytes(picture.values.data(), picture.values.size() * sizeof(float));
    }
  });
  try {
    check_focal_stack(stack);
  } catch (const Error& error) {
    fail("{}: {}", path, error.what());
  }
  return stack;
}

bool is_focal_stack_file(const std::string& path) try {
  if (extension_of(path) != ".h5" || !is_file(path)) return false;
  bool is_stack = false;
  const auto read = [&](ToParent& out) {
    const Silence silence;
    const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    out.value(file.valid() && H5Lexists(file, dataset_name, H5P_DEFAULT) > 0);
  };
  read_in_child(path, read, [&](FromChild& from) { is_stack = from.value<bool>(); });
  return is_stack;
} catch (const Error&) {
  return false;  // damaged: the reader of fields says so
}

}  // namespace holotrace
