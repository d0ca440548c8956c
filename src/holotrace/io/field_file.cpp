#include "holotrace/io/field_file.h"

#include <cmath>
#include <type_traits>

#include "holotrace/base/error.h"
#include "holotrace/io/field_formats.h"
#include "holotrace/io/file.h"
#include "holotrace/io/metadata.h"
#include "holotrace/io/npy.h"

namespace holotrace {
namespace {

[[noreturn]] void fail_extension(const std::string& path) {
  fail("expected a field file .npy, .h5 or .exr, got {}; change its extension", path);
}

std::string field_metadata(const Grid& grid, double wavelength, double z, ImageSide image,
                           const std::optional<SpectralFilter>& filter) {
  nlohmann::ordered_json json{
      {"pitch_m", grid.pitch}, {"wavelengths_m", {wavelength}}, {"z_m", z}, {"image", image_side_name(image)}};
  if (filter) json["filter"] = filter_to_json(*filter);
  return json.dump(2) + "\n";
}

double the_wavelength(const nlohmann::json& json, const std::string& path) {
  const auto found = json.find("wavelengths_m");
  require(found != json.end(), "{}: expected the key \"wavelengths_m\", which is missing; add it, in SI units", path);
  require(found->is_array() && found->size() == 1 && found->front().is_number(),
          "{}: expected one wavelength in \"wavelengths_m\", got {}; save each as its own field", path, found->dump());
  return found->front().get<double>();
}

template <class Real>
BasicField<Real> read_field_npy(const std::string& path) {
  BasicField<Real> field;
  field.samples = read_npy<Real>(path);
  field.grid.nx = field.samples.nx;
  field.grid.ny = field.samples.ny;
  const std::string sidecar = sidecar_path(path);
  check_file_exists(sidecar, "the field's metadata {pitch_m, wavelengths_m, z_m, image}");
  const nlohmann::json json = read_metadata(sidecar);
  field.grid.pitch = metadata_number(json, sidecar, "pitch_m");
  field.wavelength = the_wavelength(json, sidecar);
  field.z = metadata_number(json, sidecar, "z_m", 0.0);
  field.image = image_side_from(metadata_text(json, sidecar, "image", "virtual"), sidecar);
  field.filter = filter_from_json(json, sidecar);
  return field;
}

template <class Real>
BasicField<Real> load(const std::string& path) {
  check_file_exists(path, "a field");
  const std::string extension = extension_of(path);
  BasicField<Real> field;
  if (extension == ".npy") {
    field = read_field_npy<Real>(path);
  } else if (extension == ".h5") {
    field = read_field_hdf5<Real>(path);
  } else if (extension == ".exr") {
    field = convert<Real>(read_field_exr(path));
  } else {
    fail_extension(path);
  }
  try {
    check_grid(field.grid);
    check_wavelength(field.wavelength);
  } catch (const Error& e) {
    fail("{}: {}; correct its metadata", path, e.what());
  }
  require(std::isfinite(field.z), "{}: expected a finite z, got {} m", path, field.z);
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const std::complex<Real> u = field.samples(j, i);
      require(std::isfinite(u.real()) && std::isfinite(u.imag()),
              "{}: expected finite samples, got {} + {}i at row {}, column {}", path, u.real(), u.imag(), j, i);
    }
  return field;
}

}  // namespace

template <class Real>
void save_field(const std::string& path, const BasicField<Real>& field) {
  check_grid(field.grid);
  require(field.samples.nx == field.grid.nx && field.samples.ny == field.grid.ny,
          "expected {} × {} samples in the field to save as {}, got {} × {}", field.grid.nx, field.grid.ny, path,
          field.samples.nx, field.samples.ny);
  const std::string extension = extension_of(path);
  if (extension == ".npy") {
    write_atomically(path, [&](const std::string& temporary) {
      write_npy(temporary, field.samples);
      write_text(sidecar_path(path), field_metadata(field.grid, field.wavelength, field.z, field.image, field.filter));
    });
  } else if (extension == ".h5") {
    write_atomically(path, [&](const std::string& temporary) { write_field_hdf5(temporary, field); });
  } else if (extension == ".exr") {
    if constexpr (std::is_same_v<Real, float>)
      write_atomically(path, [&](const std::string& temporary) { write_field_exr(temporary, field); });
    else
      fail("expected .npy or .h5 for a field in double precision, got {}; .exr holds single precision", path);
  } else {
    fail_extension(path);
  }
}

bool is_field_file(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".npy" || extension == ".h5" || (extension == ".exr" && is_field_exr(path));
}

Field load_field(const std::string& path) { return load<float>(path); }
FieldDouble load_field_double(const std::string& path) { return load<double>(path); }

template void save_field(const std::string&, const Field&);
template void save_field(const std::string&, const FieldDouble&);

}  // namespace holotrace
