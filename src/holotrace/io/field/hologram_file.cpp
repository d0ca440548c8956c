#include "holotrace/io/field/hologram_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/slm.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/field/stored_levels.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/picture/panel_image_file.h"

namespace holotrace {
namespace {

void check_levels(double levels, const std::string& path) {
  require(levels == std::floor(levels) && levels >= 2 && levels <= 65536, "{}: expected 2 to 65536 levels, got {}",
          path, levels);
}

// Path of a file beside a hologram: "out/h.png" → "out/h_modulus.png", the amplitudes of a complex one, with its ending, and
// "out/h_phase_map.exr" and "out/h_light_map.exr", the maps of its panel.
std::string beside(const std::string& path, const char* ending) {
  return path.substr(0, path.size() - extension_of(path).size()) + ending;
}
std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }
std::string modulus_path(const std::string& path) { return path_with_suffix(path, "_modulus"); }
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
  require(
      json.value("kind", "") != panel_image_kind,
      "{}: expected a hologram, got a picture for a panel ({} says what was done to it); use the hologram that it was made of",
      path, sidecar);
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

// The sum of all levels: metadata beside a file know by it whether another program has written the file again.
uint64_t sum_of(const Array2D<uint16_t>& levels) {
  return std::accumulate(levels.values.begin(), levels.values.end(), uint64_t(0));
}

// Longer texts than this are not read by libpng.
constexpr size_t longest_text = 7'000'000;

// The metadata beside a file; empty if there are none. Earlier versions wrote some beside a PNG, also as NAME.json. Beside other
// files there may be JSON of other programs.
std::string hologram_sidecar(const std::string& path) {
  const std::string sidecar = sidecar_path(path);
  if (extension_of(path) != ".png")
    return is_file(sidecar) && has_kind(parse_json_if_sound(read_text(sidecar, most_text))) ? sidecar : "";
  for (const std::string& one : {sidecar, old_sidecar_path(path)})
    if (is_there(one)) return one;
  return "";
}

// The metadata inside a PNG; empty if there are none.
std::string metadata_in(const std::string& path) {
  return extension_of(path) == ".png" ? text_in_image(path, hologram_text) : "";
}

// The metadata of a hologram's file, and the file that has them; null if there are none.
struct Metadata {
  nlohmann::json json;
  std::string file;
};

Metadata metadata_of(const std::string& path) {
  const std::string inside = metadata_in(path);
  if (!inside.empty()) return {parse_metadata(inside, path), path};
  const std::string beside = hologram_sidecar(path);
  if (beside.empty()) return {nullptr, path};
  return {read_metadata(beside), beside};
}

}  // namespace

void check_hologram_path(const std::string& path) {
  const std::string ending = extension_of(path);
  const bool has_loss = ending == ".jpg" || ending == ".jpeg";
  const std::vector<std::string>& endings = panel_image_endings();
  require(std::find(endings.begin(), endings.end(), ending) != endings.end(),
          "expected a hologram file .png, .bmp, .tif, .npy or .csv, got {}{}; change its extension", path,
          has_loss ? ", and a JPEG would change the levels of its pixels" : "");
}

void save_hologram(const std::string& path, const Hologram& hologram, const SeriesPart& part,
                   const std::function<FileRecord()>& files) {
  check_hologram_path(path);
  check_levels(hologram.levels, path);
  require(hologram.level.nx > 0 && hologram.level.ny > 0, "expected a hologram with pixels to save as {}, got {} × {}",
          path, hologram.level.nx, hologram.level.ny);
  MetadataWriter writer{.json = {{"kind", hologram_kind}}};
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
    write_levels(modulus, hologram.modulus_level, hologram.levels, Modulation::amplitude);
  }
  if (part.count > 1) {
    json["part"] = part.number;
    json["parts"] = part.count;
  }
  if (const FileRecord record = files ? files() : FileRecord(); !record.empty())
    json["files"] = record_json(record_inside(path, record));
  const bool is_png = extension_of(path) == ".png";
  if (!is_png) json["level_sum"] = sum_of(hologram.level);
  const std::string text = json.dump(-1, ' ', true);  // ASCII, as PNG asks for
  const bool is_inside = is_png && text.size() <= longest_text;
  write_levels(path, hologram.level, hologram.levels, hologram.modulation, is_inside ? text : "");
  if (!is_inside) write_text(sidecar_path(path), text + "\n");
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

std::vector<Channel> hologram_channels(const std::string& path) {
  check_file_exists(path, "a hologram");
  if (is_hologram_file(path)) return {Channel::grey};
  if (!read_stored_levels(path).has_colours()) return {Channel::grey};
  return {Channel::red, Channel::green, Channel::blue};
}

bool is_hologram_file(const std::string& path) {
  const std::vector<std::string>& endings = panel_image_endings();
  if (std::find(endings.begin(), endings.end(), extension_of(path)) == endings.end() || !is_file(path)) return false;
  if (!metadata_in(path).empty()) return true;
  const std::string sidecar = hologram_sidecar(path);
  return !sidecar.empty() && parse_json_if_sound(read_text(sidecar)).contains("modulation");
}

SeriesPart series_part(const std::string& path) {
  const Metadata metadata = metadata_of(path);
  if (metadata.json.is_null()) return {};
  uint32_t number = 1, count = 1;
  MetadataReader(metadata.json, metadata.file)(key("part", number), key("parts", count));
  return {number, count};
}

FileRecord hologram_record(const std::string& path) {
  const std::string inside = metadata_in(path);
  if (inside.empty()) return record_beside(path);
  const nlohmann::json json = parse_json_if_sound(inside);
  return json.contains("files") ? record_outside(path, record_from(json["files"])) : FileRecord();
}

ViewingConditions viewing_of_file(const std::string& path) {
  check_file_exists(path, "a hologram");
  const Metadata metadata = metadata_of(path);
  ViewingConditions viewing;
  if (metadata.json.contains("viewing")) {
    MetadataReader reader(metadata.json["viewing"], metadata.file);
    members(reader, viewing);
    check_viewing(viewing, metadata.file);
  }
  return viewing;
}

Hologram load_hologram(const std::string& path, const CompleteHologram& complete) {
  check_file_exists(path, "a hologram");
  const StoredLevels stored = read_stored_levels(path);
  Hologram hologram;
  hologram.levels = stored.levels;
  hologram.grid.nx = stored.nx;
  hologram.grid.ny = stored.ny;
  const Metadata metadata = metadata_of(path);
  const bool has_metadata = !metadata.json.is_null();
  if (has_metadata) read_hologram(metadata.json, path, metadata.file, hologram);
  Channel channel = Channel::grey;
  if (complete) {
    HologramParams given{hologram.image, hologram.modulation, hologram.levels, hologram.grid.pitch, 0, 0, channel};
    complete(given);
    require(
        !has_metadata || (given.levels == hologram.levels && given.modulation == hologram.modulation &&
                          given.channel == Channel::grey),
        "expected --levels, --modulation and --channel only for files without metadata, got them for {}, whose metadata say {} "
        "levels; leave them out",
        path, hologram.levels);
    if (given.levels > 0) hologram.levels = given.levels;
    hologram.image = given.image;
    hologram.modulation = given.modulation;
    hologram.grid.pitch = given.pitch;
    if (hologram.wavelength == 0) hologram.wavelength = given.wavelength;
    channel = given.channel;
  }
  require(hologram.levels > 0, "{}: expected the number of levels of this table, which reach {}; give --levels", path,
          stored.greatest());
  hologram.level =
      levels_of(stored, channel, hologram.levels, hologram.modulation, path, has_metadata ? metadata.file : "");
  require(
      !metadata.json.contains("level_sum") || metadata.json["level_sum"] == sum_of(hologram.level),
      "{0}: expected the levels of which {1} has the metadata, got others; remove {1} if another program has written {0}",
      path, metadata.file);
  if (hologram.modulation == Modulation::complex) {
    const std::string modulus = modulus_path(path);
    check_file_exists(modulus, "the amplitudes of a complex hologram");
    hologram.modulus_level = levels_of(read_stored_levels(modulus), Channel::grey, hologram.levels,
                                       Modulation::amplitude, modulus, metadata.file);
    require(hologram.modulus_level.nx == stored.nx && hologram.modulus_level.ny == stored.ny,
            "{}: expected {} × {} pixels, as {} has, got {} × {}", modulus, stored.nx, stored.ny, path,
            hologram.modulus_level.nx, hologram.modulus_level.ny);
  }
  return hologram;
}

}  // namespace holotrace
