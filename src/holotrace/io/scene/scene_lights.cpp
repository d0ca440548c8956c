#include "holotrace/io/scene/scene_lights.h"

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/scene/scene_images.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

Vec3 read_power(TomlTable& table, const char* key) {
  Vec3 value;
  table.require_key(key);
  table.colour(key, value, unbounded);
  return value;
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

}  // namespace

Light read_light(TomlTable table) {
  table.require_key("type");
  std::string type;
  table.text("type", type);
  const Light light = read_type(table, type);
  table.refuse_unknown_keys();
  return light;
}

Environment read_environment(TomlTable table) {
  Environment environment;
  table.require_key("map");
  table.colour("scale", environment.scale, unbounded);
  table.angle("turn", environment.turn, range::any);
  table.refuse_unknown_keys();
  table.locate("map", [&] { environment.map = std::make_shared<Image>(read_environment_map(table)); });
  return environment;
}

}  // namespace holotrace
