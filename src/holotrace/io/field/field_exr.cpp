#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
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
