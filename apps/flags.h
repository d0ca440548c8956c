#pragma once

#include <algorithm>
#include <charconv>
#include <functional>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/params/choice.h"
#include "holotrace/data/params/text_setter.h"

namespace holotrace {

/// The flag of a field: "field_of_view" becomes --field-of-view. Only "distances" becomes the singular --distance.
std::string dashed(std::string name);

/// Checks a number of a flag that is not in a parameter struct. @throws Error, naming the flag, outside the range
void check_flag(const char* flag, double value, const Range& range, Quantity quantity);

/// A length [m], lengths [m], an angle [rad] or a size [bytes] from the text of a flag that is not in a parameter struct.
/// @throws Error, naming the flag, if the text is invalid or outside the range
double parse_length_flag(const char* flag, const std::string& text, const Range& range);
std::vector<double> parse_lengths_flag(const char* flag, const std::string& text, const Range& range);
double parse_angle_flag(const char* flag, const std::string& text, const Range& range);
double parse_size_flag(const char* flag, const std::string& text);

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
  void add(Command& command, Params defaults, const std::set<std::string>& without = {}, const std::string& group = "",
           const std::map<std::string, std::string>& from = {}) {
    Adder adder{command, texts_, other_names_, without, false, group, from};
    describe(adder, defaults);
  }

  /// Adds a flag for each of the named fields of `defaults`.
  template <class Params>
  void add_only(Command& command, Params defaults, const std::set<std::string>& names, const std::string& group = "") {
    Adder adder{command, texts_, other_names_, names, true, group, {}};
    describe(adder, defaults);
  }

  /// Whether the flag of that field was given.
  bool has(const std::string& name) const { return texts_.count(name) > 0; }

  /// Texts of the flags that were given, by field.
  const std::map<std::string, std::string>& texts() const { return texts_; }

  /// Sets the fields whose flags were given. @throws Error for a text that is not a valid value.
  template <class Params>
  void apply(Params& params) const {
    TextSetter setter(texts_, [this](const std::string& field) { return flag_of(field, other_names_); });
    describe(setter, params);
  }

 private:
  using Texts = std::map<std::string, std::string>;  // texts of the given flags, by field

  static std::string flag_of(const std::string& field, const std::map<std::string, std::string>& other_names) {
    const auto other = other_names.find(field);
    return dashed(other == other_names.end() ? field : other->second);
  }

  struct Adder {
    Command& command;
    Texts& given;
    const std::map<std::string, std::string>& other_names;
    const std::set<std::string>& names;
    bool is_only;  // fields that are named, or all others
    const std::string& group;
    const std::map<std::string, std::string>& from;  // origin of a field's default

    void add(const std::string& name, const std::string& help, const std::string& shown, const std::string& kind);
    void add_old_name(const std::string& name, const std::string& before);
    void add_count(const char* name, const std::string& shown, const Range& range, const char* help);
    void add_choice(const char* name, const std::vector<std::string>& names_of_values, const std::string& shown,
                    const char* help);

    template <class Integer>
    void count(const char* name, Integer& v, const Range& range, const char* help) {
      add_count(name, std::to_string(v), range, help);
    }
    void number(const char* name, double& v, const Range& range, const char* help);
    void flag(const char* name, bool& v, const char* help);
    void length(const char* name, double& v, const Range& range, const char* help);
    void angle(const char* name, double& v, const Range& range, const char* help);
    void lengths(const char* name, std::vector<double>& v, const Range& range, const char* help);
    void position(const char* name, Vec3& v, const Range& range_of_z, const char* help);
    void texts(const char* name, std::vector<std::string>& v, const char* help);
    void device(const char* name, DeviceChoice& v, const char* help);
    template <class Enum>
    void choice(const char* name, Enum& v, std::initializer_list<Choice<Enum>> choices, const char* help) {
      std::vector<std::string> known;
      std::string shown;
      for (const auto& c : choices) {
        known.emplace_back(c.name);
        if (c.value == v) shown = c.name;
      }
      add_choice(name, known, shown, help);
    }
  };

  Texts texts_;
  std::map<std::string, std::string> other_names_;
};

}  // namespace holotrace
