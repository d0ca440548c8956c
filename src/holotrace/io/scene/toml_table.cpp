#include "holotrace/io/scene/toml_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/animate.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/params/parameter_texts.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/scene/toml_keys.h"

namespace holotrace {
namespace {

// What the parser expected, by words of its own message.
std::string expected_by(std::string_view message, const std::string& line) {
  struct Case {
    std::string_view word, expected;
  };
  constexpr std::string_view value = "a value: a number, a text in quotes, true, false, or a list in [ ]";
  constexpr Case cases[] = {
      {"utf-8", "text in UTF-8, got other bytes"},
      {"surrogate", "characters of Unicode, got half of a pair"},
      {"control character", "text, got a control character"},
      {"escape", "an escape sequence such as \\n or \\\\ in a text"},
      {"while parsing string", "a text that ends with the quote that it began with"},
      {"redefine", "each key and each table once, got one twice"},
      {"already", "each key and each table once, got one twice"},
      {"duplicate", "each key and each table once, got one twice"},
      {"while parsing table header", "a table such as [camera] or [[object]]"},
      {"while parsing inline table", "a table such as { a = 1, b = 2 }"},
      {"while parsing array", "a list such as [1, 2, 3]"},
      {"nesting", "less nesting"},
      {"while parsing boolean", "true or false"},
      {"while parsing comment", "a comment of text after #"},
      {"end-of-file", "KEY = VALUE, but the file ends"},
      {"expected value", value},
      {"determine value type", value},
      {"while parsing key", "KEY = VALUE"},
      {"while parsing", "a number that fits, or a text in quotes, such as 12, 0.5, 1e-3 or \"8 um\""},
  };
  if (message.find("while parsing key") != std::string_view::npos && line.starts_with('['))
    message = "while parsing table header";
  for (const Case& c : cases)
    if (message.find(c.word) != std::string_view::npos) return std::string(c.expected);
  return "KEY = VALUE, a [TABLE] or a # comment";
}

std::string line_of(const std::string& text, uint32_t number) {
  constexpr size_t most = 60;
  size_t begin = 0;
  for (uint32_t line = 1; line < number && begin != std::string::npos; ++line) {
    begin = text.find('\n', begin);
    if (begin != std::string::npos) ++begin;
  }
  if (begin == std::string::npos) return "";
  const std::string line = text.substr(begin, text.find('\n', begin) - begin);
  return line.size() <= most ? line : line.substr(0, most) + "…";
}

}  // namespace

toml::table parse_toml(const std::string& path, const char* kind) {
  check_file_exists(path, kind);
  const std::string text = read_lines(path);
  check_toml_nesting(text, path);
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& e) {
    const auto at = e.source().begin;
    const std::string line = line_of(text, at.line);
    const std::string known = extension_of(path) == ".toml" ? "" : kind_by_bytes(path);
    if (!known.empty()) fail("{}: expected {}, got {}", path, kind, known);
    fail("{}:{}:{}: expected {}; the line is \"{}\"", path, at.line, at.column, expected_by(e.description(), line),
         line);
  }
}

namespace {

using Places = std::multimap<std::string, std::string>;  // by key

template <class Params>
void add_keys(Places& places, const char* table) {
  Params params;
  describe([&](const auto& key) { places.emplace(key.name, fmt::format("below [{}]", table)); }, params);
}

Places all_places() {
  Places places;
  for (const char* key : {"preset", "columns", "rows", "pitch", "levels", "fill_factor", "modulation"})
    places.emplace(key, "below [slm]");
  for (const char* key : {"type", "position", "rotation", "material", "width", "height", "radius", "scale", "file"})
    places.emplace(key, "below [[object]]");
  places.emplace("radiance", "below [[light]]");
  places.emplace("wavelength", "above all headings");
  places.emplace("background", "above all headings");
  add_keys<TraceParams>(places, "trace");
  add_keys<RenderParams>(places, "render");
  add_keys<SynthesizeParams>(places, "synthesize");
  add_keys<EncodeParams>(places, "encode");
  add_keys<ShowParams>(places, "show");
  add_keys<PropagateParams>(places, "propagate");
  add_keys<CameraParams>(places, "camera");
  add_keys<AnimateParams>(places, "animate");
  return places;
}

/// Where a scene file has a key of that name, for the message about one below the wrong heading: "below [trace]", "above
/// all headings". Empty if no stage, no panel and no scene has it.
std::vector<std::string> tables_with(const std::string& key) {
  static const Places places = all_places();
  std::vector<std::string> tables;
  const auto [begin, end] = places.equal_range(key);
  for (auto place = begin; place != end; ++place) tables.push_back(place->second);
  return tables;
}

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
  if (arrays_)
    return sentence.starts_with("[") || sentence.starts_with("the scene: ") || sentence.starts_with("the panel: ");
  return std::any_of(files_.begin(), files_.end(),
                     [&](const std::string& name) { return sentence.starts_with(name + ":"); });
}

std::string TomlTable::place(const toml::source_region& source) const {
  if (arrays_) return name_ + ": ";
  if (source.path && source.path->starts_with("--set ")) return *source.path + ": ";  // scene_edits.h
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

void TomlTable::count(const char* key, int& value, const Range& range) {
  int64_t wide = value;
  count(key, wide, range);
  require(wide <= std::numeric_limits<int>::max(), "{}expected at most {} for \"{}\", got {}", where(key),
          std::numeric_limits<int>::max(), key, wide);
  value = int(wide);
}

void TomlTable::count(const char* key, int64_t& value, const Range& range) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto whole = node->value_exact<int64_t>();
  if (!whole) fail_kind(key, "a whole number", *node);
  check(key, *node, double(*whole), range, Quantity::count);
  value = *whole;
}

void TomlTable::number(const char* key, double& value, const Range& range) {
  interpolate(key, value, [&](const toml::node& node) {
    auto number = to_number(node);
    const auto text = range.high <= 1 ? node.value_exact<std::string>() : std::nullopt;
    if (text && text->find('%') != std::string::npos) {  // a part of a whole
      try {
        number = parse_percent(*text);
      } catch (const Error& e) {
        throw Error(place(node.source()) + e.what());
      }
    }
    if (!number) fail_kind(key, "a number", node);
    require(range.low < 0 || range.high > 1 || !(*number >= 5 && *number <= 100),
            "{0}expected a part of 1 for \"{1}\", got {2:g}; write {3:g} or \"{2:g} %\"", place(node.source()), key,
            *number, *number / 100);
    check(key, node, *number, range, Quantity::number);
    return *number;
  });
}

void TomlTable::flag(const char* key, bool& value) {
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

// The text of a length or an angle. Numbers of tables in memory have the SI unit.
std::optional<std::string> TomlTable::text_with_unit(const toml::node& node, const char* unit) const {
  const auto number = arrays_ ? to_number(node) : std::nullopt;
  return number ? fmt::format("{} {}", *number, unit) : node.value_exact<std::string>();
}

std::optional<size_t> TomlTable::array_index(const char* key) {
  if (!arrays_) return std::nullopt;
  const toml::node* node = find(key);
  const auto index = node ? node->value_exact<int64_t>() : std::nullopt;
  if (!index || *index < 0) return std::nullopt;
  return size_t(*index);
}

TomlTable TomlTable::inner(const toml::table& table, std::string name) const {
  TomlTable made(table, files_, std::move(name));
  made.arrays_ = arrays_;
  made.time_ = time_;
  return made;
}

std::string TomlTable::length_text(const char* key, const toml::node& node, Quantity quantity) const {
  const bool is_time = quantity == Quantity::time;
  const auto text = text_with_unit(node, is_time ? "s" : "m");
  if (!text)
    fail_kind(key,
              fmt::format("a {} with its unit, such as \"{}\",", is_time ? "time" : "length",
                          is_time ? "0.5 s" : length_example(key))
                  .c_str(),
              node);
  // The largest number without a unit: 300 is meant to be 300 mm, and of a wavelength 532 to be 532 nm.
  const double longest = quantity == Quantity::wavelength ? 1e-3 : 10;
  const auto number = arrays_ && is_length(quantity) ? to_number(node) : std::nullopt;
  if (number && std::abs(*number) > longest)
    fail("{0}expected metres for \"{1}\", got {2:g}; write \"{2:g} {3}\", or \"{2:g} m\" if you mean it",
         place(node.source()), key, *number, quantity == Quantity::wavelength ? "nm" : "mm");
  return *text;
}

std::vector<double> TomlTable::read_lengths(const char* key, const toml::node& node, Quantity quantity) const {
  std::vector<double> values;
  const auto append = [&](const toml::node& item) {
    try {
      const std::vector<double> some = values_within(length_text(key, item, quantity), range::any, key, quantity);
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

void TomlTable::length(const char* key, double& value, const Range& range, Quantity quantity) {
  interpolate(key, value, [&](const toml::node& node) {
    const std::string text = length_text(key, node, quantity);
    double metres = 0;
    try {
      metres = value_within(text, range::any, key, quantity);
    } catch (const Error& e) {
      fail("{}{} for \"{}\"", place(node.source()), e.what(), key);
    }
    check(key, node, metres, range, quantity);
    return metres;
  });
}

void TomlTable::instant(const char* key, double& value, const Range& range) {
  length(key, value, range, Quantity::time);
}

void TomlTable::lengths(const char* key, std::vector<double>& value, const Range& range, Quantity quantity) {
  interpolate(key, value, [&](const toml::node& node) {
    const std::vector<double> read = read_lengths(key, node, quantity);
    require(!read.empty(), "{}expected one {} or more for \"{}\", got none", place(node.source()),
            quantity == Quantity::time ? "time" : "length", key);
    for (const double one : read) check(key, node, one, range, quantity);
    return read;
  });
}

void TomlTable::operator()(const Parameter<double>& p) {
  if (is_length(p.quantity)) return length(p.name, p.value, p.range, p.quantity);
  if (p.quantity == Quantity::angle) return angle(p.name, p.value, p.range);
  if (p.quantity == Quantity::time) return instant(p.name, p.value, p.range);
  number(p.name, p.value, p.range);
}

void TomlTable::operator()(const Parameter<DeviceChoice>& p) {
  std::string name;
  text(p.name, name);
  if (!name.empty()) locate(p.name, [&] { p.value = parse_device(name); });
}

void TomlTable::operator()(const Parameter<std::string>& p) {
  std::string name;
  text(p.name, name);
  if (!name.empty()) p.value = std::string_view(p.kind) == "path" ? beside(p.name, name) : name;
}

void TomlTable::operator()(const Parameter<std::vector<std::string>>& p) {
  const toml::node* node = find(p.name);
  if (!node) return;
  const auto append = [&](const toml::node& item) {
    const auto text = item.value_exact<std::string>();
    if (!text) fail_kind(p.name, "a text in quotes, or a list of them,", item);
    p.value.push_back(*text);
  };
  p.value.clear();
  if (const toml::array* list = node->as_array())
    for (const toml::node& item : *list) append(item);
  else
    append(*node);
}

void TomlTable::angle(const char* key, double& value, const Range& range) {
  interpolate(key, value, [&](const toml::node& node) {
    const auto text = text_with_unit(node, "rad");
    if (!text) fail_kind(key, "an angle with its unit, such as \"15 deg\",", node);
    double radians = 0;
    try {
      radians = parse_angle(*text);
      if (!node.is_string()) check_bare_angle(radians, key);
    } catch (const Error& e) {
      throw Error(place(node.source()) + e.what());
    }
    check(key, node, radians, range, Quantity::angle);
    return radians;
  });
}

std::optional<TomlTable> TomlTable::table(const char* key, const char* example) {
  const toml::node* node = find_value(key);
  if (!node) return std::nullopt;
  if (!node->is_table())
    fail_kind(key, arrays_ ? "a dict" : fmt::format("a table headed [{}], with {} below it,", key, example).c_str(),
              *node);
  return inner(*node->as_table(), fmt::format("[{}]", key));
}

std::vector<TomlTable> TomlTable::tables(const char* key) {
  std::vector<TomlTable> found;
  const toml::node* node = find_value(key);
  if (!node) return found;
  const std::string expected =
      arrays_ ? "a list of dicts, [{...}, ...]," : fmt::format("tables headed [[{}]], with two brackets,", key);
  const toml::array* items = node->as_array();
  if (!items) fail_kind(key, expected.c_str(), *node);
  for (const toml::node& item : *items) {
    if (!item.is_table()) fail_kind(key, expected.c_str(), item);
    found.push_back(
        inner(*item.as_table(), arrays_ ? fmt::format("[{}[{}]]", key, found.size()) : fmt::format("[[{}]]", key)));
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
    found.push_back(inner(*node.as_table(), "[" + full + "]"));
  }
  return found;
}

void TomlTable::require_key(const char* key) {
  if (find_value(key)) return;
  for (auto&& [other, node] : *table_) {
    const std::string name(other.str());
    if (!known_.contains(name) && !nearest_name(name, {key}).empty())
      throw Error(place(other.source()) + unknown_name_message("key", name, {key}));
  }
  fail("{}expected the key \"{}\" in {}, which is missing", where(""), key, name_);
}

void TomlTable::refuse_unknown_keys() const {
  std::set<std::string> names = known_;
  names.insert(asked_.begin(), asked_.end());
  for (auto&& [key, node] : *table_) {
    const std::string name(key.str());
    if (known_.contains(name)) continue;
    const std::vector<std::string> tables = tables_with(name);
    const bool is_known_elsewhere = !tables.empty() && nearest_name(name, {names.begin(), names.end()}).empty();
    throw Error(place(key.source()) +
                (is_known_elsewhere
                     ? fmt::format("unknown key \"{}\" in {}; it belongs {}", name, name_, fmt::join(tables, " or "))
                     : unknown_name_message("key", name, {names.begin(), names.end()})));
  }
}

}  // namespace holotrace
