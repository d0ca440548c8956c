#include <OpenImageIO/imageio.h>

#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/printable.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/image_output.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

constexpr const char* filter_names[] = {"filter_u0_per_m", "filter_v0_per_m", "filter_half_u_per_m",
                                        "filter_half_v_per_m"};

double read_number(const OIIO::ImageSpec& spec, const char* name, const std::string& path) {
  const OIIO::ParamValue* value = spec.find_attribute(name);
  require(value != nullptr, "{}: expected the attribute \"{}\", which is missing; add it, in SI units", path, name);
  if (value->type() == OIIO::TypeDesc::DOUBLE) return value->get<double>();
  require(value->type() == OIIO::TypeDesc::FLOAT, "{}: expected a number for \"{}\", got another kind", path, name);
  return value->get_float();
}

}  // namespace

void save_field_exr(const std::string& path, const Field& field) {
  OIIO::ImageSpec spec(field.grid.nx, field.grid.ny, 2, OIIO::TypeDesc::FLOAT);
  spec.channelnames = {"real", "imag"};
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "");  // no time stamp: the same field gives the same bytes
  const auto put = [&](const char* name, double value) { spec.attribute(name, OIIO::TypeDesc::DOUBLE, &value); };
  put("pitch_m", field.grid.pitch);
  put("wavelengths_m", field.wavelength);
  put("z_m", field.z);
  if (field.grid.centre_x != 0) put("centre_x_m", field.grid.centre_x);
  if (field.grid.centre_y != 0) put("centre_y_m", field.grid.centre_y);
  spec.attribute("image", image_side_name(field.image));
  if (!field.name.empty()) spec.attribute("name", field.name);
  if (field.frame > 0) put("frame", field.frame);
  if (field.cone_wavelength > 0) put("cone_wavelength_m", field.cone_wavelength);
  if (field.filter) {
    const double values[] = {field.filter->u0, field.filter->v0, field.filter->half_u, field.filter->half_v};
    for (int i = 0; i < 4; ++i) put(filter_names[i], values[i]);
  }
  write_image_file(path, spec, OIIO::TypeDesc::FLOAT, field.samples.values.data());
}

bool is_field_exr(const std::string& path) {
  const auto input = open_picture(path);
  return input && input->spec().channelindex("real") >= 0 && input->spec().channelindex("imag") >= 0;
}

Field read_field_exr(const std::string& path) {
  const auto input = open_picture(path);
  require(input != nullptr, "{}: expected an OpenEXR field, but it is not an image or is truncated; write it again",
          path);
  const OIIO::ImageSpec& spec = input->spec();
  const int real = spec.channelindex("real"), imag = spec.channelindex("imag");
  require(real >= 0 && imag >= 0, "{}: expected the channels \"real\" and \"imag\" of a field, got other channels",
          path);

  Field field;
  field.grid.nx = spec.width;
  field.grid.ny = spec.height;
  field.samples = Array2D<std::complex<float>>(spec.height, spec.width);
  std::vector<float> values(field.samples.size() * size_t(spec.nchannels));
  require(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()),
          "{}: expected {} × {} samples, but they cannot be read; the file is truncated or damaged", path, spec.width,
          spec.height);
  for (size_t i = 0; i < field.samples.size(); ++i) {
    const float* sample = values.data() + i * size_t(spec.nchannels);
    field.samples.values[i] = {sample[real], sample[imag]};
  }
  field.grid.pitch = read_number(spec, "pitch_m", path);
  field.wavelength = read_number(spec, "wavelengths_m", path);
  if (spec.find_attribute("z_m")) field.z = read_number(spec, "z_m", path);
  if (spec.find_attribute("centre_x_m")) field.grid.centre_x = read_number(spec, "centre_x_m", path);
  if (spec.find_attribute("centre_y_m")) field.grid.centre_y = read_number(spec, "centre_y_m", path);
  if (spec.find_attribute("image"))
    field.image = image_side_from(std::string(spec.get_string_attribute("image")), path);
  field.name = printable(std::string(spec.get_string_attribute("name")));
  if (spec.find_attribute("frame")) field.frame = frame_from(read_number(spec, "frame", path), path);
  if (spec.find_attribute("cone_wavelength_m")) field.cone_wavelength = read_number(spec, "cone_wavelength_m", path);
  if (spec.find_attribute(filter_names[0]))
    field.filter = SpectralFilter{read_number(spec, filter_names[0], path), read_number(spec, filter_names[1], path),
                                  read_number(spec, filter_names[2], path), read_number(spec, filter_names[3], path)};
  return field;
}

}  // namespace holotrace
