// Readers of the positions, directions, rotations, outlines and colours of a TOML table.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "holotrace/base/quaternion.h"
#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/io/scene/toml_keys.h"

namespace holotrace {

Vec3 TomlTable::read_vector(const char* key, const toml::node& node) const {
  const std::vector<double> values = read_lengths(key, node);
  const char* example = std::string_view(key) == "size" ? "3 3 3 mm" : "0 0 -300 mm";
  require(values.size() == 3, "{}expected three lengths for \"{}\", such as \"{}\", got {}", place(node.source()), key,
          example, values.size());
  return {values[0], values[1], values[2]};
}

void TomlTable::length_vector(const char* key, Vec3& value, const Range& range) {
  interpolate(key, value, [&](const toml::node& node) {
    const Vec3 read = read_vector(key, node);
    for (const double one : {read.x, read.y, read.z}) check(key, node, one, range, Quantity::length);
    return read;
  });
}

void TomlTable::operator()(const Parameter<Vec3>& p) {
  length_vector(p.name, p.value);
  if (!has(p.name)) return;
  locate(p.name, [&] { check_range(p.value.z, p.range, p.quantity, fmt::format(" for z of \"{}\"", p.name)); });
}

void TomlTable::length_vectors(const char* key, std::vector<Vec3>& value) {
  interpolate(key, value, [&](const toml::node& node) {
    const toml::array* items = node.as_array();
    if (!items) fail_kind(key, "a list of texts such as \"0 0 -300 mm\"", node);
    require(!items->empty(), "{}expected one place or more for \"{}\", got none", place(node.source()), key);
    std::vector<Vec3> places;
    for (const toml::node& item : *items) places.push_back(read_vector(key, item));
    return places;
  });
}

void TomlTable::colour(const char* key, Vec3& value, double most) {
  const auto component = [&](const toml::node& item) {
    const auto number = to_number(item);
    if (!number) fail_kind(key, "a number or [red, green, blue]", item);
    if (!(std::isfinite(*number) && *number >= 0 && *number <= most)) {
      const std::string range = std::isfinite(most) ? fmt::format("from 0 to {}", most) : "of 0 or more";
      fail("{}expected finite numbers {} for \"{}\", got {}", place(item.source()), range, key, *number);
    }
    return *number;
  };
  interpolate(key, value, [&](const toml::node& node) -> Vec3 {
    const toml::array* items = node.as_array();
    if (!items) {
      const double grey = component(node);
      return {grey, grey, grey};
    }
    require(items->size() == 3, "{}expected a number or [red, green, blue] for \"{}\", got {} numbers",
            place(node.source()), key, items->size());
    return {component((*items)[0]), component((*items)[1]), component((*items)[2])};
  });
}

Vec3 TomlTable::read_direction(const char* key, const toml::node& node) const {
  const char* expected = "a direction [x, y, z] of three plain numbers";
  const toml::array* items = node.as_array();
  if (!items || items->size() != 3) fail_kind(key, expected, node);
  std::array<double, 3> numbers{};
  for (size_t i = 0; i < 3; ++i) {
    const auto number = to_number((*items)[i]);
    if (!number) fail_kind(key, expected, (*items)[i]);
    require(std::isfinite(*number), "{}expected finite numbers for \"{}\", got {}", place((*items)[i].source()), key,
            *number);
    numbers[i] = *number;
  }
  const Vec3 given{numbers[0], numbers[1], numbers[2]};
  const double size = std::hypot(given.x, given.y, given.z);
  require(size > 0 && std::isfinite(size), "{}expected a direction for \"{}\", got [0, 0, 0], which points nowhere",
          place(node.source()), key);
  return given / size;
}

void TomlTable::direction(const char* key, Vec3& value) {
  if (!has(key)) return;
  const auto* keys = table_->get_as<toml::table>(key);
  const bool is_stepped = keys && (*keys)["interpolation"].value_or(std::string()) == "step";
  std::optional<Vec3> before;  // between opposite directions a straight line has no direction
  interpolate(key, value, [&](const toml::node& node) {
    const Vec3 read = read_direction(key, node);
    require(is_stepped || !before || dot(*before, read) > -1 + 1e-9,
            "{}expected directions less than 180 deg apart for \"{}\", got opposite ones; add a key between",
            place(node.source()), key);
    before = read;
    return read;
  });
  const double size = std::hypot(value.x, value.y, value.z);
  value = value / size;
}

namespace {

using Turns = std::vector<AxisTurn>;

Frame composed(const Turns& turns) {
  Frame rotation;
  for (const AxisTurn& turn : turns) rotation = compose(rotation_of(turn), rotation);
  return rotation;
}

bool have_same_axes(const std::vector<Turns>& keys) {
  return std::all_of(keys.begin(), keys.end(), [&](const Turns& turns) {
    return std::equal(turns.begin(), turns.end(), keys[0].begin(), keys[0].end(),
                      [](const AxisTurn& a, const AxisTurn& b) { return a.axis == b.axis; });
  });
}

// Turns about the same axes by angle, so that "y 720 deg" is two turns. Others the shortest way, as quaternions.
Frame rotation_at(const std::vector<double>& times, const std::vector<Turns>& turns, Interpolation interpolation,
                  double now) {
  Keyframes keys{times, {}, interpolation};
  if (have_same_axes(turns)) {
    for (const Turns& one : turns) {
      keys.values.emplace_back();
      for (const AxisTurn& turn : one) keys.values.back().push_back(turn.angle);
    }
    Turns between = turns[0];
    const std::vector<double> angles = value_at(keys, now);
    for (size_t i = 0; i < between.size(); ++i) between[i].angle = angles[i];
    return composed(between);
  }
  std::vector<Quaternion> rotations;
  for (const Turns& one : turns) {
    Quaternion q = quaternion_of(composed(one));
    double cosine = 0;
    for (size_t i = 0; i < 4 && !rotations.empty(); ++i) cosine += q[i] * rotations.back()[i];
    if (cosine < 0)
      for (double& part : q) part = -part;
    rotations.push_back(q);
    keys.values.emplace_back(q.begin(), q.end());
  }
  const auto [key, part] = place_among(times, now);
  if (interpolation == Interpolation::linear && part > 0)
    return rotation_by(slerp(rotations[key], rotations[key + 1], part));
  const std::vector<double> q = value_at(keys, now);
  return rotation_by(normalize(Quaternion{q[0], q[1], q[2], q[3]}));
}

}  // namespace

void TomlTable::rotation(const char* key, Frame& value) {
  const toml::node* node = find_value(key);
  if (!node) return;
  const auto turn_of = [&](const toml::node& item) {
    const auto text = item.value_exact<std::string>();
    const char* expected = "an axis and an angle, such as \"y 30 deg\",";
    if (!text) fail_kind(key, expected, item);
    std::optional<AxisTurn> turn;
    try {
      turn = parse_turn(*text);
    } catch (const Error& e) {
      fail("{}{} for \"{}\"", place(item.source()), e.what(), key);
    }
    if (!turn) fail_kind(key, expected, item);
    return *turn;
  };
  const auto turns_of = [&](const toml::node& given) {
    const toml::array* items = given.as_array();
    if (!items) return Turns{turn_of(given)};
    Turns turns;
    for (const toml::node& item : *items) turns.push_back(turn_of(item));
    return turns;
  };
  if (!node->is_table()) {
    value = composed(turns_of(*node));
    return;
  }
  const Keys keys = keys_over_time(key, *node->as_table(), Interpolation::linear);
  std::vector<Turns> turns;
  for (const toml::node* one : keys.nodes) turns.push_back(turns_of(*one));
  value = rotation_at(keys.times, turns, keys.interpolation, time_->now);
}

void TomlTable::outline(const char* key, std::vector<Vec2>& value) {
  auto inner = table(key);
  if (!inner) return;
  inner->require_key("unit");
  inner->require_key("points");
  std::string unit;
  inner->text("unit", unit);
  const toml::node* node = inner->find("points");
  inner->refuse_unknown_keys();
  const toml::array* points = node->as_array();
  const char* expected = "a list of pairs [[1, 2], …]";
  if (!points) inner->fail_kind("points", expected, *node);
  value.clear();
  for (const toml::node& item : *points) {
    const toml::array* pair = item.as_array();
    if (!pair || pair->size() != 2) inner->fail_kind("points", expected, item);
    const auto coordinate = [&](const toml::node& number) {
      const auto in_units = to_number(number);
      if (!in_units) inner->fail_kind("points", "plain numbers", number);
      double metres = 0;
      // The number and its unit are parsed together, so that the value is rounded only once.
      inner->locate("unit", [&] { metres = parse_length(fmt::format("{} {}", *in_units, unit)); });
      return metres;
    };
    const double x = coordinate((*pair)[0]), y = coordinate((*pair)[1]);
    value.push_back({x, y});
  }
}

}  // namespace holotrace
