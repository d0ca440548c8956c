#include "holotrace/io/field/hologram_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/slm.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

// Levels as the greys of a PNG (hologram_file.h has the formula), and the text inside it.

/// The text of a PNG that holds the metadata of a hologram.
constexpr const char* metadata_name = "holotrace";

struct Greys {
  int nx = 0, ny = 0, bits = 8;
  std::string metadata;          ///< empty if the file has none
  std::vector<uint16_t> values;  ///< [row][column]
};

// Grey values per level: the grey of level ℓ is round(ℓ·scale).
double grey_scale(int levels, Modulation modulation, int bits) {
  const double greys = bits == 8 ? 256 : 65536;
  return modulation == Modulation::amplitude ? (greys - 1) / (levels - 1) : greys / levels;
}

/// The grey of a level, in 8 or 16 bits.
uint16_t grey_of(uint16_t level, int levels, Modulation modulation, int bits) {
  return uint16_t(std::lround(level * grey_scale(levels, modulation, bits)));
}

/// @throws Error naming the file if it is not a grey image of 8 or 16 bits, or is truncated
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

/// Writes levels as greys. @throws Error for a level that is not below `levels`, and where NewFile throws
void write_greys(const std::string& path, const Array2D<uint16_t>& levels_of_pixels, int levels, Modulation modulation,
                 const std::string& metadata = "") {
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

/// The levels that greys mean.
/// @param source  file with the number of levels, for errors
/// @throws Error naming `path` for a grey that is no level
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

void check_levels(double levels, const std::string& path) {
  require(levels == std::floor(levels) && levels >= 2 && levels <= 65536, "{}: expected 2 to 65536 levels, got {}",
          path, levels);
}

// Path of a file beside a hologram: "out/h.png" → "out/h_modulus.png", the amplitudes of a complex one, and
// "out/h_phase_map.exr" and "out/h_light_map.exr", the maps of its panel.
std::string beside(const std::string& path, const char* ending) {
  return path.substr(0, path.size() - extension_of(path).size()) + ending;
}
std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }
std::string modulus_path(const std::string& path) { return beside(path, "_modulus.png"); }
std::string phase_map_path(const std::string& path) { return beside(path, "_phase_map.exr"); }

std::string light_map_path(const std::string& path) { return beside(path, "_light_map.exr"); }

void save_map(const std::string& path, const Array2D<float>& map) {
  Image image(map.ny, map.nx, 1);
  image.values.assign(map.values.begin(), map.values.end());
  save_image(path, image, 1, 16);
}

std::shared_ptr<const Array2D<float>> load_map(const std::string& path, const char* kind) {
  check_file_exists(path, kind);
  const Image image = load_image(path, ImageContent::data);
  auto map = std::make_shared<Array2D<float>>(image.ny, image.nx);
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) (*map)(j, i) = image(j, i, 0);
  return map;
}

void check_viewing(const ViewingConditions& viewing, const std::string& sidecar) {
  require(viewing.pupil >= 0 && viewing.eye.z >= 0,
          "{}: expected a pupil and an eye's z of 0 m or more in \"viewing\", got {} m and {} m", sidecar,
          viewing.pupil, viewing.eye.z);
}

// The hologram of metadata; the maps of its panel are files beside it. @param hologram  with defaults for absent values
void read_hologram(const nlohmann::json& json, const std::string& path, const std::string& sidecar,
                   Hologram& hologram) {
  MetadataReader reader(json, sidecar);
  members(reader, hologram);
  require(hologram.grid.pitch >= 0 && hologram.wavelength >= 0,
          "{}: expected a pitch and a wavelength of 0 m or more, got {} m and {} m", sidecar, hologram.grid.pitch,
          hologram.wavelength);
  check_levels(hologram.levels, sidecar);
  require(hologram.illumination >= 0, "{}: expected an illumination of 0 W/m² or more, got {} W/m²", sidecar,
          hologram.illumination);
  for (const JointColour& colour : hologram.colours)
    require(
        colour.wavelength > 0 && colour.illumination >= 0,
        "{}: expected \"colours\" with wavelengths above 0 m and illuminations of 0 W/m² or more, got {} m and {} W/m²",
        sidecar, colour.wavelength, colour.illumination);
  check_viewing(hologram.viewing, sidecar);
  if (!hologram.slm) return;
  Slm& slm = *hologram.slm;
  slm.grid = hologram.grid;
  if (json["slm"].contains("phase_map"))
    slm.effects.phase_map = load_map(phase_map_path(path), "the phase map of a hologram's panel");
  if (json["slm"].contains("light_map"))
    slm.effects.light_map = load_map(light_map_path(path), "the light map of a hologram's panel");
  try {
    check_slm(slm);
  } catch (const Error& error) {
    fail("{}: {}", sidecar, error.what());
  }
}

// Longer texts than this are not read by libpng.
constexpr size_t longest_text = 7'000'000;

// The metadata beside a PNG without text, under its name or the one of earlier versions; empty if there is none.
std::string hologram_sidecar(const std::string& path) {
  for (const std::string& sidecar : {sidecar_path(path), old_sidecar_path(path)})
    if (is_there(sidecar)) return sidecar;
  return "";
}

// The metadata inside a PNG; empty if there are none.
std::string metadata_in(const std::string& path) {
  return extension_of(path) == ".png" ? text_in_image(path, metadata_name) : "";
}

}  // namespace

void check_hologram_path(const std::string& path) {
  const std::string ending = extension_of(path);
  const bool has_loss = ending == ".jpg" || ending == ".jpeg";
  require(ending == ".png", "expected a hologram file .png, got {}{}; change its extension", path,
          has_loss ? ", and a JPEG would change the levels of its pixels" : "");
}

void save_hologram(const std::string& path, const Hologram& hologram, const SeriesPart& part,
                   const std::function<FileRecord()>& files) {
  check_hologram_path(path);
  check_levels(hologram.levels, path);
  require(hologram.level.nx > 0 && hologram.level.ny > 0, "expected a hologram with pixels to save as {}, got {} × {}",
          path, hologram.level.nx, hologram.level.ny);
  MetadataWriter writer{.json = {{"kind", "hologram"}}};
  members(writer, const_cast<Hologram&>(hologram));
  nlohmann::ordered_json& json = writer.json;
  if (hologram.slm && hologram.slm->effects.phase_map) {
    const std::string map = phase_map_path(path);
    json["slm"]["phase_map"] = file_name(map);
    save_map(map, *hologram.slm->effects.phase_map);
  }
  if (hologram.slm && hologram.slm->effects.light_map) {
    const std::string map = light_map_path(path);
    json["slm"]["light_map"] = file_name(map);
    save_map(map, *hologram.slm->effects.light_map);
  }
  if (hologram.modulation == Modulation::complex) {
    const std::string modulus = modulus_path(path);
    json["modulus"] = file_name(modulus);
    write_greys(modulus, hologram.modulus_level, hologram.levels, Modulation::amplitude);
  }
  if (part.count > 1) {
    json["part"] = part.number;
    json["parts"] = part.count;
  }
  if (const FileRecord record = files ? files() : FileRecord(); !record.empty())
    json["files"] = record_json(record_inside(path, record));
  const std::string text = json.dump(-1, ' ', true);  // ASCII, as PNG asks for
  const bool is_inside = text.size() <= longest_text;
  if (!is_inside) write_text(sidecar_path(path), text + "\n");
  write_greys(path, hologram.level, hologram.levels, hologram.modulation, is_inside ? text : "");
}

void save_holograms(const OutputSet& set, const std::string& name, const std::vector<Hologram>& holograms) {
  const FileRecord before = set.record();
  const auto save = [&](int64_t i, const std::function<FileRecord()>& files) {
    const auto n = size_t(i);
    save_hologram(set.path(numbered_path(name, n)), holograms[n], {n + 1, holograms.size()}, files);
  };
  parallel_for(1, int64_t(holograms.size()), [&](int64_t i) { save(i, nullptr); });
  if (!holograms.empty()) save(0, [&] { return set.record_since(before); });
}

std::vector<uint8_t> greys_of(const Hologram& hologram) {
  require(hologram.levels <= 256, "expected at most 256 levels for greys of 8 bits, got {}", hologram.levels);
  std::vector<uint8_t> greys;
  for (const uint16_t level : hologram.level.values)
    greys.push_back(uint8_t(grey_of(level, hologram.levels, hologram.modulation, 8)));
  return greys;
}

bool is_hologram_file(const std::string& path) {
  if (extension_of(path) != ".png" || !is_file(path)) return false;
  if (!metadata_in(path).empty()) return true;
  const std::string sidecar = hologram_sidecar(path);
  return !sidecar.empty() && parse_json_if_sound(read_text(sidecar)).contains("modulation");
}

SeriesPart series_part(const std::string& path) {
  const std::string text = metadata_in(path);
  if (text.empty()) return {};
  const nlohmann::json json = parse_metadata(text, path);
  uint32_t number = 1, count = 1;
  MetadataReader(json, path)(key("part", number), key("parts", count));
  return {number, count};
}

FileRecord hologram_record(const std::string& path) {
  const nlohmann::json json = parse_json_if_sound(metadata_in(path));
  return json.contains("files") ? record_outside(path, record_from(json["files"])) : FileRecord();
}

ViewingConditions viewing_of_file(const std::string& path) {
  check_file_exists(path, "a hologram");
  const std::string text = metadata_in(path), beside = text.empty() ? hologram_sidecar(path) : "";
  if (text.empty() && beside.empty()) return {};
  const nlohmann::json json = beside.empty() ? parse_metadata(text, path) : read_metadata(beside);
  ViewingConditions viewing;
  if (json.contains("viewing")) {
    const std::string& place = beside.empty() ? path : beside;
    MetadataReader reader(json["viewing"], place);
    members(reader, viewing);
    check_viewing(viewing, place);
  }
  return viewing;
}

Hologram load_hologram(const std::string& path, const CompleteHologram& complete) {
  check_file_exists(path, "a hologram");
  const Greys greys = read_greys(path);
  Hologram hologram;
  hologram.levels = greys.bits == 8 ? 256 : 65536;
  hologram.grid.nx = greys.nx;
  hologram.grid.ny = greys.ny;
  const bool is_inside = !greys.metadata.empty();
  const std::string beside = is_inside ? "" : hologram_sidecar(path), sidecar = beside.empty() ? path : beside;
  if (is_inside || !beside.empty()) {
    const nlohmann::json json = is_inside ? parse_metadata(greys.metadata, path) : read_metadata(beside);
    read_hologram(json, path, sidecar, hologram);
  }
  if (complete) {
    const bool has_metadata = is_inside || !beside.empty();
    HologramParams given{hologram.image, hologram.modulation, hologram.levels, hologram.grid.pitch, 0, 0};
    complete(given);
    require(
        !has_metadata || (given.levels == hologram.levels && given.modulation == hologram.modulation),
        "expected --levels and --modulation only for files without metadata, got them for {}, whose metadata say {} levels; leave them out",
        path, hologram.levels);
    if (given.levels > 0) hologram.levels = given.levels;
    hologram.image = given.image;
    hologram.modulation = given.modulation;
    hologram.grid.pitch = given.pitch;
    if (hologram.wavelength == 0) hologram.wavelength = given.wavelength;
  }
  hologram.level = levels_of(greys, hologram.levels, hologram.modulation, path, sidecar);
  if (hologram.modulation == Modulation::complex) {
    const std::string modulus = modulus_path(path);
    check_file_exists(modulus, "the amplitudes of a complex hologram");
    hologram.modulus_level = levels_of(read_greys(modulus), hologram.levels, Modulation::amplitude, modulus, sidecar);
    require(hologram.modulus_level.nx == greys.nx && hologram.modulus_level.ny == greys.ny,
            "{}: expected {} × {} pixels, as {} has, got {} × {}", modulus, greys.nx, greys.ny, path,
            hologram.modulus_level.nx, hologram.modulus_level.ny);
  }
  return hologram;
}

}  // namespace holotrace
