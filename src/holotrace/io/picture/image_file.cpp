#include "holotrace/io/picture/image_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

constexpr const char* record_name = "holotrace_files";
constexpr const char* pitch_name = "pitch_m";

// The pixel pitch [m]; 0 if there is none: a number in an EXR, a text in PNG and JPEG.
double pitch_of(const PictureHeader& header) {
  if (const auto found = header.numbers.find(pitch_name); found != header.numbers.end()) return found->second;
  const std::string text = header.text(pitch_name);
  double pitch = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), pitch);
  const bool is_pitch = error == std::errc() && end == text.data() + text.size() && std::isfinite(pitch) && pitch > 0;
  return is_pitch ? pitch : 0;
}

// The light of each code of 8 or 16 bits.
std::vector<float> light_of_codes(int codes, ImageContent content, double gamma) {
  std::vector<float> light(static_cast<size_t>(codes));
  for (size_t code = 0; code < light.size(); ++code) {
    const double value = double(code) / double(codes - 1);
    light[code] = float(content != ImageContent::colour ? value
                        : gamma > 0                     ? std::pow(value, gamma)
                                                        : srgb_decode(value));
  }
  return light;
}

// The first channels of each pixel by a function of a sample.
template <class Sample, class Light>
void convert(const std::vector<Sample>& samples, size_t file_channels, Image& image, const Light& light) {
  const auto channels = size_t(image.channels), columns = size_t(image.nx);
  parallel_for(0, image.ny, [&](int64_t row) {
    const Sample* from = samples.data() + size_t(row) * columns * file_channels;
    float* to = image.values.data() + size_t(row) * columns * channels;
    for (size_t i = 0; i < columns; ++i, from += file_channels)
      for (size_t c = 0; c < channels; ++c) *to++ = light(from[c]);
  });
}

// The picture as its orientation says (PictureHeader).
Image upright(const Image& image, int orientation) {
  if (orientation == 1) return image;
  const bool exchanges_axes = orientation >= 5;
  const bool from_right = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool from_bottom = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  Image turned(exchanges_axes ? image.nx : image.ny, exchanges_axes ? image.ny : image.nx, image.channels);
  turned.pitch = image.pitch;
  for (int j = 0; j < turned.ny; ++j)
    for (int i = 0; i < turned.nx; ++i) {
      const int row = exchanges_axes ? i : j, column = exchanges_axes ? j : i;
      for (int c = 0; c < image.channels; ++c)
        turned(j, i, c) = image(from_bottom ? image.ny - 1 - row : row, from_right ? image.nx - 1 - column : column, c);
    }
  return turned;
}

// The alpha of a picture; a single 1 if it has none.
Image alpha_of(const Picture& picture, const std::string& name) {
  const int alpha = picture.channel("A");
  if (alpha < 0) {
    Image whole(1, 1, 1);
    whole.values = {1};
    return whole;
  }
  Image image(picture.rows, picture.columns, 1);
  std::visit(
      [&](const auto& samples) {
        using Sample = typename std::decay_t<decltype(samples)>::value_type;
        const double one = std::is_integral_v<Sample> ? double(std::numeric_limits<Sample>::max()) : 1;
        for (size_t i = 0; i < image.values.size(); ++i)
          image.values[i] = float(double(samples[i * picture.channels.size() + size_t(alpha)]) / one);
      },
      picture.samples);
  for (float& value : image.values) {
    require(std::isfinite(value), "{}: expected a finite alpha, got {}", name, value);
    value = std::clamp(value, 0.0F, 1.0F);
  }
  return image;
}

Image image_from(const Picture& picture, const std::string& name, ImageContent content) {
  require(picture.channel("real") < 0 || picture.channel("imag") < 0,
          "{}: expected an image, got a field (channels \"real\" and \"imag\"); give it to a command that "
          "takes a field",
          name);
  const size_t channels = picture.channels.size();
  if (content == ImageContent::alpha) return upright(alpha_of(picture, name), picture.orientation);
  Image image(picture.rows, picture.columns, channels >= 3 ? 3 : 1);
  image.pitch = pitch_of(picture);
  if (const auto* floats = std::get_if<std::vector<float>>(&picture.samples)) {
    convert(*floats, channels, image, [](float value) { return value; });
  } else if (const auto* bytes = std::get_if<std::vector<uint8_t>>(&picture.samples)) {
    const std::vector<float> light = light_of_codes(1 << 8, content, picture.gamma);
    convert(*bytes, channels, image, [&](uint8_t code) { return light[code]; });
  } else {
    const std::vector<float> light = light_of_codes(1 << 16, content, picture.gamma);
    convert(std::get<std::vector<uint16_t>>(picture.samples), channels, image,
            [&](uint16_t code) { return light[code]; });
  }
  for (size_t i = 0; i < image.values.size(); ++i)
    if (content != ImageContent::depth && !std::isfinite(image.values[i])) {
      const size_t pixel = i / size_t(image.channels);
      fail("{}: expected finite pixels, got {} at row {}, column {}", name, image.values[i], pixel / size_t(image.nx),
           pixel % size_t(image.nx));
    }
  return upright(image, picture.orientation);
}

[[noreturn]] void fail_not_an_image(const std::string& name, const std::string& kind = "") {
  fail("{}: expected an image, but it is not an image in a format known here{}; convert it to PNG, JPEG or EXR", name,
       kind);
}

// The code of sRGB for linear light, from 0 to the largest number of the type, which stands for white.
template <class Code>
Code code_of(double linear) {
  constexpr double top = std::numeric_limits<Code>::max();
  return Code(std::lround(top * srgb_encode(linear > 0 ? std::min(linear, 1.0) : 0.0)));
}

std::vector<uint16_t> wide_codes(const Image& image, double white) {
  std::vector<uint16_t> codes(image.values.size());
  for (size_t i = 0; i < codes.size(); ++i) codes[i] = code_of<uint16_t>(image.values[i] / white);
  return codes;
}

// code_of<uint8_t> without a power for each pixel: the code at the begin of one of many even steps of light, and the
// least light of each code, which decides within a step.
struct ByteCodes {
  static constexpr int steps = 4096;
  std::array<uint8_t, steps + 1> at_step{};
  std::array<double, 257> least{};

  ByteCodes() {
    for (int step = 0; step <= steps; ++step) at_step[size_t(step)] = code_of<uint8_t>(double(step) / steps);
    for (int code = 1; code < 256; ++code) {
      double below = 0, at = 1;  // bisection to neighbouring numbers
      for (double middle = 0.5; middle != below && middle != at; middle = (below + at) / 2)
        (code_of<uint8_t>(middle) < code ? below : at) = middle;
      least[size_t(code)] = at;
    }
    least[256] = std::numeric_limits<double>::infinity();
  }

  uint8_t operator()(double linear) const {
    const double clipped = linear > 0 ? std::min(linear, 1.0) : 0.0;
    size_t code = at_step[size_t(clipped * steps)];
    while (clipped >= least[code + 1]) ++code;
    return uint8_t(code);
  }
};

}  // namespace

double srgb_encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double srgb_decode(double code) { return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4); }

Image load_image(const std::string& path, ImageContent content) {
  check_file_exists(path, "an image");
  const std::optional<Picture> picture = read_picture(path);
  if (!picture) {
    const std::string kind = known_kind_of_file(path);
    const bool is_picture = kind.find("a picture") != std::string::npos;  // damaged
    fail_not_an_image(path, kind.empty() || is_picture ? "" : fmt::format(", it is {}", kind));
  }
  return image_from(*picture, path, content);
}

Image decode_image(const void* bytes, size_t size, const std::string& name, ImageContent content) {
  std::optional<Picture> picture = read_picture(bytes, size, name);
  if (!picture) fail_not_an_image(name);
  picture->orientation = 1;
  picture->gamma = 0;
  return image_from(*picture, name, content);
}

Image channel_of(const Image& image, int channel) {
  Image one(image.ny, image.nx, 1);
  one.pitch = image.pitch;
  one.sampling = image.sampling;
  for (size_t i = 0; i < one.values.size(); ++i)
    one.values[i] = image.values[i * size_t(image.channels) + size_t(std::min(channel, image.channels - 1))];
  return one;
}

Image with_three_channels(Image image) {
  if (image.channels == 3) return image;
  Image wide(image.ny, image.nx, 3);
  wide.pitch = image.pitch;
  for (size_t i = 0; i < image.values.size(); ++i)
    std::fill_n(wide.values.begin() + std::ptrdiff_t(3 * i), 3, image.values[i]);
  return wide;
}

void check_image(const std::string& path, int bits) {
  const std::string extension = extension_of(path);
  require(std::find(image_endings.begin(), image_endings.end(), extension) != image_endings.end(),
          "expected an image file {}, got {}; change its extension", fmt::join(image_endings, " or "), path);
  require(bits == 8 || bits == 16, "expected 8 or 16 bits for {}, got {}", path, bits);
  require(bits == 8 || !extension.starts_with(".jp"), "expected 8 bits for the JPEG {}, got 16; name a .png", path);
}

static std::string text_of(const std::string& path, const FileRecord& record) {
  return record_json(record_inside(path, record)).dump(-1, ' ', true);
}

// Writes the channels of an image under these names.
static void save_exr(const std::string& path, const std::vector<std::string>& channels, const Image& image,
                     const FileRecord& record) {
  ExrHeader header{image.nx, image.ny, channels, {}, {}};
  if (image.pitch > 0) header.numbers[pitch_name] = image.pitch;
  if (!record.empty()) header.texts[record_name] = text_of(path, record);
  write_exr(path, header, image.values.data());
}

void save_stokes(const std::string& path, const std::array<Image, 4>& parameters, const FileRecord& record) {
  const Image& first = parameters[0];
  require(extension_of(path) == ".exr", "{}: expected a picture .exr for Stokes parameters", path);
  Image all(first.ny, first.nx, 12);
  all.pitch = first.pitch;
  std::vector<std::string> channels;
  for (size_t k = 0; k < 4; ++k) {
    require(parameters[k].channels == 3 && parameters[k].values.size() == first.values.size(),
            "{}: expected four pictures of the same size in colour", path);
    for (const char* colour : {"R", "G", "B"}) channels.push_back(k == 0 ? colour : fmt::format("S{}.{}", k, colour));
    for (size_t i = 0; i < first.values.size(); ++i) all.values[i / 3 * 12 + 3 * k + i % 3] = parameters[k].values[i];
  }
  save_exr(path, channels, all, record);
}

void save_image(const std::string& path, const Image& image, double white, int bits, const FileRecord& record) {
  require(image.nx > 0 && image.ny > 0 && (image.channels == 1 || image.channels == 3),
          "expected an image with pixels of 1 or 3 channels to save as {}, got {} × {} of {}", path, image.nx, image.ny,
          image.channels);
  check_image(path, bits);
  const std::string extension = extension_of(path);
  if (extension == ".exr") return save_exr(path, channels_named(image.channels), image, record);
  require(std::isfinite(white) && white > 0, "expected a white level above 0 for {}, got {}", path, white);
  std::map<std::string, std::string> texts;
  if (image.pitch > 0) texts[pitch_name] = fmt::format("{:.17g}", image.pitch);
  if (!record.empty()) texts[record_name] = text_of(path, record);
  if (extension != ".png")
    return write_jpeg(path, {image.nx, image.ny, image.channels, texts}, srgb_codes(image, white).data());
  const PngHeader header{image.nx, image.ny, image.channels, bits, true, texts};
  if (bits == 8)
    write_png(path, header, srgb_codes(image, white).data());
  else
    write_png(path, header, wide_codes(image, white).data());
}

std::vector<uint8_t> srgb_codes(const Image& image, double white) {
  static const ByteCodes code;
  std::vector<uint8_t> codes(image.values.size());
  const auto row = size_t(image.nx) * size_t(image.channels);
  parallel_for(0, image.ny, [&](int64_t j) {
    for (size_t i = size_t(j) * row; i < size_t(j + 1) * row; ++i) codes[i] = code(image.values[i] / white);
  });
  return codes;
}

bool has_image_ending(const std::string& path) {
  constexpr std::array endings{".png", ".jpg", ".jpeg", ".exr", ".hdr", ".tif", ".tiff", ".webp", ".bmp", ".tga"};
  return std::find(endings.begin(), endings.end(), extension_of(path)) != endings.end();
}

std::string text_in_image(const std::string& path, const char* name) {
  if (!is_file(path)) return "";
  try {
    const std::optional<PictureHeader> header = read_picture_header(path);
    return header ? header->text(name) : "";
  } catch (const Error&) {
    return "";  // a damaged picture has no text
  }
}

FileRecord image_record(const std::string& path) {
  FileRecord record = record_outside(path, record_from_text(text_in_image(path, record_name)));
  record.merge(record_beside(path));  // a picture for a panel was there
  return record;
}

namespace {

// The samples of a line from which one sample of the new line is made.
struct Taps {
  std::vector<int> places;
  std::vector<double> weights;  // their sum is 1
};

// Triangles whose half width is the distance between new samples, or between old ones where that is larger. Beyond its
// ends the line goes on as it ends.
std::vector<Taps> taps_of(int from, int to) {
  const double step = double(from) / to, reach = std::max(1.0, step);
  std::vector<Taps> all(static_cast<size_t>(to));
  for (int k = 0; k < to; ++k) {
    Taps& taps = all[size_t(k)];
    const double centre = (k + 0.5) * step - 0.5;
    double sum = 0;
    for (int i = int(std::ceil(centre - reach)); i <= int(std::floor(centre + reach)); ++i) {
      const double weight = 1 - std::abs(i - centre) / reach;
      if (weight <= 0) continue;
      taps.places.push_back(std::clamp(i, 0, from - 1));
      taps.weights.push_back(weight);
      sum += weight;
    }
    for (double& weight : taps.weights) weight /= sum;
  }
  return all;
}

}  // namespace

Image resample_image(const Image& image, int columns, int rows) {
  require(image.nx > 0 && image.ny > 0 && columns > 0 && rows > 0,
          "expected pictures with pixels to resample, got {} × {} and {} × {}", image.nx, image.ny, columns, rows);
  const std::vector<Taps> across = taps_of(image.nx, columns), down = taps_of(image.ny, rows);
  const auto channels = size_t(image.channels), old_row = size_t(image.nx) * channels;
  Image out(rows, columns, image.channels);
  parallel_for(0, rows, [&](int64_t j) {
    std::vector<double> line(old_row);
    const Taps& lines = down[size_t(j)];
    for (size_t t = 0; t < lines.places.size(); ++t) {
      const float* from = image.values.data() + size_t(lines.places[t]) * old_row;
      for (size_t i = 0; i < old_row; ++i) line[i] += lines.weights[t] * double(from[i]);
    }
    float* to = &out(int(j), 0);
    for (const Taps& taps : across)
      for (size_t c = 0; c < channels; ++c) {
        double sum = 0;
        for (size_t t = 0; t < taps.places.size(); ++t)
          sum += taps.weights[t] * line[size_t(taps.places[t]) * channels + c];
        *to++ = float(sum);
      }
  });
  return out;
}

}  // namespace holotrace
