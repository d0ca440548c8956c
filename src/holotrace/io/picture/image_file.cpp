#include "holotrace/io/picture/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/record_names.h"
#include "holotrace/io/picture/image_output.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

constexpr const char* record_name = "holotrace_files";
constexpr const char* known_extensions = ".png or .exr";

float decode(float code, int steps, ImageContent content) {
  // Codes are whole numbers of steps: in double precision the value is correct to the last bit of a float.
  const double value = std::round(double(code) * steps) / steps;
  return float(content == ImageContent::colour ? srgb_decode(value) : value);
}

// The pixel pitch [m]; 0 if there is none: a number in an EXR, a text in a PNG.
double pitch_of(const OIIO::ImageSpec& spec) {
  if (const auto* number = spec.find_attribute("pitch_m", OIIO::TypeDesc::DOUBLE)) return number->get<double>();
  const std::string text(spec.get_string_attribute("pitch_m"));
  double pitch = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), pitch);
  const bool is_pitch = error == std::errc() && end == text.data() + text.size() && std::isfinite(pitch) && pitch > 0;
  return is_pitch ? pitch : 0;
}

Image read_image(OIIO::ImageInput& input, const std::string& name, ImageContent content) {
  const OIIO::ImageSpec& spec = input.spec();
  require(spec.channelindex("real") < 0 || spec.channelindex("imag") < 0,
          "{}: expected an image, got a field (channels \"real\" and \"imag\"); give it to a command that "
          "takes a field",
          name);
  const int file_channels = spec.nchannels;
  std::vector<float> values(size_t(spec.width) * size_t(spec.height) * size_t(file_channels));
  if (!input.read_image(0, 0, 0, file_channels, OIIO::TypeDesc::FLOAT, values.data()))
    fail("{}: expected an image of {} × {} pixels, but it is truncated or damaged ({})", name, spec.width, spec.height,
         input.geterror());

  const bool is_float = spec.format.is_floating_point();
  const int steps = spec.format.size() == 1 ? 255 : 65535;
  Image image(spec.height, spec.width, file_channels >= 3 ? 3 : 1);
  for (size_t i = 0; i < size_t(image.nx) * size_t(image.ny); ++i)
    for (int c = 0; c < image.channels; ++c) {
      const float value = values[i * size_t(file_channels) + size_t(c)];
      require(std::isfinite(value), "{}: expected finite pixels, got {} at row {}, column {}", name, value,
              i / size_t(image.nx), i % size_t(image.nx));
      image.values[i * size_t(image.channels) + size_t(c)] = is_float ? value : decode(value, steps, content);
    }
  image.pitch = pitch_of(spec);
  return image;
}

// Options that read colours as stored, not multiplied by alpha, which is dropped.
OIIO::ImageSpec plain_colours() {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  return config;
}

[[noreturn]] void fail_not_an_image(const std::string& name, const std::string& kind = "") {
  fail("{}: expected an image, but it is not an image in a format known here{}; convert it to PNG, JPEG or EXR", name,
       kind);
}

}  // namespace

double srgb_encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double srgb_decode(double code) { return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4); }

bool is_truncated_png(const std::string& path) {
  constexpr std::string_view signature("\x89PNG"), end("IEND");
  std::ifstream file(path, std::ios::binary);
  std::string bytes(signature.size(), ' ');
  file.read(bytes.data(), std::streamsize(bytes.size()));
  if (bytes != signature) return false;
  constexpr int most = 1024;  // bytes that other programs may add after the end
  file.seekg(0, std::ios::end);
  file.seekg(-std::min<std::streamoff>(most, file.tellg()), std::ios::end);
  bytes.resize(most);
  file.read(bytes.data(), most);
  return std::string_view(bytes).substr(0, size_t(file.gcount())).find(end) == std::string_view::npos;
}

Image load_image(const std::string& path, ImageContent content) {
  check_file_exists(path, "an image");
  const OIIO::ImageSpec config = plain_colours();
  const auto input = open_picture(path, config);
  if (!input) {
    const std::string kind = known_kind_of_file(path);
    const bool is_picture = kind.find("a picture") != std::string::npos;  // damaged
    fail_not_an_image(path, kind.empty() || is_picture ? "" : fmt::format(", it is {}", kind));
  }
  require(!is_truncated_png(path), "{}: expected an image of {} × {} pixels, but it is truncated or damaged", path,
          input->spec().width, input->spec().height);
  return read_image(*input, path, content);
}

Image decode_image(const void* bytes, size_t size, const std::string& name, ImageContent content) {
  OIIO::Filesystem::IOMemReader memory(const_cast<void*>(bytes), size);
  const auto input = open_picture(memory, name, plain_colours());
  if (!input) fail_not_an_image(name);
  return read_image(*input, name, content);
}

Image with_three_channels(Image image) {
  if (image.channels == 3) return image;
  Image wide(image.ny, image.nx, 3);
  wide.pitch = image.pitch;
  for (size_t i = 0; i < image.values.size(); ++i)
    std::fill_n(wide.values.begin() + std::ptrdiff_t(3 * i), 3, image.values[i]);
  return wide;
}

void save_image(const std::string& path, const Image& image, double white, int bits, const FileRecord& record) {
  require(image.nx > 0 && image.ny > 0 && (image.channels == 1 || image.channels == 3),
          "expected an image with pixels of 1 or 3 channels to save as {}, got {} × {} of {}", path, image.nx, image.ny,
          image.channels);
  const std::string extension = extension_of(path);
  const auto record_text = [&] { return record_json(record_inside(path, record)).dump(-1, ' ', true); };
  if (extension == ".exr") {
    OIIO::ImageSpec spec(image.nx, image.ny, image.channels, OIIO::TypeDesc::FLOAT);
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // no time stamp: the same image gives the same bytes
    spec.attribute("oiio:ColorSpace", "Linear");
    if (image.pitch > 0) spec.attribute("pitch_m", OIIO::TypeDesc::DOUBLE, &image.pitch);
    if (!record.empty()) spec.attribute(record_name, record_text());
    return write_image_file(path, spec, OIIO::TypeDesc::FLOAT, image.values.data());
  }
  require(extension == ".png", "expected an image file {}, got {}; change its extension", known_extensions, path);
  require(std::isfinite(white) && white > 0, "expected a white level above 0 for {}, got {}", path, white);
  require(bits == 8 || bits == 16, "expected 8 or 16 bits for {}, got {}", path, bits);
  const double top = bits == 8 ? 255 : 65535;
  std::vector<uint16_t> codes(image.values.size());
  for (size_t i = 0; i < codes.size(); ++i) {
    const double linear = image.values[i] / white;
    codes[i] = uint16_t(std::lround(top * srgb_encode(linear > 0 ? std::min(linear, 1.0) : 0.0)));
  }
  OIIO::ImageSpec spec(image.nx, image.ny, image.channels, bits == 8 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (image.pitch > 0) spec.attribute("pitch_m", fmt::format("{:.17g}", image.pitch));
  if (!record.empty()) spec.attribute(record_name, record_text());
  const std::vector<uint8_t> bytes(codes.begin(), codes.end());
  write_image_file(path, spec, spec.format, bits == 8 ? static_cast<const void*>(bytes.data()) : codes.data());
}

std::string text_in_image(const std::string& path, const char* name) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored) || is_truncated_png(path)) return "";
  try {
    const auto input = open_picture(path);
    return input ? std::string(input->spec().get_string_attribute(name)) : "";
  } catch (const Error&) {
    return "";  // a damaged picture has no text
  }
}

FileRecord image_record(const std::string& path) {
  return record_outside(path, record_from_text(text_in_image(path, record_name)));
}

Image resample_image(const Image& image, int columns, int rows) {
  const OIIO::ImageSpec from(image.nx, image.ny, image.channels, OIIO::TypeDesc::FLOAT);
  const OIIO::ImageBuf source(from, const_cast<float*>(image.values.data()));  // only read, as by const ImageBuf
  Image out(rows, columns, image.channels);
  OIIO::ImageBuf target(OIIO::ImageSpec(columns, rows, image.channels, OIIO::TypeDesc::FLOAT), out.values.data());
  require(OIIO::ImageBufAlgo::resize(target, source, "triangle"),
          "expected to resample a picture to {} × {}, got \"{}\"", columns, rows, target.geterror());
  return out;
}

}  // namespace holotrace
