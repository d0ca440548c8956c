#include "holotrace/io/scene/toml_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "holotrace/base/units.h"

namespace holotrace {
namespace {

// The kind of a value in words for error messages.
std::string describe_value(const toml::node& node) {
  if (const auto value = node.value_exact<int64_t>()) return fmt::format("the bare number {}", *value);
  if (const auto value = node.value_exact<double>()) return fmt::format("the bare number {}", *value);
  if (const auto value = node.value_exact<bool>()) return *value ? "true" : "false";
  if (const auto value = node.value_exact<std::string>()) return fmt::format("\"{}\"", *value);
  if (node.is_array()) return "a list";
  if (node.is_table()) return "a table";
  return "a date or time";
}

}  // namespace

std::optional<double> to_number(const toml::node& node) {
  if (const auto value = node.value_exact<int64_t>()) return double(*value);
  return node.value_exact<double>();
}

const std::string& TomlTable::file(const toml::source_region& source) const {
  return source.path ? *source.path : files_.front();
}

bool TomlTable::is_placed(const Error& error) const {
  const std::string_view sentence = error.what();
  return std::any_of(files_.begin(), files_.end(),
                     [&](const std::string& name) { return sentence.starts_with(name + ":"); });
}

std::string TomlTable::place(const toml::source_region& source) const {
  // Tables that the file does not define explicitly have no position of their own.
  return fmt::format("{}:{}:{}: ", file(source), std::max(source.begin.line, 1u), std::max(source.begin.column, 1u));
}

std::string TomlTable::where(const char* key) const {
  const toml::node* node = table_->get(key);
  return place(node ? node->source() : table_->source());
}

std::string TomlTable::beside(const char* key, const std::string& name) const {
  const toml::node* node = table_->get(key);
  const std::filesystem::path holder = file(node ? node->source() : table_->source());
  return (holder.parent_path() / name).string();
}

const toml::node* TomlTable::find(const char* key) {
  known_.insert(key);
  return table_->get(key);
}

void TomlTable::fail_kind(const char* key, const char* expected, const toml::node& got) const {
  fail("{}expected {} for \"{}\", got {}", place(got.source()), expected, key, describe_value(got));
}

void TomlTable::check(const char* key, const toml::node& node, double value, const Range& range,
                      Quantity quantity) const {
  try {
    check_range(value, range, quantity, fmt::format(" for \"{}\"", key));
  } catch (const Error& e) {
    throw Error(place(node.source()) + e.what());
  }
}

void TomlTable::count(const char* key, int& value, const Range& range, const char*) {
  int64_t wide = value;
  count(key, wide, range);
  require(wide <= std::numeric_limits<int>::max(), "{}expected at most {} for \"{}\", got {}", where(key),
          std::numeric_limits<int>::max(), key, wide);
  value = int(wide);
}

void TomlTable::count(const char* key, int64_t& value, const Range& range, const char*) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto whole = node->value_exact<int64_t>();
  if (!whole) fail_kind(key, "a whole number", *node);
  check(key, *node, double(*whole), range, Quantity::count);
  value = *whole;
}

void TomlTable::number(const char* key, double& value, const Range& range, const char*) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto number = to_number(*node);
  if (!number) fail_kind(key, "a number", *node);
  check(key, *node, *number, range, Quantity::number);
  value = *number;
}

void TomlTable::flag(const char* key, bool& value, const char*) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto flag = node->value_exact<bool>();
  if (!flag) fail_kind(key, "true or false", *node);
  value = *flag;
}

void TomlTable::text(const char* key, std::string& value) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto text = node->value_exact<std::string>();
  if (!text) fail_kind(key, "a text in quotes", *node);
  require(!text->empty(), "{}expected a text for \"{}\", got an empty one", where(key), key);
  value = *text;
}

std::string TomlTable::length_text(const char* key, const toml::node& node) const {
  const auto text = node.value_exact<std::string>();
  if (!text) fail_kind(key, "a length with its unit, such as \"300 mm\",", node);
  return *text;
}

std::vector<double> TomlTable::read_lengths(const char* key, const toml::node& node) const {
  std::vector<double> values;
  const auto append = [&](const toml::node& item) {
    try {
      const std::vector<double> some = parse_lengths(length_text(key, item));
      values.insert(values.end(), some.begin(), some.end());
    } catch (const Error& e) {
      if (is_placed(e)) throw;
      fail("{}{} for \"{}\"", place(item.source()), e.what(), key);
    }
  };
  if (const toml::array* items = node.as_array())
    for (const toml::node& item : *items) append(item);
  else
    append(node);
  return values;
}

void TomlTable::length(const char* key, double& value, const Range& range, const char*) {
  const toml::node* node = find(key);
  if (!node) return;
  const std::string text = length_text(key, *node);
  double metres = 0;
  try {
    metres = parse_length(text);
  } catch (const Error& e) {
    fail("{}{} for \"{}\"", where(key), e.what(), key);
  }
  check(key, *node, metres, range, Quantity::length);
  value = metres;
}

void TomlTable::lengths(const char* key, std::vector<double>& value, const Range& range, const char*) {
  const toml::node* node = find(key);
  if (!node) return;
  value = read_lengths(key, *node);
  require(!value.empty(), "{}expected one length or more for \"{}\", got none", where(key), key);
  for (const double one : value) check(key, *node, one, range, Quantity::length);
}

void TomlTable::texts(const char* key, std::vector<std::string>& value, const char*) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto append = [&](const toml::node& item) {
    const auto text = item.value_exact<std::string>();
    if (!text) fail_kind(key, "a text in quotes, or a list of them,", item);
    value.push_back(*text);
  };
  value.clear();
  if (const toml::array* list = node->as_array())
    for (const toml::node& item : *list) append(item);
  else
    append(*node);
}

void TomlTable::angle(const char* key, double& value, const Range& range, const char*) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto text = node->value_exact<std::string>();
  if (!text) fail_kind(key, "an angle with its unit, such as \"15 deg\",", *node);
  locate(key, [&] { value = parse_angle(*text); });
  check(key, *node, value, range, Quantity::angle);
}

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

void TomlTable::position(const char* key, Vec3& value, const Range& range_of_z, const char*) {
  length_vector(key, value);
  if (const toml::node* node = find(key)) try {
      check_range(value.z, range_of_z, Quantity::length, fmt::format(" for z of \"{}\"", key));
    } catch (const Error& e) {
      throw Error(place(node->source()) + e.what());
    }
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
    if (text->size() < 3 || std::string_view("xyz").find((*text)[0]) == std::string_view::npos || (*text)[1] != ' ')
      fail_kind(key, expected, item);
    double angle = 0;
    try {
      angle = parse_angle(std::string_view(*text).substr(2));
    } catch (const Error& e) {
      fail("{}{} for \"{}\"", place(item.source()), e.what(), key);
    }
    const Frame step = (*text)[0] == 'x'   ? rotation_x(angle)
                       : (*text)[0] == 'y' ? rotation_y(angle)
                                           : rotation_z(angle);
    value = compose(step, value);
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

std::optional<TomlTable> TomlTable::table(const char* key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (!node->is_table()) fail_kind(key, "a table", *node);
  return TomlTable(*node->as_table(), files_, fmt::format("[{}]", key));
}

std::vector<TomlTable> TomlTable::tables(const char* key) {
  std::vector<TomlTable> found;
  const toml::node* node = find(key);
  if (!node) return found;
  const toml::array* items = node->as_array();
  if (!items) fail_kind(key, "tables headed [[…]]", *node);
  for (const toml::node& item : *items) {
    if (!item.is_table()) fail_kind(key, "tables headed [[…]]", item);
    found.emplace_back(*item.as_table(), files_, fmt::format("[[{}]]", key));
  }
  return found;
}

std::vector<TomlTable> TomlTable::named_tables(const char* key, std::vector<std::string>& names) {
  std::vector<TomlTable> found;
  auto outer = table(key);
  if (!outer) return found;
  for (auto&& [name, node] : *outer->table_) {
    const std::string full = fmt::format("{}.{}", key, name.str());
    if (!node.is_table()) outer->fail_kind(full.c_str(), "a table", node);
    names.emplace_back(name.str());
    found.emplace_back(*node.as_table(), files_, "[" + full + "]");
  }
  return found;
}

void TomlTable::require_key(const char* key) {
  if (find(key)) return;
  for (auto&& [other, node] : *table_) {
    const std::string name(other.str());
    if (!known_.contains(name) && !nearest_name(name, {key}).empty())
      throw Error(place(other.source()) + unknown_name_message("key", name, {key}));
  }
  fail("{}expected the key \"{}\" in {}, which is missing", where(""), key, name_);
}

void TomlTable::refuse_unknown_keys() const {
  for (auto&& [key, node] : *table_) {
    const std::string name(key.str());
    if (known_.contains(name)) continue;
    throw Error(place(key.source()) + unknown_name_message("key", name, {known_.begin(), known_.end()}));
  }
}

}  // namespace holotrace
