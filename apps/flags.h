#pragma once

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/data/params/parameter_texts.h"

namespace holotrace {

/// The flag of a field: "field_of_view" becomes --field-of-view. Only "distances" becomes the singular --distance.
std::string dashed(std::string name);

/// Checks a number of a flag that is not in a parameter struct. @throws Error, naming the flag, outside the range
void check_flag(const char* flag, double value, const Range& range, Quantity quantity);

/// A length [m], an angle [rad], a time [s] or a size [bytes] from the text of a flag that is not in a parameter struct.
/// @throws Error, naming the flag, if the text is invalid or outside the range
double parse_length_flag(const char* flag, const std::string& text, const Range& range);
double parse_angle_flag(const char* flag, const std::string& text, const Range& range);
double parse_time_flag(const char* flag, const std::string& text);
double parse_size_flag(const char* flag, const std::string& text);

/// A wavelength [m], or several, from the text of --wavelength: lengths above 0, or names of lights.
/// @throws Error, naming the flag, if the text is invalid
double parse_wavelength_flag(const std::string& text);
std::vector<double> parse_wavelengths_flag(const std::string& text);

/// What the help text says of a flag: how it calls the value, what it is for, and its default.
struct FlagText {
  std::string kind, help, value;
};

/// The help text with the bounds, except a lower bound of 0 alone, which most parameters have.
std::string with_bounds(const std::string& help, const Range& range, Quantity quantity);

std::string format_lengths(const std::vector<double>& metres);
std::string format_times(const std::vector<double>& seconds);

template <class Value>
FlagText flag_text(const Parameter<Value>& p) {
  const std::string help = with_bounds(p.help, p.range, p.quantity);
  if constexpr (std::is_enum_v<Value>)
    return {fmt::format("{}", fmt::join(names_of(p.choices), "|")), help, name_of(p.value, p.choices)};
  else if constexpr (std::is_same_v<Value, bool>)
    return {"BOOL", help, p.value ? "true" : "false"};
  else if constexpr (std::is_same_v<Value, DeviceChoice>)
    return {"DEVICE", help, device_text(p.value)};
  else if constexpr (std::is_same_v<Value, std::string>)
    return {std::string_view(p.kind) == "text" ? "NAME" : "FILE", help, p.value.empty() ? "none" : p.value};
  else if constexpr (std::is_same_v<Value, std::vector<std::string>>)
    return {"TEXTS", help, fmt::format("{}", fmt::join(p.value, ", "))};
  else if constexpr (std::is_same_v<Value, std::vector<double>>)
    return p.quantity == Quantity::time ? FlagText{"TIMES", help, format_times(p.value)}
                                        : FlagText{"LENGTHS", help, format_lengths(p.value)};
  else if constexpr (std::is_same_v<Value, Vec3>)
    return {"LENGTHS", p.help, format_lengths({p.value.x, p.value.y, p.value.z})};
  else if (is_length(p.quantity))
    return {p.quantity == Quantity::wavelength ? "WAVELENGTH" : "LENGTH", help, format_length(p.value)};
  else if (p.quantity == Quantity::angle)
    return {"ANGLE", help, format_angle(p.value)};
  else if (p.quantity == Quantity::time)
    return {"TIME", help, format_time(p.value)};
  else if (p.quantity == Quantity::number)
    return {"NUMBER", help, fmt::format("{:g}", double(p.value))};
  else
    return {"N", help, fmt::format("{}", p.value)};
}

/// Flags made from the list of fields of a parameter struct (data/params/). They keep the text that
/// was given, so that a flag can replace a value of a scene file that is read later.
class Flags {
 public:
  Flags() = default;

  /// Flags of which some have other names than their fields, as where a command has flags of several stages.
  explicit Flags(std::map<std::string, std::string> other_names) : other_names_(std::move(other_names)) {}

  /// Adds a flag per field of `defaults`, except the fields in `without`. `group` is their heading in the help text.
  /// @param from  origin of the defaults of some fields, for the help text: "[the hologram's, or 300 mm]"
  template <class Params>
  void add(CLI::App& command, Params defaults, const std::set<std::string>& without = {}, const std::string& group = "",
           const std::map<std::string, std::string>& from = {}) {
    const auto add = [&](const auto& parameter) {
      if (without.count(parameter.name) == 0) add_flag(command, parameter.name, flag_text(parameter), group, from);
    };
    describe(add, defaults);
  }

  /// Adds a flag for each of the named fields of `defaults`.
  template <class Params>
  void add_only(CLI::App& command, Params defaults, const std::set<std::string>& names, const std::string& group = "") {
    const auto add = [&](const auto& parameter) {
      if (names.count(parameter.name) > 0) add_flag(command, parameter.name, flag_text(parameter), group);
    };
    describe(add, defaults);
  }

  /// Whether the flag of that field was given.
  bool has(const std::string& name) const { return texts_.count(name) > 0; }

  /// Texts of the flags that were given, by field.
  const std::map<std::string, std::string>& texts() const { return texts_; }

  /// Sets the fields whose flags were given. @throws Error for a text that is not a valid value.
  template <class Params>
  void apply(Params& params) const {
    set_from_texts(params, texts_, [this](const std::string& field) { return flag_of(field); });
  }

 private:
  std::string flag_of(const std::string& field) const {
    const auto other = other_names_.find(field);
    return dashed(other == other_names_.end() ? field : other->second);
  }
  void add_flag(CLI::App& command, const std::string& name, const FlagText& text, const std::string& group,
                const std::map<std::string, std::string>& from = {});
  void add_old_name(CLI::App& command, const std::string& name, const std::string& before);

  std::map<std::string, std::string> texts_;  // of the given flags, by field
  std::map<std::string, std::string> other_names_;
};

/// The arguments after the program's name, in which a flag that takes true or false and has neither behind it is true:
/// `--resample picture.png` becomes `--resample=true picture.png`.
std::vector<std::string> with_bare_flags(const CLI::App& app, int argc, const char* const* argv);

/// What is wrong with the arguments of the program, in one sentence, with the nearest known command or flag.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv);

}  // namespace holotrace
