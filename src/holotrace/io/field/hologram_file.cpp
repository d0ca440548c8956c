#include "holotrace/io/field/hologram_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/field/effects_json.h"
#include "holotrace/io/field/grey_levels.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/json_text.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/record_names.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {
namespace {

void check_levels(double levels, const std::string& path) {
  require(levels == std::floor(levels) && levels >= 2 && levels <= 65536, "{}: expected 2 to 65536 levels, got {}",
          path, levels);
}

int read_levels(const nlohmann::json& json, const std::string& sidecar, std::optional<double> fallback = std::nullopt) {
  const double levels = metadata_number(json, sidecar, "levels", fallback);
  check_levels(levels, sidecar);
  return int(levels);
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

// Reads the panel of a sidecar, on the hologram's grid.
Slm read_slm(const nlohmann::json& json, const Grid& grid, const std::string& path, const std::string& sidecar) {
  require(json.is_object(), "{}: expected an object for \"slm\", got {}", sidecar, json.dump());
  Slm slm;
  slm.name = metadata_text(json, sidecar, "name", "");
  slm.grid = grid;
  slm.modulation = modulation_from(metadata_text(json, sidecar, "modulation", "phase"), sidecar);
  slm.levels = read_levels(json, sidecar);
  slm.fill_factor = metadata_number(json, sidecar, "fill_factor");
  slm.fill_x = metadata_number(json, sidecar, "fill_x", 0.0);
  slm.fill_y = metadata_number(json, sidecar, "fill_y", 0.0);
  slm.design_wavelength = metadata_number(json, sidecar, "design_wavelength_m");
  slm.phase_range = metadata_number(json, sidecar, "phase_range_rad", slm.phase_range);
  slm.preset = metadata_text(json, sidecar, "panel", "");
  slm.source = metadata_text(json, sidecar, "source", "");
  if (json.contains("effects")) slm.effects = effects_from_json(json["effects"], sidecar);
  if (json.contains("phase_map"))
    slm.effects.phase_map = load_map(phase_map_path(path), "the phase map of a hologram's panel");
  if (json.contains("light_map"))
    slm.effects.light_map = load_map(light_map_path(path), "the light map of a hologram's panel");
  if (json.contains("own_effects")) slm.own_effects = metadata_texts(json, sidecar, "own_effects");
  try {
    check_slm(slm);
  } catch (const Error& error) {
    fail("{}: {}", sidecar, error.what());
  }
  return slm;
}

// Longer texts than this are not read by libpng.
constexpr size_t longest_text = 7'000'000;

// The metadata beside a PNG without text, under its name or the one of earlier versions; empty if there is none.
std::string hologram_sidecar(const std::string& path) {
  std::error_code ignored;
  for (const std::string& sidecar : {sidecar_path(path), old_sidecar_path(path)})
    if (std::filesystem::exists(sidecar, ignored)) return sidecar;
  return "";
}

// The metadata inside a PNG; empty if there are none.
std::string metadata_in(const std::string& path) {
  return extension_of(path) == ".png" ? text_in_image(path, metadata_name) : "";
}

nlohmann::ordered_json to_json(const Slm& slm) {
  nlohmann::ordered_json json{{"name", slm.name},
                              {"modulation", modulation_name(slm.modulation)},
                              {"levels", slm.levels},
                              {"fill_factor", slm.fill_factor},
                              {"design_wavelength_m", slm.design_wavelength},
                              {"phase_range_rad", slm.phase_range}};
  if (slm.fill_x > 0) {
    json["fill_x"] = slm.fill_x;
    json["fill_y"] = slm.fill_y;
  }
  if (!slm.preset.empty()) json["panel"] = slm.preset;
  if (!slm.source.empty()) json["source"] = slm.source;
  if (nlohmann::ordered_json effects = effects_to_json(slm.effects); !effects.empty()) json["effects"] = effects;
  if (!slm.own_effects.empty()) json["own_effects"] = slm.own_effects;
  return json;
}

void read_losses(const nlohmann::json& list, const std::string& sidecar, Hologram& hologram) {
  hologram.loses_by_cone = hologram.loses_by_pixels = false;
  for (const nlohmann::json& loss : list) {
    require(list.is_array() && (loss == "cone" || loss == "pixels"),
            "{}: expected a list of \"cone\" and \"pixels\" as \"loses_by\", got another value", sidecar);
    (loss == "cone" ? hologram.loses_by_cone : hologram.loses_by_pixels) = true;
  }
}

std::vector<JointColour> colours_from(const nlohmann::json& json, const std::string& sidecar) {
  require(json.is_array(), "{}: expected a list of \"colours\", got another kind", sidecar);
  std::vector<JointColour> colours;
  for (const nlohmann::json& colour : json) {
    colours.push_back(
        {metadata_number(colour, sidecar, "wavelength_m"), metadata_number(colour, sidecar, "illumination_w_per_m2")});
    require(
        colours.back().wavelength > 0 && colours.back().illumination >= 0,
        "{}: expected \"colours\" with wavelengths above 0 m and illuminations of 0 W/m² or more, got {} m and {} W/m²",
        sidecar, colours.back().wavelength, colours.back().illumination);
  }
  return colours;
}

nlohmann::ordered_json to_json(const ViewingConditions& viewing) {
  nlohmann::ordered_json json{{"distances_m", viewing.distances}};
  if (viewing.pupil > 0) {
    json["pupil_m"] = viewing.pupil;
    json["eye_m"] = {viewing.eye.x, viewing.eye.y, viewing.eye.z};
  }
  return json;
}

ViewingConditions viewing_from(const nlohmann::json& json, const std::string& sidecar) {
  require(json.is_object(), "{}: expected an object for \"viewing\", got {}", sidecar, json.dump());
  ViewingConditions viewing;
  viewing.distances = metadata_numbers(json, sidecar, "distances_m");
  viewing.pupil = metadata_number(json, sidecar, "pupil_m", 0.0);
  if (json.contains("eye_m")) {
    const std::vector<double> eye = metadata_numbers(json, sidecar, "eye_m");
    require(eye.size() == 3, "{}: expected three numbers for \"eye_m\", got {}", sidecar, eye.size());
    viewing.eye = {eye[0], eye[1], eye[2]};
  }
  const bool are_distances = std::all_of(viewing.distances.begin(), viewing.distances.end(),
                                         [](double distance) { return std::isfinite(distance); });
  require(are_distances && viewing.pupil >= 0 && viewing.eye.z >= 0,
          "{}: expected finite distances, and a pupil and an eye's z of 0 m or more in \"viewing\", got {}", sidecar,
          json.dump());
  return viewing;
}

}  // namespace

void save_hologram(const std::string& path, const Hologram& hologram, const SeriesPart& part,
                   const std::function<FileRecord()>& files) {
  require(extension_of(path) == ".png", "expected a hologram file .png, got {}; change its extension", path);
  check_levels(hologram.levels, path);
  require(hologram.level.nx > 0 && hologram.level.ny > 0, "expected a hologram with pixels to save as {}, got {} × {}",
          path, hologram.level.nx, hologram.level.ny);
  nlohmann::ordered_json json{{"kind", "hologram"},
                              {"pitch_m", hologram.grid.pitch},
                              {"wavelength_m", hologram.wavelength},
                              {"levels", hologram.levels},
                              {"modulation", modulation_name(hologram.modulation)},
                              {"image", image_side_name(hologram.image)},
                              {"encoder", hologram.encoder},
                              {"illumination_w_per_m2", hologram.illumination}};
  for (const JointColour& colour : hologram.colours)
    json["colours"].push_back({{"wavelength_m", colour.wavelength}, {"illumination_w_per_m2", colour.illumination}});
  if (!hologram.label.name.empty()) json["name"] = hologram.label.name;
  if (hologram.label.frame > 0) json["frame"] = hologram.label.frame;
  if (hologram.label.cone_wavelength > 0) json["cone_wavelength_m"] = hologram.label.cone_wavelength;
  if (!hologram.loses_by_cone || !hologram.loses_by_pixels) {
    json["loses_by"] = nlohmann::json::array();
    if (hologram.loses_by_cone) json["loses_by"].push_back("cone");
    if (hologram.loses_by_pixels) json["loses_by"].push_back("pixels");
  }
  if (!hologram.effects.empty()) json["effects"] = hologram.effects;
  if (hologram.slm) json["slm"] = to_json(*hologram.slm);
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
  if (hologram.filter) json["filter"] = filter_to_json(*hologram.filter);
  if (hologram.viewing.are_known()) json["viewing"] = to_json(hologram.viewing);

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
  std::function<FileRecord()> files;
  for (size_t i = holograms.size(); i-- > 0;) {
    if (i == 0) files = [&] { return set.record_since(before); };
    save_hologram(set.path(numbered_path(name, i)), holograms[i], {i + 1, holograms.size()}, files);
  }
}

std::vector<uint8_t> greys_of(const Hologram& hologram) {
  require(hologram.levels <= 256, "expected at most 256 levels for greys of 8 bits, got {}", hologram.levels);
  std::vector<uint8_t> greys;
  for (const uint16_t level : hologram.level.values)
    greys.push_back(uint8_t(grey_of(level, hologram.levels, hologram.modulation, 8)));
  return greys;
}

bool is_hologram_file(const std::string& path) {
  std::error_code ignored;
  if (extension_of(path) != ".png" || !std::filesystem::is_regular_file(path, ignored)) return false;
  if (!metadata_in(path).empty()) return true;
  const std::string sidecar = hologram_sidecar(path);
  return !sidecar.empty() && parse_json_if_sound(read_text(sidecar)).contains("modulation");
}

SeriesPart series_part(const std::string& path) {
  const std::string text = metadata_in(path);
  if (text.empty()) return {};
  const nlohmann::json json = parse_metadata(text, path);
  return {size_t(frame_from(metadata_number(json, path, "part", 1), path)),
          size_t(frame_from(metadata_number(json, path, "parts", 1), path))};
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
  return json.contains("viewing") ? viewing_from(json["viewing"], beside.empty() ? path : beside) : ViewingConditions();
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
    hologram.grid.pitch = metadata_number(json, sidecar, "pitch_m");
    hologram.wavelength = metadata_number(json, sidecar, "wavelength_m");
    require(hologram.grid.pitch >= 0 && hologram.wavelength >= 0,
            "{}: expected a pitch and a wavelength of 0 m or more, got {} m and {} m", sidecar, hologram.grid.pitch,
            hologram.wavelength);
    hologram.levels = read_levels(json, sidecar, hologram.levels);
    hologram.modulation = modulation_from(metadata_text(json, sidecar, "modulation", "phase"), sidecar);
    hologram.image = image_side_from(metadata_text(json, sidecar, "image", "virtual"), sidecar);
    hologram.encoder = metadata_text(json, sidecar, "encoder", "");
    hologram.illumination = metadata_number(json, sidecar, "illumination_w_per_m2", hologram.illumination);
    require(hologram.illumination >= 0, "{}: expected an illumination of 0 W/m² or more, got {} W/m²", sidecar,
            hologram.illumination);
    if (json.contains("colours")) hologram.colours = colours_from(json["colours"], sidecar);
    hologram.label.name = metadata_text(json, sidecar, "name", "");
    hologram.label.frame = frame_from(metadata_number(json, sidecar, "frame", 0.0), sidecar);
    hologram.label.cone_wavelength = metadata_number(json, sidecar, "cone_wavelength_m", 0.0);
    if (json.contains("loses_by")) read_losses(json["loses_by"], sidecar, hologram);
    hologram.filter = filter_from_json(json, sidecar);
    hologram.effects = metadata_texts(json, sidecar, "effects");
    if (json.contains("viewing")) hologram.viewing = viewing_from(json["viewing"], sidecar);
    if (json.contains("slm")) hologram.slm = read_slm(json["slm"], hologram.grid, path, sidecar);
  }
  if (complete) {
    const bool has_metadata = is_inside || !beside.empty();
    HologramParams given{hologram.image, hologram.modulation, hologram.levels, hologram.grid.pitch, 0, 0};
    complete(given);
    require(!has_metadata || (given.levels == hologram.levels && given.modulation == hologram.modulation),
            "expected levels and modulation only for files without metadata; {} says that it has {} levels", path,
            hologram.levels);
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
