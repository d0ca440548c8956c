#include "holotrace/io/field/checkpoint_file.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/io/field/hdf5_access.h"
#include "holotrace/io/files/child_process.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

constexpr const char *numbers_name = "numbers", *arrays_name = "arrays";

using Shape = std::array<hsize_t, 3>;  // arrays, rows, columns

std::string number_of(const IterationState& job) { return fmt::format("{:016x}", job.job); }

// Calls transfer(shape in memory, place in the file) for array k. @return whether it succeeded
template <class Transfer>
bool for_array(hid_t data, const Shape& shape, size_t k, const Transfer& transfer) {
  const Shape start{k, 0, 0}, block{1, shape[1], shape[2]};
  const Handle memory(H5Screate_simple(2, block.data() + 1, nullptr), H5Sclose);
  const Handle place(H5Dget_space(data), H5Sclose);
  H5Sselect_hyperslab(place, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr);
  return transfer(memory, place) >= 0;
}

hid_t create_dataset(hid_t file, const char* name, hid_t type, int rank, const hsize_t* shape) {
  const Handle space(H5Screate_simple(rank, shape, nullptr), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, false);
  return H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
}

void write_state(const std::string& path, const IterationState& state) {
  const Silence silence;
  Handle file(create_hdf5(path), H5Fclose);
  {
    const hsize_t count = state.numbers.size();
    const Handle numbers(create_dataset(file, numbers_name, H5T_IEEE_F64LE, 1, &count), H5Dclose);
    require_written(numbers.valid() &&
                        H5Dwrite(numbers, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, state.numbers.data()) >= 0,
                    path);
    write_word(numbers, "job", number_of(state), path);
    write_word(numbers, "description", state.description, path);
    write_number(numbers, "updates", state.updates, path);
    const Array2D<float>& first = state.arrays.front();
    const Shape shape{state.arrays.size(), hsize_t(first.ny), hsize_t(first.nx)};
    const Handle arrays(create_dataset(file, arrays_name, H5T_IEEE_F32LE, 3, shape.data()), H5Dclose);
    require_written(arrays.valid(), path);
    for (size_t k = 0; k < state.arrays.size(); ++k)
      require_written(for_array(arrays, shape, k,
                                [&](hid_t memory, hid_t place) {
                                  return H5Dwrite(arrays, H5T_NATIVE_FLOAT, memory, place, H5P_DEFAULT,
                                                  state.arrays[k].values.data());
                                }),
                      path);
  }
  close_written(file, path);
}

double samples_of(const Shape& shape) { return double(shape[0]) * double(shape[1]) * double(shape[2]); }

// The sizes of a dataset. @throws Error, naming the file, for another number of dimensions
template <size_t rank>
std::array<hsize_t, rank> sizes_of(hid_t data, const char* name, const std::string& path) {
  const Handle space(H5Dget_space(data), H5Sclose);
  std::array<hsize_t, rank> sizes{};
  require(H5Sget_simple_extent_ndims(space) == int(rank),
          "{}: expected {} dimension(s) of \"{}\" in a checkpoint, got {}", path, rank, name,
          H5Sget_simple_extent_ndims(space));
  H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  return sizes;
}

// Sends a state, after a check that it belongs to the job.
void send_state(const std::string& path, const IterationState& job, ToParent& out) {
  const Silence silence;
  {
    const Hdf5Dataset numbers(path, numbers_name, Outside::refused);
    require(H5Aexists(numbers, "job") > 0 && H5Aexists(numbers, "description") > 0,
            "expected a checkpoint in {}, got another HDF5 file; give another path", path);
    const std::string description = read_word(numbers, "description", path);
    require(
        read_word(numbers, "job", path) == number_of(job),
        "expected the checkpoint of this job in {} ({}), got that of another one ({}); give another file, or remove "
        "this one to begin anew",
        path, job.description, description);
    out.text(description);
    out.value(int(read_number(numbers, "updates", path)));
    const hsize_t count = sizes_of<1>(numbers, numbers_name, path)[0];
    require_all_samples(numbers, double(count), path);
    out.allow(10, double(count) * sizeof(double) + double(1 << 28));
    std::vector<double> values(count);
    require(H5Dread(numbers, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0,
            "{}: expected numbers in \"{}\", which cannot be read; the file is damaged: remove it", path, numbers_name);
    out.list(values);
  }
  const Hdf5Dataset arrays(path, arrays_name, Outside::refused);
  const Shape shape = sizes_of<3>(arrays, arrays_name, path);
  require_all_samples(arrays, samples_of(shape), path);
  out.value(shape);
  const double bytes = samples_of(shape) * sizeof(float), slowest = 1e7;  // [bytes/s]
  const auto size = size_t(shape[1] * shape[2]);
  out.allow(10 + bytes / slowest, double(size) * sizeof(float) + 2 * arrays.chunk_bytes() + double(1 << 28));
  std::vector<float> values(size);
  for (size_t k = 0; k < shape[0]; ++k) {
    const auto read = [&](hid_t memory, hid_t place) {
      return H5Dread(arrays, H5T_NATIVE_FLOAT, memory, place, H5P_DEFAULT, values.data());
    };
    require(for_array(arrays, shape, k, read),
            "{}: expected {} arrays, of which the one with number {} cannot be read; the file is damaged: remove it",
            path, shape[0], k + 1);
    out.bytes(values.data(), values.size() * sizeof(float));
  }
}

}  // namespace

void save_checkpoint(const std::string& path, const IterationState& state) {
  require(!state.arrays.empty() && !state.numbers.empty(), "expected numbers and arrays in a state, got none");
  for (const Array2D<float>& array : state.arrays)
    require(array.nx == state.arrays.front().nx && array.ny == state.arrays.front().ny,
            "expected arrays of one size in a state, got {} × {} and {} × {}", state.arrays.front().nx,
            state.arrays.front().ny, array.nx, array.ny);
  write_atomically(path, [&](const std::string& temporary) { write_state(temporary, state); });
}

std::optional<IterationState> load_checkpoint(const std::string& path, const IterationState& job) {
  if (!is_there(path)) return std::nullopt;
  check_is_file(path, "a checkpoint");  // it is written again
  IterationState state;
  state.job = job.job;
  const auto read = [&](ToParent& out) { send_state(path, job, out); };
  read_in_child(path, read, [&](FromChild& from) {
    state.description = from.text();
    state.updates = from.value<int>();
    state.numbers = from.list<double>();
    const auto shape = from.value<Shape>();
    require(shape[1] < 1u << 30 && shape[2] < 1u << 30, "{}: expected a checkpoint, but it is damaged; remove it",
            path);
    require_memory(samples_of(shape) * sizeof(float), fmt::format("the checkpoint {}", path));
    for (size_t k = 0; k < shape[0]; ++k) {
      auto& values = state.arrays.emplace_back(int(shape[1]), int(shape[2])).values;
      from.bytes(values.data(), values.size() * sizeof(float));
    }
  });
  return state;
}

}  // namespace holotrace
