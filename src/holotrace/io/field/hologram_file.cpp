#include "holotrace/io/field/hologram_file.h"

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/field/effects_json.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

// Grey values per level: the grey of level ℓ is round(ℓ·scale).
double grey_scale(int levels, Modulation modulation, int bits) {
  const double greys = bits == 8 ? 256 : 65536;
  return modulation == Modulation::amplitude ? (greys - 1) / (levels - 1) : greys / levels;
}

void check_levels(int levels, const std::string& path) {
  require(levels >= 2 && levels <= 65536, "{}: expected 2 to 65536 levels, got {}", path, levels);
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
  slm.levels = int(metadata_number(json, sidecar, "levels"));
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
  try {
    check_slm(slm);
  } catch (const Error& error) {
    fail("{}: {}", sidecar, error.what());
  }
  return slm;
}

struct Greys {
  int nx = 0, ny = 0, bits = 8;
  std::vector<uint16_t> values;
};

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
  Greys greys{spec.width, spec.height, is_8 ? 8 : 16, std::vector<uint16_t>(count)};
  for (size_t i = 0; i < count; ++i) {
    const uint16_t* pixel = values.data() + i * channels;
    require(channels < 3 || (pixel[0] == pixel[1] && pixel[1] == pixel[2]),
            "{}: expected a grey hologram, got a coloured pixel at row {}, column {}", path, i / size_t(spec.width),
            i % size_t(spec.width));
    greys.values[i] = uint16_t(is_8 ? pixel[0] / 257 : pixel[0]);  // 8-bit values were widened by 65535/255 = 257
  }
  return greys;
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
  return json;
}

// Writes levels as greys; calls `before_named` when all is written but the file does not have its name yet.
void write_greys(const std::string& path, const Array2D<uint16_t>& levels_of_pixels, int levels, Modulation modulation,
                 const std::function<void()>& before_named = {}) {
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
  write_atomically(path, [&](const std::string& temporary) {
    const auto output = OIIO::ImageOutput::create(temporary);
    const void* values = bits == 8 ? static_cast<const void*>(bytes.data()) : greys.data();
    const bool written =
        output && output->open(temporary, spec) && output->write_image(spec.format, values) && output->close();
    require(written, "expected to write {}, got \"{}\"; check the room and the permissions there", path,
            output ? output->geterror() : OIIO::geterror());
    if (before_named) before_named();
  });
}

Array2D<uint16_t> levels_of(const Greys& greys, int levels, Modulation modulation, const std::string& path,
                            const std::string& sidecar) {
  const double scale = grey_scale(levels, modulation, greys.bits);
  Array2D<uint16_t> out(greys.ny, greys.nx);
  for (size_t i = 0; i < greys.values.size(); ++i) {
    const long level = std::lround(greys.values[i] / scale);
    require(level < levels && std::lround(double(level) * scale) == greys.values[i],
            "{}: expected the greys of {} levels, got {} at row {}, column {}; correct \"levels\" in {} or write the "
            "hologram again, without scaling or compression loss",
            path, levels, greys.values[i], i / size_t(greys.nx), i % size_t(greys.nx), sidecar);
    out.values[i] = uint16_t(level);
  }
  return out;
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

}  // namespace

void save_hologram(const std::string& path, const Hologram& hologram) {
  require(extension_of(path) == ".png", "expected a hologram file .png, got {}; change its extension", path);
  check_levels(hologram.levels, path);
  require(hologram.level.nx > 0 && hologram.level.ny > 0, "expected a hologram with pixels to save as {}, got {} × {}",
          path, hologram.level.nx, hologram.level.ny);
  nlohmann::ordered_json json{{"pitch_m", hologram.grid.pitch},
                              {"wavelength_m", hologram.wavelength},
                              {"levels", hologram.levels},
                              {"modulation", modulation_name(hologram.modulation)},
                              {"image", image_side_name(hologram.image)},
                              {"encoder", hologram.encoder},
                              {"illumination_w_per_m2", hologram.illumination}};
  for (const JointColour& colour : hologram.colours)
    json["colours"].push_back({{"wavelength_m", colour.wavelength}, {"illumination_w_per_m2", colour.illumination}});
  if (!hologram.name.empty()) json["name"] = hologram.name;
  if (hologram.frame > 0) json["frame"] = hologram.frame;
  if (hologram.cone_wavelength > 0) json["cone_wavelength_m"] = hologram.cone_wavelength;
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

  const auto write_sidecar = [&] { write_text(sidecar_path(path), json.dump(2) + "\n"); };
  write_greys(path, hologram.level, hologram.levels, hologram.modulation, write_sidecar);
}

Hologram load_hologram(const std::string& path) {
  check_file_exists(path, "a hologram");
  const Greys greys = read_greys(path);
  Hologram hologram;
  hologram.levels = greys.bits == 8 ? 256 : 65536;
  hologram.grid.nx = greys.nx;
  hologram.grid.ny = greys.ny;
  const std::string sidecar = sidecar_path(path);
  if (std::filesystem::exists(sidecar)) {
    const nlohmann::json json = read_metadata(sidecar);
    hologram.grid.pitch = metadata_number(json, sidecar, "pitch_m");
    hologram.wavelength = metadata_number(json, sidecar, "wavelength_m");
    require(hologram.grid.pitch >= 0 && hologram.wavelength >= 0,
            "{}: expected a pitch and a wavelength of 0 m or more, got {} m and {} m", sidecar, hologram.grid.pitch,
            hologram.wavelength);
    const double levels = metadata_number(json, sidecar, "levels", double(hologram.levels));
    require(levels == std::floor(levels) && levels >= 2 && levels <= 65536, "{}: expected 2 to 65536 levels, got {}",
            sidecar, levels);
    hologram.levels = int(levels);
    hologram.modulation = modulation_from(metadata_text(json, sidecar, "modulation", "phase"), sidecar);
    hologram.image = image_side_from(metadata_text(json, sidecar, "image", "virtual"), sidecar);
    hologram.encoder = metadata_text(json, sidecar, "encoder", "");
    hologram.illumination = metadata_number(json, sidecar, "illumination_w_per_m2", hologram.illumination);
    require(hologram.illumination >= 0, "{}: expected an illumination of 0 W/m² or more, got {} W/m²", sidecar,
            hologram.illumination);
    if (json.contains("colours")) hologram.colours = colours_from(json["colours"], sidecar);
    hologram.name = metadata_text(json, sidecar, "name", "");
    hologram.frame = frame_from(metadata_number(json, sidecar, "frame", 0.0), sidecar);
    hologram.cone_wavelength = metadata_number(json, sidecar, "cone_wavelength_m", 0.0);
    hologram.filter = filter_from_json(json, sidecar);
    hologram.effects = metadata_texts(json, sidecar, "effects");
    if (json.contains("slm")) hologram.slm = read_slm(json["slm"], hologram.grid, path, sidecar);
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
