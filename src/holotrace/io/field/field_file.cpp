#include "holotrace/io/field/field_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/field/npy.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"

namespace holotrace {
namespace {

[[noreturn]] void fail_extension(const std::string& path) {
  fail("expected a field file .npy, .h5 or .exr, got {}; change its extension", path);
}

// MATLAB's files are HDF5 from its version 7.3 on, if they are saved so.
bool is_hdf5_name(const std::string& extension) {
  return extension == ".h5" || extension == ".hdf5" || extension == ".mat";
}

template <class Real>
std::string field_metadata(const std::vector<BasicField<Real>>& stack) {
  const BasicField<Real>& field = stack.front();
  std::vector<double> wavelengths;
  for (const auto& one : stack) wavelengths.push_back(one.wavelength);
  nlohmann::ordered_json json{{"pitch_m", field.grid.pitch},
                              {"wavelengths_m", wavelengths},
                              {"z_m", field.z},
                              {"image", image_side_name(field.image)}};
  if (field.grid.centre_x != 0) json["centre_x_m"] = field.grid.centre_x;
  if (field.grid.centre_y != 0) json["centre_y_m"] = field.grid.centre_y;
  if (!field.label.name.empty()) json["name"] = field.label.name;
  if (field.label.frame > 0) json["frame"] = field.label.frame;
  if (const std::vector<double> cones = different_cones(stack); !cones.empty())
    json["cone_wavelengths_m"] = cones;
  else if (field.label.cone_wavelength > 0)
    json["cone_wavelength_m"] = field.label.cone_wavelength;
  if (field.filter) json["filter"] = filter_to_json(*field.filter);
  return json.dump(2) + "\n";
}

std::vector<double> numbers_of_fields(const nlohmann::json& json, const char* key, size_t count,
                                      const std::string& path) {
  const auto found = json.find(key);
  require(found != json.end(), "{}: expected the key \"{}\", which is missing; add it, in SI units", path, key);
  const bool are_numbers = found->is_array() && std::all_of(found->begin(), found->end(),
                                                            [](const auto& value) { return value.is_number(); });
  require(are_numbers && found->size() == count,
          "{}: expected {} number(s) in \"{}\", one per field of the stack, got {}", path, count, key, found->dump());
  return found->template get<std::vector<double>>();
}

// The metadata beside an .npy file, under its name or the one of earlier versions.
std::string sidecar_of(const std::string& path) {
  std::error_code ignored;
  const std::string old = old_sidecar_path(path);
  if (!std::filesystem::exists(sidecar_path(path), ignored) && std::filesystem::exists(old, ignored)) return old;
  check_file_exists(sidecar_path(path), "the field's metadata {pitch_m, wavelengths_m, z_m, image}");
  return sidecar_path(path);
}

template <class Real>
std::vector<BasicField<Real>> read_fields_npy(const std::string& path) {
  std::vector<Array2D<std::complex<Real>>> arrays = read_npy<Real>(path);
  const std::string sidecar = sidecar_of(path);
  const nlohmann::json json = read_metadata(sidecar);
  BasicField<Real> field;
  field.grid = {arrays.front().nx, arrays.front().ny, metadata_number(json, sidecar, "pitch_m")};
  field.grid.centre_x = metadata_number(json, sidecar, "centre_x_m", 0.0);
  field.grid.centre_y = metadata_number(json, sidecar, "centre_y_m", 0.0);
  const std::vector<double> wavelengths = numbers_of_fields(json, "wavelengths_m", arrays.size(), sidecar);
  field.z = metadata_number(json, sidecar, "z_m", 0.0);
  field.image = image_side_from(metadata_text(json, sidecar, "image", "virtual"), sidecar);
  field.label.name = metadata_text(json, sidecar, "name", "");
  field.label.frame = frame_from(metadata_number(json, sidecar, "frame", 0.0), sidecar);
  std::vector<double> cones(arrays.size(), metadata_number(json, sidecar, "cone_wavelength_m", 0.0));
  if (json.contains("cone_wavelengths_m"))
    cones = numbers_of_fields(json, "cone_wavelengths_m", arrays.size(), sidecar);
  field.filter = filter_from_json(json, sidecar);
  std::vector<BasicField<Real>> stack;
  for (size_t n = 0; n < arrays.size(); ++n) {
    field.wavelength = wavelengths[n];
    field.label.cone_wavelength = cones[n];
    stack.push_back(field);
    stack.back().samples = std::move(arrays[n]);
  }
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

template <class Real>
void check_stack(const std::string& path, const std::vector<BasicField<Real>>& stack) {
  require(!stack.empty(), "expected at least one field to save as {}, got none", path);
  const BasicField<Real>& first = stack.front();
  check_grid(first.grid);
  for (const BasicField<Real>& field : stack) {
    require(field.samples.nx == field.grid.nx && field.samples.ny == field.grid.ny,
            "expected {} × {} samples in the field to save as {}, got {} × {}", field.grid.nx, field.grid.ny, path,
            field.samples.nx, field.samples.ny);
    require(field.grid == first.grid && field.z == first.z && field.image == first.image &&
                field.filter == first.filter && field.label.name == first.label.name &&
                field.label.frame == first.label.frame,
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
    write_text(sidecar_path(path), field_metadata(stack));
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

}  // namespace holotrace
