#pragma once

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/suggest.h"
#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/params/choice.h"
#include "holotrace/data/params/renamed.h"
#include "say.h"

namespace holotrace {

/// The flag of a field: "field_of_view" becomes --field-of-view. Only "distances" becomes the singular --distance.
inline std::string dashed(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name == "distances" ? "--distance" : "--" + name;
}

/// Returns what `read` returns; puts the name of the flag in front of an Error that it throws.
template <class Read>
auto read_flag(const std::string& flag, const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", flag, error.what()));
  }
}

/// Checks a number of a flag that is not in a parameter struct. @throws Error, naming the flag, outside the range
inline void check_flag(const char* flag, double value, const Range& range, Quantity quantity) {
  read_flag(flag, [&] { check_range(value, range, quantity); });
}

/// Reads a length [m], lengths [m] or an angle [rad] from a text. @throws Error if it is invalid or outside the range
inline double length_within(const std::string& text, const Range& range) {
  const double metres = parse_length(text);
  check_range(metres, range, Quantity::length);
  return metres;
}
inline std::vector<double> lengths_within(const std::string& text, const Range& range) {
  std::vector<double> lengths = parse_lengths(text);
  for (const double metres : lengths) check_range(metres, range, Quantity::length);
  return lengths;
}
inline double angle_within(const std::string& text, const Range& range) {
  const double radians = parse_angle(text);
  check_range(radians, range, Quantity::angle);
  return radians;
}

/// The same for a flag that is not in a parameter struct. @throws Error, naming the flag
inline double parse_length_flag(const char* flag, const std::string& text, const Range& range) {
  return read_flag(flag, [&] { return length_within(text, range); });
}
inline std::vector<double> parse_lengths_flag(const char* flag, const std::string& text, const Range& range) {
  return read_flag(flag, [&] { return lengths_within(text, range); });
}
inline double parse_angle_flag(const char* flag, const std::string& text, const Range& range) {
  return read_flag(flag, [&] { return angle_within(text, range); });
}

/// A size [bytes] from a flag. @throws Error, naming the flag
inline double parse_size_flag(const char* flag, const std::string& text) {
  return read_flag(flag, [&] { return parse_size(text); });
}

/// Flags made from the list of fields of a parameter struct (data/params/). They keep the text that
/// was given, so that a flag can replace a value of a scene file that is read later.
class Flags {
 public:
  /// Adds a flag per field of `defaults`, except the fields in `without`. `group` is their heading in the help text.
  template <class Params>
  void add(CLI::App& app, Params defaults, const std::set<std::string>& without = {}, const std::string& group = "") {
    Adder adder{app, texts_, without, false, group};
    describe(adder, defaults);
  }

  /// Adds a flag for each of the named fields of `defaults`.
  template <class Params>
  void add_only(CLI::App& app, Params defaults, const std::set<std::string>& names, const std::string& group = "") {
    Adder adder{app, texts_, names, true, group};
    describe(adder, defaults);
  }

  /// Whether the flag of that field was given.
  bool has(const std::string& name) const { return texts_.count(name) > 0; }

  /// Sets the fields whose flags were given. @throws Error for a text that is not a valid value.
  template <class Params>
  void apply(Params& params) const {
    Setter setter{texts_};
    describe(setter, params);
  }

 private:
  using Texts = std::map<std::string, std::string>;  // texts of the given flags, by field

  struct Adder {
    CLI::App& app;
    Texts& given;
    const std::set<std::string>& names;
    bool is_only;  // fields that are named, or all others
    const std::string& group;

    void add(const std::string& name, const std::string& help, const std::string& shown, const std::string& kind) {
      if ((names.count(name) > 0) != is_only) return;
      const std::string other = name == "distances" ? ",--distances" : "";
      const auto keep = [&given = given, name](const std::string& text) { given[name] = text; };
      CLI::Option* option =
          app.add_option_function<std::string>(dashed(name) + other, keep, help + " [" + shown + "]")->type_name(kind);
      if (!group.empty()) option->group(group);
      if (const char* before = name_before(name)) add_old_name(name, before);
    }
    // The flag with its old name; the help text leaves it out. Its callback is called after that of the new one.
    void add_old_name(const std::string& name, const std::string& before) {
      const auto keep = [&given = given, name, before](const std::string& text) {
        if (given.count(name)) throw CLI::ExcludesError(dashed(before), dashed(name));
        given[name] = text;
        say("warning: {}\n", renamed_message(dashed(before), dashed(name)));
      };
      app.add_option_function<std::string>(dashed(before), keep)->group("");
    }
    // The help text states bounds, except a lower bound of 0 alone, which most parameters have.
    static std::string with_bounds(const char* help, const Range& range, Quantity quantity) {
      const bool is_plain = range.low == 0 && !range.is_low_open && !std::isfinite(range.high);
      const std::string bounds = bounds_text(range, quantity);
      return is_plain || bounds.empty() ? help : fmt::format("{} ({})", help, bounds);
    }
    template <class Integer>
    void count(const char* name, Integer& v, const Range& range, const char* help) {
      add(name, with_bounds(help, range, Quantity::count), fmt::to_string(v), "N");
    }
    void number(const char* name, double& v, const Range& range, const char* help) {
      add(name, with_bounds(help, range, Quantity::number), fmt::format("{:g}", v), "NUMBER");
    }
    void flag(const char* name, bool& v, const char* help) { add(name, help, v ? "true" : "false", "BOOL"); }
    void length(const char* name, double& v, const Range& range, const char* help) {
      add(name, with_bounds(help, range, Quantity::length), format_length(v), "LENGTH");
    }
    void angle(const char* name, double& v, const Range& range, const char* help) {
      add(name, with_bounds(help, range, Quantity::angle), format_angle(v), "ANGLE");
    }
    void lengths(const char* name, std::vector<double>& v, const Range& range, const char* help) {
      std::string shown;
      for (const double value : v) shown += (shown.empty() ? "" : ", ") + format_length(value);
      add(name, with_bounds(help, range, Quantity::length), shown, "LENGTHS");
    }
    void position(const char* name, Vec3& v, const Range&, const char* help) {
      add(name, help, fmt::format("{}, {}, {}", format_length(v.x), format_length(v.y), format_length(v.z)), "LENGTHS");
    }
    void texts(const char* name, std::vector<std::string>& v, const char* help) {
      add(name, help, fmt::format("{}", fmt::join(v, ", ")), "TEXTS");
    }
    template <class Enum>
    void choice(const char* name, Enum& v, std::initializer_list<Choice<Enum>> choices, const char* help) {
      std::string names, shown;
      for (const auto& c : choices) {
        names += (names.empty() ? "" : "|") + std::string(c.name);
        if (c.value == v) shown = c.name;
      }
      add(name, help, shown, names);
    }
  };

  struct Setter {
    const Texts& given;

    template <class Value, class Parse>
    void set(const char* name, Value& v, const Parse& parse) {
      const auto found = given.find(name);
      if (found != given.end()) v = read_flag(dashed(name), [&] { return Value(parse(found->second)); });
    }
    template <class Integer>
    void count(const char* name, Integer& v, const Range& range, const char*) {
      set(name, v, [&](const std::string& text) {
        Integer value{};
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        require(error == std::errc() && end == text.data() + text.size(), "expected a whole number, got \"{}\"", text);
        check_range(double(value), range, Quantity::count);
        return value;
      });
    }
    void number(const char* name, double& v, const Range& range, const char*) {
      set(name, v, [&](const std::string& text) {
        double value{};
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        require(error == std::errc() && end == text.data() + text.size(), "expected a number, got \"{}\"", text);
        check_range(value, range, Quantity::number);
        return value;
      });
    }
    void flag(const char* name, bool& v, const char*) {
      set(name, v, [](const std::string& text) {
        require(text == "true" || text == "false", "expected true or false, got \"{}\"", text);
        return text == "true";
      });
    }
    void length(const char* name, double& v, const Range& range, const char*) {
      set(name, v, [&](const std::string& text) { return length_within(text, range); });
    }
    void angle(const char* name, double& v, const Range& range, const char*) {
      set(name, v, [&](const std::string& text) { return angle_within(text, range); });
    }
    void lengths(const char* name, std::vector<double>& v, const Range& range, const char*) {
      set(name, v, [&](const std::string& text) { return lengths_within(text, range); });
    }
    void position(const char* name, Vec3& v, const Range& range_of_z, const char*) {
      set(name, v, [&](const std::string& text) {
        const std::vector<double> lengths = parse_lengths(text);
        require(lengths.size() == 3, "expected three lengths x, y and z, got {}", lengths.size());
        check_range(lengths[2], range_of_z, Quantity::length, " for z");
        return Vec3{lengths[0], lengths[1], lengths[2]};
      });
    }
    void texts(const char* name, std::vector<std::string>& v, const char*) {
      set(name, v, [](const std::string& text) {  // separated by commas
        std::vector<std::string> parts;
        for (size_t at = 0; at <= text.size();) {
          const size_t end = std::min(text.find(',', at), text.size());
          parts.push_back(text.substr(at, end - at));
          at = end + 1;
        }
        return parts;
      });
    }
    template <class Enum>
    void choice(const char* name, Enum& v, std::initializer_list<Choice<Enum>> choices, const char*) {
      set(name, v, [&](const std::string& text) {
        std::vector<std::string> known;
        for (const auto& c : choices) {
          if (text == c.name) return c.value;
          known.push_back(c.name);
        }
        throw Error(unknown_name_message(name, text, known));
      });
    }
  };

  Texts texts_;
};

}  // namespace holotrace
