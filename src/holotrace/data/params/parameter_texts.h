#pragma once

#include <fmt/ranges.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/params/parameter.h"

namespace holotrace {

/// Checks an angle that was given as a number without a unit [rad]: 90 is meant to be 90 deg. Phases and delays may be larger.
/// @throws Error  if it is beyond a turn
void check_bare_angle(double radians, const std::string& name);

/// Returns what `read` returns; puts the name of the flag in front of an Error that it throws.
template <class Read>
auto read_flag(const std::string& flag, const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", flag, error.what()));
  }
}

/// A number from a text, for the parameter of that name: a length [m], an angle [rad], a time [s], or a plain number. Names of
/// lights are taken if the quantity is a wavelength. @throws Error if it is invalid or outside the range
double value_within(const std::string& text, const Range& range, const std::string& name, Quantity quantity);

/// Several lengths or times.
std::vector<double> values_within(const std::string& text, const Range& range, const std::string& name,
                                  Quantity quantity);

/// Sets a parameter from a text. @throws Error for a text that is not a valid value
void set_from_text(const Parameter<int>& parameter, const std::string& text);
void set_from_text(const Parameter<int64_t>& parameter, const std::string& text);
void set_from_text(const Parameter<double>& parameter, const std::string& text);
void set_from_text(const Parameter<bool>& parameter, const std::string& text);
void set_from_text(const Parameter<std::vector<double>>& parameter, const std::string& text);
void set_from_text(const Parameter<Vec3>& parameter, const std::string& text);
void set_from_text(const Parameter<std::vector<std::string>>& parameter, const std::string& text);
void set_from_text(const Parameter<DeviceChoice>& parameter, const std::string& text);
void set_from_text(const Parameter<std::string>& parameter, const std::string& text);
template <class Enum>
void set_from_text(const Parameter<Enum>& parameter, const std::string& text) {
  parameter.value = value_named(text, parameter);
}

/// Sets the parameters for which texts are given, such as the values of flags or of a query.
/// @param texts       by parameter
/// @param shown_name  what an error calls a parameter, such as its flag
/// @throws Error for a text that is not a valid value, naming the parameter
template <class Params, class ShownName>
void set_from_texts(Params& params, const std::map<std::string, std::string>& texts, const ShownName& shown_name) {
  const auto set = [&](const auto& parameter) {
    const auto text = texts.find(parameter.name);
    if (text != texts.end()) read_flag(shown_name(parameter.name), [&] { set_from_text(parameter, text->second); });
  };
  describe(set, params);
}

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
