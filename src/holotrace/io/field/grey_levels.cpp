#include "holotrace/io/field/grey_levels.h"

#include <OpenImageIO/imageio.h>

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/picture/image_output.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

// Grey values per level: the grey of level ℓ is round(ℓ·scale).
double grey_scale(int levels, Modulation modulation, int bits) {
  const double greys = bits == 8 ? 256 : 65536;
  return modulation == Modulation::amplitude ? (greys - 1) / (levels - 1) : greys / levels;
}

}  // namespace

Greys read_greys(const std::string& path) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  const auto input = open_picture(path, config);
  require(input != nullptr,
          "{}: expected a hologram as a grey image, but it is not an image; write it as an 8- or 16-bit PNG", path);
  const OIIO::ImageSpec& spec = input->spec();
  require(!is_truncated_png(path), "{}: expected a hologram of {} × {} pixels, but it is truncated or damaged", path,
          spec.width, spec.height);
  const bool is_8 = spec.format == OIIO::TypeDesc::UINT8, is_16 = spec.format == OIIO::TypeDesc::UINT16;
  require(is_8 || is_16, "{}: expected a hologram in 8 or 16 bits, got {}; write it as a PNG", path,
          spec.format.c_str());
  const size_t count = size_t(spec.width) * size_t(spec.height), channels = size_t(spec.nchannels);
  std::vector<uint16_t> values(count * channels);
  require(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT16, values.data()),
          "{}: expected a hologram of {} × {} pixels, but it is truncated or damaged", path, spec.width, spec.height);
  Greys greys{spec.width, spec.height, is_8 ? 8 : 16, std::string(spec.get_string_attribute(metadata_name)),
              std::vector<uint16_t>(count)};
  for (size_t i = 0; i < count; ++i) {
    const uint16_t* pixel = values.data() + i * channels;
    require(channels < 3 || (pixel[0] == pixel[1] && pixel[1] == pixel[2]),
            "{}: expected a grey hologram, got a coloured pixel at row {}, column {}", path, i / size_t(spec.width),
            i % size_t(spec.width));
    greys.values[i] = uint16_t(is_8 ? pixel[0] / 257 : pixel[0]);  // 8-bit values were widened by 65535/255 = 257
  }
  return greys;
}

void write_greys(const std::string& path, const Array2D<uint16_t>& levels_of_pixels, int levels, Modulation modulation,
                 const std::string& metadata) {
  const int bits = levels <= 256 ? 8 : 16;
  const double scale = grey_scale(levels, modulation, bits);
  std::vector<uint16_t> greys;
  greys.reserve(levels_of_pixels.size());
  for (uint16_t level : levels_of_pixels.values) {
    require(level < levels, "expected levels below {} in the hologram to save as {}, got {}", levels, path, level);
    greys.push_back(uint16_t(std::lround(level * scale)));
  }
  const std::vector<uint8_t> bytes(greys.begin(), greys.end());
  OIIO::ImageSpec spec(levels_of_pixels.nx, levels_of_pixels.ny, 1,
                       bits == 8 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
  spec.attribute("oiio:ColorSpace", "Linear");
  if (!metadata.empty()) spec.attribute(metadata_name, metadata);
  write_image_file(path, spec, spec.format, bits == 8 ? static_cast<const void*>(bytes.data()) : greys.data());
}

Array2D<uint16_t> levels_of(const Greys& greys, int levels, Modulation modulation, const std::string& path,
                            const std::string& source) {
  const double scale = grey_scale(levels, modulation, greys.bits);
  Array2D<uint16_t> out(greys.ny, greys.nx);
  for (size_t i = 0; i < greys.values.size(); ++i) {
    const long level = std::lround(greys.values[i] / scale);
    require(level < levels && std::lround(double(level) * scale) == greys.values[i],
            "{}: expected the greys of {} levels, got {} at row {}, column {}; correct \"levels\" in {} or write the "
            "hologram again, without scaling or compression loss",
            path, levels, greys.values[i], i / size_t(greys.nx), i % size_t(greys.nx), source);
    out.values[i] = uint16_t(level);
  }
  return out;
}

}  // namespace holotrace
