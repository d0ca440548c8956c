// Keys over time of the values of a TOML table.

#include "holotrace/io/scene/toml_keys.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "holotrace/base/units.h"

namespace holotrace {
namespace {

constexpr std::string_view interpolation_key = "interpolation";

bool is_time(std::string_view key) {
  try {
    parse_time(key);
    return true;
  } catch (const Error&) {
    return false;
  }
}

Interpolation interpolation_named(const std::string& name) {
  const auto choices = {Choice<Interpolation>{"linear", Interpolation::linear},
                        {"smooth", Interpolation::smooth},
                        {"step", Interpolation::step}};
  for (const auto& choice : choices)
    if (name == choice.name) return choice.value;
  throw Error(unknown_name_message("interpolation", name, {"linear", "smooth", "step"}));
}

}  // namespace

bool is_over_time(const toml::table& table) {
  return std::any_of(table.begin(), table.end(), [](const auto& item) { return is_time(item.first.str()); });
}

TomlTable::Keys TomlTable::keys_over_time(const char* key, const toml::table& table, Interpolation otherwise) const {
  require(time_ != nullptr, "{}expected one value for \"{}\" in {}, got a table; these values do not change over time",
          place(table.source()), key, name_);
  struct Key {
    double time;
    std::string text;
    const toml::source_region* source;
    const toml::node* node;
  };
  std::vector<Key> found;
  Keys keys{{}, {}, otherwise};
  for (auto&& [name, node] : table) {
    const std::string text(name.str());
    const std::string here = place(name.source());
    if (text == interpolation_key) {
      const auto given = node.value_exact<std::string>();
      if (!given) fail_kind("interpolation", "\"linear\", \"smooth\" or \"step\"", node);
      try {
        keys.interpolation = interpolation_named(*given);
      } catch (const Error& e) {
        throw Error(place(node.source()) + e.what());
      }
      require(otherwise != Interpolation::step || keys.interpolation == Interpolation::step,
              "{}expected the interpolation \"step\" for \"{}\", which has no values between its keys, got \"{}\"",
              place(node.source()), key, *given);
      continue;
    }
    try {
      found.push_back({parse_time(text), text, &name.source(), &node});
    } catch (const Error& e) {
      fail("{}{} as a key over time of \"{}\"", here, e.what(), key);
    }
  }
  require(!found.empty(), "{}expected keys over time {{ \"0 s\" = …, \"1 s\" = … }} for \"{}\", got none",
          place(table.source()), key);
  // The parser sorts keys by their texts. Tables in memory have no order.
  const auto order = [](const Key& one) { return std::pair(one.source->begin.line, one.source->begin.column); };
  std::stable_sort(found.begin(), found.end(), [&](const Key& a, const Key& b) { return order(a) < order(b); });
  const auto is_before = [](const Key& a, const Key& b) { return a.time < b.time; };
  if (arrays_) std::sort(found.begin(), found.end(), is_before);
  for (size_t i = 1; i < found.size(); ++i)
    require(is_before(found[i - 1], found[i]),
            "{}expected the keys over time of \"{}\" in their order, each time once, got \"{}\" after \"{}\"",
            place(*found[i].source), key, found[i].text, found[i - 1].text);
  for (const Key& one : found) {
    keys.times.push_back(one.time);
    keys.nodes.push_back(one.node);
    time_->note(one.time);
  }
  return keys;
}

const toml::node* TomlTable::find_value(const char* key) {
  known_.insert(key);
  return table_->get(key);
}

const toml::node* TomlTable::find(const char* key) {
  const toml::node* node = find_value(key);
  if (!node || !node->is_table() || !is_over_time(*node->as_table())) return node;
  const Keys keys = keys_over_time(key, *node->as_table(), Interpolation::step);
  return keys.nodes[place_among(keys.times, time_->now).key];
}

}  // namespace holotrace
