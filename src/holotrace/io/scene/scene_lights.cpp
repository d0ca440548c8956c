#include "holotrace/io/scene/scene_lights.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <string_view>
#include <variant>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/light_spectrum.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/scene/scene_images.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

Spectrum load_spectrum(const std::string& path) {
  check_file_exists(path, "a table of a spectrum");
  Spectrum spectrum;
  for (const auto& [where, line, words] : read_rows(path)) {
    try {
      require(words.size() == 3, "too few or many words");
      const double wavelength = parse_length(words[0] + " " + words[1]);
      double value = 0;
      const auto [end, error] = std::from_chars(words[2].data(), words[2].data() + words[2].size(), value);
      require(error == std::errc() && end == words[2].data() + words[2].size(), "no number");
      spectrum.wavelengths.push_back(wavelength);
      spectrum.values.push_back(value);
    } catch (const Error&) {
      fail("{}expected a wavelength with its unit and a value, such as \"450 nm 0.8\", got \"{}\"", where, line);
    }
    require(std::isfinite(spectrum.values.back()) && spectrum.values.back() >= 0,
            "{}expected a spectrum of 0 or more, got {}", where, spectrum.values.back());
    const auto& known = spectrum.wavelengths;
    require(known.size() == 1 || known.back() > known[known.size() - 2],
            "{}expected wavelengths in ascending order, got {} after {}", where, format_length(known.back()),
            format_length(known.size() == 1 ? 0 : known[known.size() - 2]));
  }
  require(spectrum.wavelengths.size() >= 2, "{}: expected two lines or more such as \"450 nm 0.8\", got {}", path,
          spectrum.wavelengths.size());
  try {
    return scaled_to_luminance(std::move(spectrum));
  } catch (const Error& e) {
    fail("{}: {}", path, e.what());
  }
}

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

Vec3 read_power(TomlTable& table, const char* key) {
  Vec3 value;
  table.require_key(key);
  table.colour(key, value, unbounded);
  return value;
}

Spectrum read_led(TomlTable& table) {
  double peak = 0, width = 0;
  table.require_key("peak");
  table.require_key("width");
  table.length("peak", peak, range::positive, Quantity::wavelength);
  table.length("width", width, range::positive);
  table.refuse_unknown_keys();
  Spectrum spectrum;
  table.locate("peak", [&] { spectrum = led_spectrum(peak, width); });
  return spectrum;
}

Vec3 read_place(TomlTable& table, const char* key) {
  Vec3 value;
  table.require_key(key);
  table.length_vector(key, value);
  return value;
}

// The direction in which the light travels: `direction`, or from its position to `target`.
Vec3 read_direction(TomlTable& table, Vec3 position) {
  Vec3 direction{0, 0, -1}, target;
  require(!(table.has("direction") && table.has("target")), "{}expected either \"direction\" or \"target\", got both",
          table.where("target"));
  table.length_vector("target", target);
  if (table.has("target")) {
    const Vec3 way = target - position;
    require(length(way) > 0, "{}expected a target away from the light's position, got the same place",
            table.where("target"));
    return normalize(way);
  }
  table.require_key("direction");
  table.direction("direction", direction);
  return direction;
}

PointLight read_point(TomlTable& table) {
  PointLight light;
  light.position = read_place(table, "position");
  light.intensity = read_power(table, "intensity");
  return light;
}

SpotLight read_spot(TomlTable& table) {
  SpotLight light;
  light.position = read_place(table, "position");
  light.direction = read_direction(table, light.position);
  light.intensity = read_power(table, "intensity");
  table.require_key("outer_angle");
  table.angle("outer_angle", light.outer_angle, range::above_to(0, pi));
  table.angle("inner_angle", light.inner_angle, range::not_negative);
  require(light.inner_angle <= light.outer_angle,
          "{}expected an inner angle from 0 deg to the outer angle of {}, got {}", table.where("inner_angle"),
          format_angle(light.outer_angle), format_angle(light.inner_angle));
  return light;
}

// Reads the position first: the direction to a target needs it.
DirectionalLight read_directional(TomlTable& table) {
  DirectionalLight light;
  table.length_vector("position", light.position);
  light.direction = read_direction(table, light.position);
  light.irradiance = read_power(table, "irradiance");
  return light;
}

DirectionalLight read_laser_beam(TomlTable& table) {
  table.require_key("position");
  DirectionalLight light = read_directional(table);
  light.is_laser = true;
  table.length("radius", light.radius, range::positive);
  return light;
}

RectangleLight read_rectangle(TomlTable& table) {
  RectangleLight light;
  light.corner = read_place(table, "corner");
  light.edge_u = read_place(table, "edge_u");
  light.edge_v = read_place(table, "edge_v");
  light.radiance = read_power(table, "radiance");
  if (table.has("visible")) table.flag("visible", light.is_visible);
  require(length(cross(light.edge_u, light.edge_v)) > 0,
          "{}expected edges edge_u and edge_v that span a rectangle, got parallel or empty ones", table.where(""));
  return light;
}

Light read_type(TomlTable& table, const std::string& type) {
  if (type == "point") return read_point(table);
  if (type == "spot") return read_spot(table);
  if (type == "directional") return read_directional(table);
  if (type == "rectangle") return read_rectangle(table);
  if (type == "laser-point") {
    PointLight light = read_point(table);
    light.is_laser = true;
    return light;
  }
  if (type == "laser-beam") return read_laser_beam(table);
  throw Error(table.where("type") +
              unknown_name_message("light type", type,
                                   {"point", "spot", "directional", "rectangle", "laser-point", "laser-beam"}));
}

Image read_environment_map(TomlTable& table) {
  Image map = with_three_channels(read_image(table, "map"));
  std::string path = "the array";
  if (!table.array_index("map")) table.text("map", path);
  path = table.beside("map", path);
  require(map.nx == 2 * map.ny,
          "{}: expected an environment map, equirectangular and so twice as wide as high, got {} × {} pixels", path,
          map.nx, map.ny);
  const auto dark = std::find_if(map.values.begin(), map.values.end(), [](float value) { return value < 0; });
  if (dark != map.values.end()) {
    const size_t pixel = size_t(dark - map.values.begin()) / 3;
    fail("{}: expected an environment map with light of 0 or more, got {} at row {}, column {}", path, *dark,
         pixel / size_t(map.nx), pixel % size_t(map.nx));
  }
  return map;
}

Sky read_sky(TomlTable& table) {
  Sky sky;
  table.require_key("elevation");
  table.number("turbidity", sky.turbidity, range::from_to(1.7, 10));
  table.angle("elevation", sky.elevation, range::from_to(0, pi / 2));
  table.angle("azimuth", sky.azimuth, range::any);
  table.flag("sun", sky.has_sun);
  table.refuse_unknown_keys();
  return sky;
}

}  // namespace

std::optional<double> kelvins_in(const std::string& text) {
  double kelvins = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), kelvins);
  const std::string_view unit(end, size_t(text.data() + text.size() - end));
  return error == std::errc() && (unit == " K" || unit == "K") ? std::optional(kelvins) : std::nullopt;
}

std::shared_ptr<const Spectrum> read_spectrum(TomlTable& table, const char* key) {
  const toml::node* node = table.find(key);
  if (!node) return nullptr;
  if (node->is_table()) {
    auto led = *table.table(key);
    return std::make_shared<Spectrum>(read_led(led));
  }
  std::string name;
  table.text(key, name);
  Spectrum spectrum;
  table.locate(key, [&] {
    if (const auto kelvins = kelvins_in(name))
      spectrum = blackbody_spectrum(*kelvins);
    else if (name.find('.') != std::string::npos)
      spectrum = load_spectrum(table.beside(key, name));
    else
      spectrum = illuminant_spectrum(name);
  });
  return std::make_shared<Spectrum>(std::move(spectrum));
}

Light read_light(TomlTable table) {
  table.require_key("type");
  std::string type;
  table.text("type", type);
  Light light = read_type(table, type);
  if (auto spectrum = read_spectrum(table, "spectrum")) {
    require(type.substr(0, 5) != "laser",
            "{}expected a lamp without a \"spectrum\", got a laser, whose light has one wavelength",
            table.where("spectrum"));
    std::visit([&](auto& l) { l.spectrum = spectrum; }, light);
  }
  table.refuse_unknown_keys();
  return light;
}

Environment read_environment(TomlTable table) {
  Environment environment;
  table.know("map");
  table.colour("scale", environment.scale, unbounded);
  if (auto sky = table.table("sky", "elevation = \"30 deg\"")) {
    require(!table.has("map"), "{}expected either a \"map\" or a \"sky\" in [environment], got both",
            table.where("sky"));
    environment.sky = read_sky(*sky);
    table.refuse_unknown_keys();
    return environment;
  }
  table.require_key("map");
  table.angle("turn", environment.turn, range::any);
  table.refuse_unknown_keys();
  table.locate("map", [&] { environment.map = std::make_shared<Image>(read_environment_map(table)); });
  return environment;
}

}  // namespace holotrace
