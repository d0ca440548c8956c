#include "holotrace/io/field/field_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {
namespace {

[[noreturn]] void fail_extension(const std::string& path) {
  fail("expected a field file .npy, .h5 or .exr, got {}; change its extension", path);
}

// MATLAB's files are HDF5 from its version 7.3 on, if they are saved so.
bool is_hdf5_name(const std::string& extension) {
  return extension == ".h5" || extension == ".hdf5" || extension == ".mat";
}

// The metadata beside an .npy file, under its name or the one of earlier versions.
std::string sidecar_of(const std::string& path) {
  const std::string old = old_sidecar_path(path);
  if (!is_there(sidecar_path(path)) && is_there(old)) return old;
  check_file_exists(sidecar_path(path), "the field's metadata {pitch_m, wavelengths_m, z_m, image}");
  return sidecar_path(path);
}

template <class Real>
std::vector<BasicField<Real>> read_fields_npy(const std::string& path) {
  std::vector<Array2D<std::complex<Real>>> arrays = read_npy<Real>(path);
  const std::string sidecar = sidecar_of(path);
  std::vector<BasicField<Real>> stack = stack_of<Real>(read_metadata(sidecar), arrays.size(), sidecar);
  for (size_t n = 0; n < arrays.size(); ++n) take_samples(stack[n], std::move(arrays[n]));
  return stack;
}

template <class Real>
void check_loaded(const std::string& path, const BasicField<Real>& field) {
  try {
    check_grid(field.grid);
    check_wavelength(field.wavelength, field.grid);
  } catch (const Error& e) {
    fail("{}: {}; correct its metadata", path, e.what());
  }
  require(std::isfinite(field.z), "{}: expected a finite z, got {} m", path, field.z);
  require(std::isfinite(field.grid.centre_x) && std::isfinite(field.grid.centre_y),
          "{}: expected a finite centre, got ({}, {}) m; correct its metadata", path, field.grid.centre_x,
          field.grid.centre_y);
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const std::complex<Real> u = field.samples(j, i);
      require(std::isfinite(u.real()) && std::isfinite(u.imag()),
              "{}: expected finite samples, got {} + {}i at row {}, column {}", path, u.real(), u.imag(), j, i);
    }
}

template <class Real>
std::vector<BasicField<Real>> load(const std::string& path, Outside outside) {
  check_file_exists(path, "a field");
  const std::string extension = extension_of(path);
  std::vector<BasicField<Real>> stack;
  if (extension == ".npy") {
    stack = read_fields_npy<Real>(path);
  } else if (is_hdf5_name(extension)) {
    stack = read_fields_hdf5<Real>(path, outside);
  } else if (extension == ".exr") {
    stack.push_back(convert<Real>(read_field_exr(path)));
  } else {
    fail("{}: expected a field .npy, .h5, .mat or .exr, got {}", path, kind_of_file(path));
  }
  for (const auto& field : stack) check_loaded(path, field);
  return stack;
}

template <class Real>
BasicField<Real> the_only_one(const std::string& path, std::vector<BasicField<Real>>&& stack) {
  require(stack.size() == 1, "{}: expected a field of one wavelength, got {}; save each as its own field", path,
          stack.size());
  return std::move(stack.front());
}

// What all fields of a stack have in common: the file has one of it.
template <class Real>
nlohmann::ordered_json common_metadata(const BasicField<Real>& field) {
  nlohmann::ordered_json json = metadata_of(field);
  for (const char* of_each : {"wavelengths_m", "cone_wavelength_m"}) json.erase(of_each);
  return json;
}

template <class Real>
void check_stack(const std::string& path, const std::vector<BasicField<Real>>& stack) {
  require(!stack.empty(), "expected at least one field to save as {}, got none", path);
  const BasicField<Real>& first = stack.front();
  check_grid(first.grid);
  for (const BasicField<Real>& field : stack) {
    require(field.samples.nx == field.grid.nx && field.samples.ny == field.grid.ny,
            "expected {} × {} samples in the field to save as {}, got {} × {}", field.grid.nx, field.grid.ny, path,
            field.samples.nx, field.samples.ny);
    require(field.grid == first.grid && common_metadata(field) == common_metadata(first),
            "expected fields that differ in wavelength alone to save as {}, got other grids, planes, image sides, "
            "filters, names or frames; save each as its own field",
            path);
  }
}

}  // namespace

template <class Real>
void save_fields(const std::string& path, const std::vector<BasicField<Real>>& stack) {
  check_stack(path, stack);
  const std::string extension = extension_of(path);
  if (extension == ".npy") {
    NewFile file(path);
    std::vector<const Array2D<std::complex<Real>>*> arrays;
    for (const auto& field : stack) arrays.push_back(&field.samples);
    write_npy(file, arrays);
    write_text(sidecar_path(path), stack_metadata(stack).dump(2) + "\n");
    file.finish();
  } else if (extension == ".h5") {
    write_atomically(path, [&](const std::string& temporary) { write_fields_hdf5(temporary, stack); });
  } else if (extension == ".exr") {
    require(stack.size() == 1, "expected .npy or .h5 for a field of {} wavelengths, got {}; .exr holds one",
            stack.size(), path);
    if constexpr (std::is_same_v<Real, float>)
      save_field_exr(path, stack.front());
    else
      fail("expected .npy or .h5 for a field in double precision, got {}; .exr holds single precision", path);
  } else {
    fail_extension(path);
  }
}

template <class Real>
void save_field(const std::string& path, const BasicField<Real>& field) {
  save_fields(path, std::vector<BasicField<Real>>{field});
}

bool is_field_file(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".npy" || is_hdf5_name(extension) || (extension == ".exr" && is_field_exr(path));
}

std::vector<Field> load_fields(const std::string& path, Outside outside) { return load<float>(path, outside); }
std::vector<FieldDouble> load_fields_double(const std::string& path, Outside outside) {
  return load<double>(path, outside);
}
Field load_field(const std::string& path, Outside outside) { return the_only_one(path, load<float>(path, outside)); }
FieldDouble load_field_double(const std::string& path, Outside outside) {
  return the_only_one(path, load<double>(path, outside));
}

template void save_fields(const std::string&, const std::vector<Field>&);
template void save_fields(const std::string&, const std::vector<FieldDouble>&);
template void save_field(const std::string&, const Field&);
template void save_field(const std::string&, const FieldDouble&);

namespace fs = std::filesystem;

namespace {

constexpr const char* record_key = "files";

// The sidecar as JSON. It is an output, so read_text, which notes inputs, is not used.
nlohmann::ordered_json sidecar_json(const std::string& path) {
  std::ifstream file(sidecar_path(path), std::ios::binary);
  return nlohmann::ordered_json::parse(file, nullptr, false);
}

FileRecord field_record(const std::string& path) {
  if (!is_file(sidecar_path(path))) return {};
  const nlohmann::ordered_json json = sidecar_json(path);
  if (!json.is_object() || !json.contains(record_key)) return {};
  return record_outside(path, record_from_text(json[record_key].dump(-1, ' ', true)));
}

std::vector<std::string> files_of(const std::string& path) {
  if (extension_of(path) != ".npy") return {path};
  return {path, sidecar_path(path)};
}

}  // namespace

template <class Real>
std::vector<std::string> save_field_series(const std::string& path,
                                           const std::vector<std::vector<BasicField<Real>>>& stacks) {
  const FileRecord earlier = field_record(path);
  std::vector<std::string> notes;
  FileRecord record;
  for (size_t i = stacks.size(); i-- > 0;) {
    const std::string name = numbered_path(path, i);
    for (const std::string& file : files_of(name)) {
      std::error_code ignored;
      if (i > 0 && is_there(file) &&
          earlier.count({fs::path(file).filename().string(), fs::file_size(file, ignored)}) == 0)
        notes.push_back(set_aside(file));
    }
    save_fields(name, stacks[i]);
    if (i > 0)
      for (const std::string& file : files_of(name))
        record.emplace(fs::path(file).filename().string(), fs::file_size(file));
  }
  if (record.empty()) return notes;
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  if (extension_of(path) == ".npy")
    json = sidecar_json(path);
  else if (is_there(sidecar_path(path)) && earlier.empty())
    notes.push_back(set_aside(sidecar_path(path)));
  json[record_key] = record_json(record_inside(path, record));
  write_text(sidecar_path(path), json.dump(2) + "\n");
  return notes;
}

template std::vector<std::string> save_field_series(const std::string&, const std::vector<std::vector<Field>>&);
template std::vector<std::string> save_field_series(const std::string&, const std::vector<std::vector<FieldDouble>>&);

}  // namespace holotrace
