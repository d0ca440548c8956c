#include "holotrace/io/field/stored_levels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/panel_image.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

StoredLevels read_table_of_levels(const std::string& path) {
  PanelTable table = load_panel_table(path);
  const bool are_floats = table.are_floats;
  StoredLevels stored{.kind = are_floats ? StoredLevels::Kind::floats : StoredLevels::Kind::levels,
                      .nx = table.values.nx / table.channels,
                      .ny = table.values.ny,
                      .channels = table.channels};
  stored.values = std::vector<double>(table.values.values.begin(), table.values.values.end());
  if (!are_floats) stored.levels = table.are_bits ? 2 : stored.greatest() > 255 ? 0 : 256;
  return stored;
}

std::string place_of(const StoredLevels& stored, size_t pixel) {
  return fmt::format("row {}, column {}", pixel / size_t(stored.nx), pixel % size_t(stored.nx));
}

// The first pixel whose red, green and blue differ.
template <class Value>
std::optional<size_t> first_coloured(const std::vector<Value>& values, int channels) {
  if (channels < 3) return std::nullopt;
  const auto count = size_t(channels);
  for (size_t i = 0; i < values.size(); i += count)
    if (values[i] != values[i + 1] || values[i] != values[i + 2]) return i / count;
  return std::nullopt;
}

// What turns a value into the level that it means.
struct Meaning {
  const StoredLevels& stored;
  int levels;
  Modulation modulation;
  const std::string &path, &source;
  double scale = stored.kind == StoredLevels::Kind::greys ? greys_per_level(levels, modulation, stored.bits) : 1;

  uint16_t level_of(double value, size_t pixel) const {
    if (stored.kind == StoredLevels::Kind::floats) return level_of_float(value, pixel);
    const double level = std::round(value / scale);
    require(level >= 0 && level < levels && std::round(level * scale) == value,
            "{}: expected the {} of {} levels, got {} at {}; {} or write the hologram again, without scaling or "
            "compression loss",
            path, stored.kind == StoredLevels::Kind::levels ? "values" : "greys", levels, value,
            place_of(stored, pixel),
            source.empty() ? "give their number (--levels)" : fmt::format("correct \"levels\" in {}", source));
    return uint16_t(level);
  }

 private:
  uint16_t level_of_float(double value, size_t pixel) const {
    if (modulation == Modulation::amplitude) {
      require(value >= 0 && value <= 1, "{}: expected amplitudes of 0 to 1, got {} at {}", path, value,
              place_of(stored, pixel));
      return uint16_t(std::lround(value * (levels - 1)));
    }
    require(std::isfinite(value), "{}: expected finite phases, got {} at {}", path, value, place_of(stored, pixel));
    const double turns = value / (2 * pi);
    return uint16_t(std::lround((turns - std::floor(turns)) * levels) % levels);
  }
};

}  // namespace

double StoredLevels::greatest() const {
  return std::visit(
      [](const auto& all) { return all.empty() ? 0.0 : double(*std::max_element(all.begin(), all.end())); }, values);
}

bool StoredLevels::has_colours() const {
  return std::visit([&](const auto& all) { return first_coloured(all, channels).has_value(); }, values);
}

StoredLevels read_stored_levels(const std::string& path) {
  if (value_in(path) == PanelValue::level) return read_table_of_levels(path);
  std::optional<Picture> picture = read_picture(path);
  require(picture.has_value(),
          "{}: expected a hologram as a grey image, but it is not an image; write it as an 8- or 16-bit PNG", path);
  require(picture->type != SampleType::floats, "{}: expected a hologram in 8 or 16 bits, got floats; write it as a PNG",
          path);
  StoredLevels stored{.nx = picture->columns,
                      .ny = picture->rows,
                      .bits = picture->type == SampleType::bits_8 ? 8 : 16,
                      .channels = int(picture->channels.size()),
                      .metadata = picture->text(hologram_text)};
  stored.levels = stored.bits == 8 ? 256 : 65536;
  if (stored.bits == 8)
    stored.values = std::move(std::get<std::vector<uint8_t>>(picture->samples));
  else
    stored.values = std::move(std::get<std::vector<uint16_t>>(picture->samples));
  return stored;
}

Array2D<uint16_t> levels_of(const StoredLevels& stored, Channel channel, int levels, Modulation modulation,
                            const std::string& path, const std::string& source) {
  require(channel == Channel::grey || stored.channels >= 3,
          "{}: expected a coloured picture for its channel {}, got a grey one; leave out the channel", path,
          name_of(channel, channel_names));
  Array2D<uint16_t> out(stored.ny, stored.nx);
  const Meaning meaning{stored, levels, modulation, path, source};
  const auto read = [&](const auto& values) {
    if (channel == Channel::grey)
      if (const std::optional<size_t> coloured = first_coloured(values, stored.channels))
        fail(
            "{}: expected a grey hologram, got a coloured pixel at {}; name the channel (--channel red, green or blue), or make a "
            "hologram of a picture with holotrace encode",
            path, place_of(stored, *coloured));
    const size_t first = channel == Channel::grey ? 0 : size_t(channel) - size_t(Channel::red);
    for (size_t i = 0; i < out.size(); ++i)
      out.values[i] = meaning.level_of(double(values[i * size_t(stored.channels) + first]), i);
  };
  std::visit(read, stored.values);
  return out;
}

void write_levels(const std::string& path, const Array2D<uint16_t>& levels_of_pixels, int levels, Modulation modulation,
                  const std::string& metadata) {
  PanelImage image{levels_of_pixels.nx, levels_of_pixels.ny, 1, grey_bits(levels), {}};
  image.values.reserve(levels_of_pixels.size());
  const bool are_levels = value_in(path) == PanelValue::level;
  for (const uint16_t level : levels_of_pixels.values) {
    require(level < levels, "expected levels below {} in the hologram to save as {}, got {}", levels, path, level);
    image.values.push_back(are_levels ? level : grey_of(level, levels, modulation));
  }
  std::map<std::string, std::string> texts;
  if (!metadata.empty()) texts[hologram_text] = metadata;
  save_panel_image(path, image, texts);
}

}  // namespace holotrace
