#include "holotrace/io/field/grey_levels.h"

#include <cmath>
#include <optional>
#include <variant>

#include "holotrace/base/error.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

// Grey values per level: the grey of level ℓ is round(ℓ·scale).
double grey_scale(int levels, Modulation modulation, int bits) {
  const double greys = bits == 8 ? 256 : 65536;
  return modulation == Modulation::amplitude ? (greys - 1) / (levels - 1) : greys / levels;
}

}  // namespace

uint16_t grey_of(uint16_t level, int levels, Modulation modulation, int bits) {
  return uint16_t(std::lround(level * grey_scale(levels, modulation, bits)));
}

Greys read_greys(const std::string& path) {
  const std::optional<Picture> picture = read_picture(path);
  require(picture.has_value(),
          "{}: expected a hologram as a grey image, but it is not an image; write it as an 8- or 16-bit PNG", path);
  require(picture->type != SampleType::floats, "{}: expected a hologram in 8 or 16 bits, got floats; write it as a PNG",
          path);
  const size_t count = size_t(picture->columns) * size_t(picture->rows), channels = picture->channels.size();
  Greys greys{picture->columns, picture->rows, picture->type == SampleType::bits_8 ? 8 : 16,
              picture->text(metadata_name), std::vector<uint16_t>(count)};
  const auto copy = [&](const auto& values) {
    for (size_t i = 0; i < count; ++i) {
      const auto* pixel = values.data() + i * channels;
      require(channels < 3 || (pixel[0] == pixel[1] && pixel[1] == pixel[2]),
              "{}: expected a grey hologram, got a coloured pixel at row {}, column {}", path, i / size_t(greys.nx),
              i % size_t(greys.nx));
      greys.values[i] = uint16_t(pixel[0]);
    }
  };
  std::visit(copy, picture->samples);
  return greys;
}

void write_greys(const std::string& path, const Array2D<uint16_t>& levels_of_pixels, int levels, Modulation modulation,
                 const std::string& metadata) {
  const int bits = levels <= 256 ? 8 : 16;
  std::vector<uint16_t> greys;
  greys.reserve(levels_of_pixels.size());
  for (uint16_t level : levels_of_pixels.values) {
    require(level < levels, "expected levels below {} in the hologram to save as {}, got {}", levels, path, level);
    greys.push_back(grey_of(level, levels, modulation, bits));
  }
  const std::vector<uint8_t> bytes(greys.begin(), greys.end());
  PngHeader header{levels_of_pixels.nx, levels_of_pixels.ny, 1, bits, false, {}};
  if (!metadata.empty()) header.texts[metadata_name] = metadata;
  write_png(path, header, bits == 8 ? static_cast<const void*>(bytes.data()) : greys.data());
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
