// Readers of the positions, directions, rotations, outlines and colours of a TOML table.

#include <array>
#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

Vec3 TomlTable::read_vector(const char* key, const toml::node& node) const {
  const std::vector<double> values = read_lengths(key, node);
  require(values.size() == 3, "{}expected three lengths for \"{}\", such as \"0 0 -300 mm\", got {}",
          place(node.source()), key, values.size());
  return {values[0], values[1], values[2]};
}

void TomlTable::length_vector(const char* key, Vec3& value, const Range& range) {
  const toml::node* node = find(key);
  if (!node) return;
  value = read_vector(key, *node);
  for (const double one : {value.x, value.y, value.z}) check(key, *node, one, range, Quantity::length);
}

void TomlTable::operator()(const Parameter<Vec3>& p) {
  length_vector(p.name, p.value);
  if (!has(p.name)) return;
  locate(p.name, [&] { check_range(p.value.z, p.range, p.quantity, fmt::format(" for z of \"{}\"", p.name)); });
}

void TomlTable::length_vectors(const char* key, std::vector<Vec3>& value) {
  const toml::node* node = find(key);
  if (!node) return;
  const toml::array* items = node->as_array();
  if (!items) fail_kind(key, "a list of texts such as \"0 0 -300 mm\"", *node);
  require(!items->empty(), "{}expected one place or more for \"{}\", got none", where(key), key);
  value.clear();
  for (const toml::node& item : *items) value.push_back(read_vector(key, item));
}

void TomlTable::colour(const char* key, Vec3& value, double most) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto component = [&](const toml::node& item) {
    const auto number = to_number(item);
    if (!number) fail_kind(key, "a number or [red, green, blue]", item);
    if (!(std::isfinite(*number) && *number >= 0 && *number <= most)) {
      const std::string range = std::isfinite(most) ? fmt::format("from 0 to {}", most) : "of 0 or more";
      fail("{}expected finite numbers {} for \"{}\", got {}", place(item.source()), range, key, *number);
    }
    return *number;
  };
  if (const toml::array* items = node->as_array()) {
    require(items->size() == 3, "{}expected a number or [red, green, blue] for \"{}\", got {} numbers", where(key), key,
            items->size());
    value = {component((*items)[0]), component((*items)[1]), component((*items)[2])};
  } else {
    const double grey = component(*node);
    value = {grey, grey, grey};
  }
}

void TomlTable::direction(const char* key, Vec3& value) {
  const toml::node* node = find(key);
  if (!node) return;
  const char* expected = "a direction [x, y, z] of three plain numbers";
  const toml::array* items = node->as_array();
  if (!items || items->size() != 3) fail_kind(key, expected, *node);
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
          where(key), key);
  value = given / size;
}

void TomlTable::rotation(const char* key, Frame& value) {
  const toml::node* node = find(key);
  if (!node) return;
  value = Frame{};
  const auto turn = [&](const toml::node& item) {
    const auto text = item.value_exact<std::string>();
    const char* expected = "an axis and an angle, such as \"y 30 deg\",";
    if (!text) fail_kind(key, expected, item);
    std::optional<Frame> step;
    try {
      step = parse_rotation(*text);
    } catch (const Error& e) {
      fail("{}{} for \"{}\"", place(item.source()), e.what(), key);
    }
    if (!step) fail_kind(key, expected, item);
    value = compose(*step, value);
  };
  if (const toml::array* items = node->as_array())
    for (const toml::node& item : *items) turn(item);
  else
    turn(*node);
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
