#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/choice.h"

namespace holotrace {

/// A visitor of `describe` that lists the name and the value of each parameter.
struct ValueLister {
  std::vector<std::pair<std::string, std::string>> values{};

  template <class Value>
  void add(const char* name, const Value& value) {
    values.emplace_back(name, fmt::format("{}", value));
  }
  template <class Integer>
  void count(const char* name, Integer& value, const Range&, const char*) {
    add(name, value);
  }
  void number(const char* name, double& value, const Range&, const char*) { add(name, value); }
  void length(const char* name, double& value, const Range&, const char*) { add(name, value); }
  void angle(const char* name, double& value, const Range&, const char*) { add(name, value); }
  void lengths(const char* name, std::vector<double>& value, const Range&, const char*) {
    std::string all;
    for (const double one : value) all += fmt::format("{} ", one);
    add(name, all);
  }
  void position(const char* name, Vec3& value, const Range&, const char*) {
    add(name, fmt::format("{} {} {}", value.x, value.y, value.z));
  }
  void flag(const char* name, bool& value, const char*) { add(name, value); }
  void texts(const char* name, std::vector<std::string>& value, const char*) {
    std::string all;
    for (const std::string& one : value) all += fmt::format("{} {}", one.size(), one);
    add(name, all);
  }
  void device(const char* name, DeviceChoice& value, const char*) { add(name, device_text(value)); }
  template <class Enum>
  void choice(const char* name, Enum& value, std::initializer_list<std::type_identity_t<Choice<Enum>>>, const char*) {
    add(name, int(value));
  }
};

/// Names of the parameters of a stage that differ from their defaults.
template <class Params>
std::vector<std::string> changed_parameters(Params params) {
  Params defaults;
  ValueLister given, usual;
  describe(given, params);
  describe(usual, defaults);
  std::vector<std::string> names;
  for (size_t i = 0; i < given.values.size(); ++i)
    if (given.values[i].second != usual.values[i].second) names.push_back(given.values[i].first);
  return names;
}

}  // namespace holotrace
