#include "holotrace/io/scene/scene_edits.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {
namespace {

std::vector<std::string> parts_of(const std::string& key) {
  std::vector<std::string> parts;
  for (size_t at = 0; at <= key.size();) {
    const size_t end = std::min(key.find('.', at), key.size());
    parts.push_back(key.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

// The number of an element of a list, from 1; 0 for other texts.
size_t number_of(const std::string& part) {
  size_t number = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
  return error == std::errc() && end == part.data() + part.size() ? number : 0;
}

toml::node& element(toml::array& list, const std::string& part, const std::string& name) {
  const size_t number = number_of(part);
  require(number >= 1 && number <= list.size(), "{}: expected the number of an element from 1 to {}, got \"{}\"", name,
          list.size(), printable(part, 80));
  return list[number - 1];
}

// A table of one key, `value`.
toml::table parsed_value(const SceneEdit& edit, const std::string& name) {
  check_toml_nesting(edit.value, name);
  try {
    toml::table parsed = toml::parse("value = " + edit.value, name);
    if (parsed.size() == 1) return parsed;  // no second line with keys of its own
  } catch (const toml::parse_error&) {      // a text without quotes
  }
  toml::table text = toml::parse("value = ''", name);
  *text.get_as<std::string>("value") = edit.value;
  return text;
}

void apply(const SceneEdit& edit, toml::table& scene, const std::string& name) {
  toml::table value = parsed_value(edit, name);
  const std::vector<std::string> parts = parts_of(edit.key);
  toml::node* at = &scene;
  for (size_t i = 0; i + 1 < parts.size(); ++i) {
    if (toml::array* list = at->as_array()) {
      at = &element(*list, parts[i], name);
    } else if (toml::table* table = at->as_table()) {
      if (!table->contains(parts[i])) table->insert(toml::key(parts[i], value.source()), toml::table());
      at = table->get(parts[i]);
    } else {
      fail("{}: expected a table or a list before \"{}\", got a value", name, printable(parts[i], 80));
    }
  }
  if (toml::array* list = at->as_array()) {
    element(*list, parts.back(), name);
    const auto place = list->begin() + std::ptrdiff_t(number_of(parts.back()) - 1);
    list->insert(list->erase(place), std::move(*value.get("value")));
  } else if (toml::table* table = at->as_table()) {
    table->erase(parts.back());
    table->insert(toml::key(parts.back(), value.source()),
                  std::move(*value.get("value")));  // moved: it keeps its position
  } else {
    fail("{}: expected a table or a list before \"{}\", got a value", name, printable(parts.back(), 80));
  }
}

// "0 0 -300 mm", "y 30 deg", but no name and no file.
bool starts_with_number(const std::string& text) {
  std::istringstream words(text);
  std::string word;
  words >> word;
  if (word == "x" || word == "y" || word == "z") words >> word;
  double number = 0;
  if (word.starts_with('+')) word.erase(0, 1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size();
}

bool is_changeable(const toml::node& node) {
  if (to_number(node)) return true;
  if (const auto text = node.value<std::string>()) return starts_with_number(*text);
  const toml::array* list = node.as_array();
  return list && !list->empty() && list->size() <= 4 &&
         std::all_of(list->begin(), list->end(),
                     [](const toml::node& one) { return is_changeable(one) && !one.is_array(); });
}

std::string text_of(const toml::node& node) {
  if (const auto number = to_number(node)) return fmt::format("{}", *number);
  if (const toml::array* list = node.as_array()) {
    std::vector<std::string> parts;
    for (const toml::node& one : *list)
      parts.push_back(one.is_string() ? fmt::format("\"{}\"", text_of(one)) : text_of(one));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  return node.value_or(std::string());
}

// "box", "shape king", "mesh bunny".
std::string kind_of(const toml::table& table) {
  std::string kind = table["type"].value_or(std::string());
  for (const char* name : {"name", "shape"})
    if (const auto text = table[name].value<std::string>()) return kind.empty() ? *text : kind + " " + *text;
  return kind;
}

void list_values(const std::string& key, const toml::node& node, const std::string& of,
                 std::vector<SceneValue>& values) {
  if (const toml::table* table = node.as_table()) {
    if (is_over_time(*table)) return;
    for (auto&& [name, inner] : *table)
      list_values(fmt::format("{}.{}", key, name.str()), inner, kind_of(*table), values);
  } else if (is_changeable(node)) {
    values.push_back({{key, text_of(node)}, of});
  } else if (const toml::array* list = node.as_array()) {
    size_t number = 0;
    for (const toml::node& inner : *list)
      if (++number; inner.is_table()) list_values(fmt::format("{}.{}", key, number), inner, of, values);
  }
}

}  // namespace

SceneEdit parse_scene_edit(const std::string& text) {
  const size_t equals = text.find('=');
  const auto trimmed = [](std::string part) {
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
    return part;
  };
  const SceneEdit edit{trimmed(text.substr(0, equals)),
                       equals == std::string::npos ? "" : trimmed(text.substr(equals + 1))};
  require(!edit.key.empty() && !edit.value.empty(),
          "--set: expected KEY=VALUE, such as camera.pupil=\"3 mm\" or object.1.position=\"0 0 -300 mm\", got \"{}\"",
          printable(text, 80));
  return edit;
}

void apply_edits(const std::vector<SceneEdit>& edits, toml::table& scene, std::vector<std::string>& files) {
  for (const SceneEdit& edit : edits) {
    files.push_back("--set " + printable(edit.key, 80));
    apply(edit, scene, files.back());
  }
}

bool is_editable(const SceneEdit& edit) {
  const toml::table parsed = parsed_value(edit, edit.key);
  return is_changeable(*parsed.get("value"));
}

std::vector<SceneValue> editable_values(const toml::table& scene) {
  std::vector<SceneValue> values;
  const auto list_table = [&](const char* name) {
    if (const toml::node* node = scene.get(name)) list_values(name, *node, "", values);
  };
  list_table("object");
  if (const toml::array* objects = scene.get_as<toml::array>("object")) {
    size_t number = 0;
    for (const toml::node& object : *objects) {
      ++number;
      const toml::table* table = object.as_table();
      if (table && !table->contains("position") && !table->contains("positions"))
        values.push_back({{fmt::format("object.{}.position", number), "0 0 0 mm"}, kind_of(*table)});
    }
  }
  for (const char* name : {"light", "environment", "background", "materials", "shape"}) list_table(name);
  return values;
}

}  // namespace holotrace
