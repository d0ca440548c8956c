#pragma once

#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "holotrace/data/params/parameter.h"

namespace holotrace {

/// The value of each parameter of a stage as a text: equal texts mean equal values.
template <class Params>
std::vector<std::string> value_texts(Params params) {
  std::vector<std::string> texts;
  const auto add = [&]<class Value>(const Parameter<Value>& parameter) {
    const Value& value = parameter.value;
    if constexpr (std::is_enum_v<Value>)
      texts.push_back(fmt::format("{}", int(value)));
    else if constexpr (std::is_same_v<Value, DeviceChoice>)
      texts.push_back(device_text(value));
    else if constexpr (std::is_same_v<Value, Vec3>)
      texts.push_back(fmt::format("{} {} {}", value.x, value.y, value.z));
    else
      texts.push_back(fmt::format("{}", value));
  };
  describe(add, params);
  return texts;
}

/// Names of the parameters of a stage that differ from their defaults.
template <class Params>
std::vector<std::string> changed_parameters(Params params) {
  const std::vector<std::string> given = value_texts(params), usual = value_texts(Params());
  std::vector<std::string> names;
  size_t i = 0;
  const auto add = [&](const auto& parameter) {
    if (given[i] != usual[i]) names.emplace_back(parameter.name);
    ++i;
  };
  describe(add, params);
  return names;
}

}  // namespace holotrace
