#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/params/choice.h"
#include "holotrace/data/params/device.h"

namespace holotrace {

/// The values that a parameter may have: all finite values between two bounds and, if given, one more value beside
/// them ("0 or 2 to 65536").
struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool is_low_open = false, is_high_open = false;  ///< the bound itself is not allowed
  std::optional<double> beside{};                  ///< also allowed, such as 0 for "the program decides"

  /// Whether the range contains the value; false for infinity and NaN.
  bool has(double value) const;
};

/// No number of a job is larger: its square fits in single precision.
inline constexpr double most_number = 1e18;

/// What a parameter counts or measures; it decides how errors and help texts write the values.
enum class Quantity { count, number, length, wavelength, angle, time };

/// Wavelengths are lengths for which names of lights may stand (data/named_light.h).
constexpr bool is_length(Quantity quantity) { return quantity == Quantity::length || quantity == Quantity::wavelength; }

/// Ranges by name; each is used as an argument in `describe`.
namespace range {
inline constexpr Range any{};
inline constexpr Range positive{.low = 0, .is_low_open = true};
inline constexpr Range not_negative{.low = 0};
inline constexpr Range fraction{.low = 0, .high = 1};
inline constexpr Range fraction_above_0{.low = 0, .high = 1, .is_low_open = true};
inline constexpr Range half_angle{.low = 0, .high = std::numbers::pi / 2, .is_high_open = true};
inline constexpr Range tilt{
    .low = -std::numbers::pi / 2, .high = std::numbers::pi / 2, .is_low_open = true, .is_high_open = true};

constexpr Range at_least(double low) { return {.low = low}; }
constexpr Range from_to(double low, double high) { return {.low = low, .high = high}; }
constexpr Range above_to(double low, double high) { return {.low = low, .high = high, .is_low_open = true}; }
constexpr Range below(double low, double high) { return {.low = low, .high = high, .is_high_open = true}; }
constexpr Range between(double low, double high) {
  return {.low = low, .high = high, .is_low_open = true, .is_high_open = true};
}
constexpr Range or_value(double beside, Range range) {
  range.beside = beside;
  return range;
}
}  // namespace range

/// The bounds in words: "1 or more", "above 0 m", "0 to 1", "0 or 2 to 65536"; "" for any value.
std::string bounds_text(const Range& range, Quantity quantity);

/// A text for a valid value: "a length above 0 m", "a whole number of 1 or more".
std::string expected_text(const Range& range, Quantity quantity);

/// Checks a value against a range, most_length (base/units.h) and most_number; scene files, flags and the library's verbs all use it.
/// @param about  text between the range and the value: " for \"pupil\""
/// @throws Error "expected a length above 0 m for "pupil", got -1 mm"
void check_range(double value, const Range& range, Quantity quantity, const std::string& about = "");

// Every parameter of every stage is listed once: each header of this folder has one stage's parameters as a plain
// struct, and its `describe` lists their names, kinds, ranges and help texts. That list feeds scene files, flags, help
// texts and the checks of the library's verbs. `describe` calls a visitor with each parameter in turn:
//   describe([](const auto& parameter) { fmt::print("{}: {}\n", parameter.name, parameter.help); }, params);

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
/// A length for which the name of a light may stand.
inline Parameter<double> wavelength(const char* name, double& value, const Range& range, const std::string& help) {
  return {"wavelength", name, value, help, range, Quantity::wavelength};
}
/// In radians or, as a text, with a unit.
inline Parameter<double> angle(const char* name, double& value, const Range& range, const std::string& help) {
  return {"angle", name, value, help, range, Quantity::angle};
}
/// In seconds or, as a text, with a unit.
inline Parameter<double> time(const char* name, double& value, const Range& range, const std::string& help) {
  return {"time", name, value, help, range, Quantity::time};
}
inline Parameter<std::vector<double>> times(const char* name, std::vector<double>& value, const Range& range,
                                            const std::string& help) {
  return {"times", name, value, help, range, Quantity::time};
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
/// A name that only a file knows, such as that of a camera.
inline Parameter<std::string> text(const char* name, std::string& value, const std::string& help) {
  return {"text", name, value, help};
}
/// Path of a file. In a scene file it is relative to that file's folder.
inline Parameter<std::string> path(const char* name, std::string& value, const std::string& help) {
  return {"path", name, value, help};
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

/// Checks each parameter of a stage against the range that its list (`describe`) states. Each verb calls it first.
/// @throws Error, naming the first parameter outside its range
template <class Params>
void check_ranges(Params params) {
  const auto check_parameter = []<class Value>(const Parameter<Value>& p) {
    const auto check = [&](double value, const Range& range, const char* of = "") {
      check_range(value, range, p.quantity, fmt::format(" for {}\"{}\"", of, p.name));
    };
    if constexpr (is_number<Value>) {
      check(double(p.value), p.range);
    } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
      for (const double value : p.value) check(value, p.range);
    } else if constexpr (std::is_same_v<Value, Vec3>) {
      check(p.value.x, range::any);
      check(p.value.y, range::any);
      check(p.value.z, p.range, "z of ");
    } else if constexpr (std::is_same_v<Value, DeviceChoice>) {
      if (!runs_on_all_devices<Params>) require_one_device(p.value, fmt::format(" for \"{}\"", p.name));
    }
  };
  describe(check_parameter, params);
}

}  // namespace holotrace
