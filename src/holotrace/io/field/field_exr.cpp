#include <optional>
#include <variant>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/printable.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

double header_number(const PictureHeader& header, const char* name, const std::string& path) {
  const auto found = header.numbers.find(name);
  require(found != header.numbers.end() || header.texts.count(name) == 0,
          "{}: expected a number for \"{}\", got another kind", path, name);
  require(found != header.numbers.end(), "{}: expected the attribute \"{}\", which is missing; add it, in SI units",
          path, name);
  return found->second;
}

}  // namespace

void save_field_exr(const std::string& path, const Field& field) {
  ExrHeader header{field.grid.nx, field.grid.ny, {"real", "imag"}, {}, {}};
  const auto put = [&](const char* name, double value) { header.numbers[name] = value; };
  put("pitch_m", field.grid.pitch);
  put("wavelengths_m", field.wavelength);
  put("z_m", field.z);
  if (field.grid.centre_x != 0) put("centre_x_m", field.grid.centre_x);
  if (field.grid.centre_y != 0) put("centre_y_m", field.grid.centre_y);
  header.texts["image"] = image_side_name(field.image);
  if (!field.label.name.empty()) header.texts["name"] = field.label.name;
  if (field.label.frame > 0) put("frame", field.label.frame);
  if (field.label.cone_wavelength > 0) put("cone_wavelength_m", field.label.cone_wavelength);
  if (field.filter) {
    const double values[] = {field.filter->u0, field.filter->v0, field.filter->half_u, field.filter->half_v};
    for (int i = 0; i < 4; ++i) put(filter_attributes[i], values[i]);
  }
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

  Field field;
  field.grid.nx = picture->columns;
  field.grid.ny = picture->rows;
  field.samples = Array2D<std::complex<float>>(picture->rows, picture->columns);
  const auto& values = std::get<std::vector<float>>(picture->samples);
  for (size_t i = 0; i < field.samples.size(); ++i) {
    const float* sample = values.data() + i * picture->channels.size();
    field.samples.values[i] = {sample[real], sample[imag]};
  }
  const auto has = [&](const char* name) { return picture->numbers.count(name) + picture->texts.count(name) > 0; };
  field.grid.pitch = header_number(*picture, "pitch_m", path);
  field.wavelength = header_number(*picture, "wavelengths_m", path);
  if (has("z_m")) field.z = header_number(*picture, "z_m", path);
  if (has("centre_x_m")) field.grid.centre_x = header_number(*picture, "centre_x_m", path);
  if (has("centre_y_m")) field.grid.centre_y = header_number(*picture, "centre_y_m", path);
  if (has("image")) field.image = image_side_from(picture->text("image"), path);
  field.label.name = printable(picture->text("name"));
  if (has("frame")) field.label.frame = frame_from(header_number(*picture, "frame", path), path);
  if (has("cone_wavelength_m")) field.label.cone_wavelength = header_number(*picture, "cone_wavelength_m", path);
  if (has(filter_attributes[0]))
    field.filter = SpectralFilter{
        header_number(*picture, filter_attributes[0], path), header_number(*picture, filter_attributes[1], path),
        header_number(*picture, filter_attributes[2], path), header_number(*picture, filter_attributes[3], path)};
  return field;
}

}  // namespace holotrace
