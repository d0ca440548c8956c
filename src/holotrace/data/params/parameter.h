#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/suggest.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/params/choice.h"
#include "holotrace/data/params/device.h"
#include "holotrace/data/params/range.h"

// Every parameter of every stage is listed once: each header of this folder has one stage's parameters as a plain
// struct, and its `describe` lists their names, kinds, ranges and help texts. That list feeds scene files, flags, help
// texts and the checks of the library's verbs (check_ranges.h). `describe` calls a visitor with each parameter in turn:
//   describe([](const auto& parameter) { fmt::print("{}: {}\n", parameter.name, parameter.help); }, params);

namespace holotrace {

/// One parameter of a stage, whose value a visitor reads or sets. Made by the functions below.
template <class Value>
struct Parameter {
  const char* kind;  ///< name of the function that made it
  const char* name;  ///< key in scene files and in Python; the flag has dashes
  Value& value;
  std::string help;
  Range range{};                                   ///< of each number; of a position: of z
  Quantity quantity = Quantity::number;            ///< of each number
  std::initializer_list<Choice<Value>> choices{};  ///< of an enumeration; valid while `describe` runs
};

/// Whether a parameter of that type is one number.
template <class Value>
inline constexpr bool is_number =
    std::is_same_v<Value, int> || std::is_same_v<Value, int64_t> || std::is_same_v<Value, double>;

/// The value that a text names. @throws Error  if it names none
template <class Enum>
Enum value_named(const std::string& text, const Parameter<Enum>& parameter) {
  for (const Choice<Enum>& choice : parameter.choices)
    if (text == choice.name) return choice.value;
  throw Error(unknown_name_message(parameter.name, text, names_of(parameter.choices)));
}

// The kinds of parameters. The range is never left out: a parameter that may have any value says range::any.

/// A whole number, an int or int64_t.
template <class Integer>
Parameter<Integer> count(const char* name, Integer& value, const Range& range, const std::string& help) {
  return {"count", name, value, help, range, Quantity::count};
}
inline Parameter<double> number(const char* name, double& value, const Range& range, const std::string& help) {
  return {"number", name, value, help, range, Quantity::number};
}
/// In metres or, as texts, with a unit; so are all lengths.
inline Parameter<double> length(const char* name, double& value, const Range& range, const std::string& help) {
  return {"length", name, value, help, range, Quantity::length};
}
/// In radians or, as a text, with a unit.
inline Parameter<double> angle(const char* name, double& value, const Range& range, const std::string& help) {
  return {"angle", name, value, help, range, Quantity::angle};
}
inline Parameter<std::vector<double>> lengths(const char* name, std::vector<double>& value, const Range& range,
                                              const std::string& help) {
  return {"lengths", name, value, help, range, Quantity::length};
}
/// Three lengths, x and y of any sign.
inline Parameter<Vec3> position(const char* name, Vec3& value, const Range& range_of_z, const std::string& help) {
  return {"position", name, value, help, range_of_z, Quantity::length};
}
inline Parameter<bool> flag(const char* name, bool& value, const std::string& help) {
  return {"flag", name, value, help};
}
inline Parameter<std::vector<std::string>> texts(const char* name, std::vector<std::string>& value,
                                                 const std::string& help) {
  return {"texts", name, value, help};
}
/// One of a few names.
template <class Enum>
Parameter<Enum> choice(const char* name, Enum& value, std::initializer_list<std::type_identity_t<Choice<Enum>>> choices,
                       const std::string& help) {
  return {"choice", name, value, help, {}, {}, choices};
}
/// Where a stage computes: cpu, opencl, opencl:N or auto. @param work  what the device does: "propagates the field"
inline Parameter<DeviceChoice> device(const char* name, DeviceChoice& value, const std::string& work) {
  return {"device", name, value, device_help(work)};
}
/// The same for a stage that can also run on all devices at once: opencl:all.
inline Parameter<DeviceChoice> devices(const char* name, DeviceChoice& value, const std::string& work) {
  return {"device", name, value,
          device_help(work, "all OpenCL devices of the same model as the first one (opencl:all); ")};
}

}  // namespace holotrace
