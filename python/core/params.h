#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/data/params/parameter.h"
#include "values.h"

// Parameters of a stage as keyword arguments, made from the list of the stage in data/params/.

namespace holotrace::python {

/// Sets a parameter from a value of Python. @throws Error for an invalid one, naming the parameter
template <class Value>
void set_param(const Parameter<Value>& p, nb::handle given) {
  if constexpr (std::is_enum_v<Value>) {
    p.value = value_named(to_text(given, p.name), p);
  } else if constexpr (std::is_same_v<Value, bool>) {
    p.value = to_flag(given, p.name);
  } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
    p.value = to_texts(given, p.name);
  } else if constexpr (std::is_same_v<Value, std::string>) {
    p.value = to_text(given, p.name);
  } else if constexpr (std::is_same_v<Value, DeviceChoice>) {
    p.value = parse_device(to_text(given, p.name));
  } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
    p.value = to_lengths(given, p.name, p.quantity);
    for (const double one : p.value) check_named(one, p.range, p.quantity, p.name);
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    p.value = to_position(given, p.name);
    check_range(p.value.z, p.range, p.quantity, fmt::format(" for z of \"{}\"", p.name));
  } else if constexpr (std::is_same_v<Value, double>) {
    const double number = is_length(p.quantity)           ? to_length(given, p.name, p.quantity)
                          : p.quantity == Quantity::angle ? to_angle(given, p.name)
                          : p.quantity == Quantity::time  ? to_time(given, p.name)
                                                          : to_number(given, p.name);
    check_named(number, p.range, p.quantity, p.name);
    p.value = number;
  } else {
    const int64_t whole = to_count(given, p.name);
    check_named(double(whole), p.range, p.quantity, p.name);
    const Value most = std::numeric_limits<Value>::max();
    require(whole <= int64_t(most), "expected at most {} for \"{}\", got {}", most, p.name, whole);
    p.value = Value(whole);
  }
}

/// Sets the parameters that are given as keyword arguments. None leaves a parameter as it is.
/// @throws Error for unknown names, naming the nearest, and for invalid values, naming the parameter
template <class Params>
void set_params(const nb::dict& given, Params& params) {
  std::vector<std::string> known;
  const auto set = [&](const auto& parameter) {
    known.emplace_back(parameter.name);
    if (given.contains(parameter.name) && !given[parameter.name].is_none()) set_param(parameter, given[parameter.name]);
  };
  describe(set, params);
  for (const auto& [key, value] : given) {
    const std::string name = nb::cast<std::string>(key);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(unknown_name_message("parameter", name, known));
  }
}

/// The value of a parameter for Python.
template <class Value>
nb::object param_value(const Parameter<Value>& p) {
  if constexpr (std::is_enum_v<Value>)
    return nb::str(name_of(p.value, p.choices));
  else if constexpr (std::is_same_v<Value, DeviceChoice>)
    return nb::str(device_text(p.value).c_str());
  else if constexpr (std::is_same_v<Value, Vec3>)
    return nb::make_tuple(p.value.x, p.value.y, p.value.z);
  else if constexpr (std::is_same_v<Value, std::vector<double>> || std::is_same_v<Value, std::vector<std::string>>)
    return nb::tuple(nb::cast(p.value));
  else
    return nb::cast(p.value);
}

/// Name, kind, value, bounds, help text and choices of each parameter.
template <class Params>
nb::list list_params(Params params) {
  nb::list list;
  const auto add = [&](const auto& parameter) {
    const bool is_position = std::string(parameter.kind) == "position";
    nb::dict one;
    one["name"] = parameter.name;
    one["kind"] = parameter.kind;
    one["value"] = param_value(parameter);
    one["bounds"] = is_position ? "" : bounds_text(parameter.range, parameter.quantity);
    one["help"] = parameter.help;
    one["choices"] = nb::cast(names_of(parameter.choices));
    list.append(one);
  };
  describe(add, params);
  return list;
}

}  // namespace holotrace::python
