#pragma once

#include <algorithm>
#include <charconv>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/params/choice.h"
#include "holotrace/data/params/device.h"

namespace holotrace {

/// Returns what `read` returns; puts the name of the flag in front of an Error that it throws.
template <class Read>
auto read_flag(const std::string& flag, const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", flag, error.what()));
  }
}

/// A length [m], lengths [m] or an angle [rad] from a text, for the parameter of that name. @throws Error if it is invalid or outside the range
double length_within(const std::string& text, const Range& range, const std::string& name);
std::vector<double> lengths_within(const std::string& text, const Range& range, const std::string& name);
double angle_within(const std::string& text, const Range& range);

/// A visitor of `describe` that sets the fields for which texts are given, such as the values of flags or of a query.
/// @throws Error for a text that is not a valid value, naming the field as `shown_name` does
class TextSetter {
 public:
  using Texts = std::map<std::string, std::string>;  // by field
  using ShownName = std::function<std::string(std::string field)>;
  TextSetter(const Texts& texts, ShownName name) : given_(texts), shown_name_(std::move(name)) {}

  template <class Integer>
  void count(const char* name, Integer& v, const Range& range, const char*) {
    set(name, [&](const std::string& text) {
      Integer value{};
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || end != text.data() + text.size()) fail_count(text);
      check_range(double(value), range, Quantity::count);
      v = value;
    });
  }
  void number(const char* name, double& v, const Range& range, const char*);
  void flag(const char* name, bool& v, const char*);
  void length(const char* name, double& v, const Range& range, const char*);
  void angle(const char* name, double& v, const Range& range, const char*);
  void lengths(const char* name, std::vector<double>& v, const Range& range, const char*);
  void position(const char* name, Vec3& v, const Range& range_of_z, const char*);
  void texts(const char* name, std::vector<std::string>& v, const char*);
  void device(const char* name, DeviceChoice& v, const char*);
  template <class Enum>
  void choice(const char* name, Enum& v, std::initializer_list<Choice<Enum>> choices, const char*) {
    set(name, [&](const std::string& text) {
      std::vector<std::string> known;
      for (const auto& c : choices) known.emplace_back(c.name);
      v = (choices.begin() + chosen(name, text, known))->value;
    });
  }

 private:
  // Calls `parse` with the text of that field, if there is one. Errors name the field.
  void set(const char* name, const std::function<void(const std::string& text)>& parse) const;
  static void fail_count(const std::string& text);
  static size_t chosen(const char* name, const std::string& text, const std::vector<std::string>& known);

  const Texts& given_;
  ShownName shown_name_;
};

}  // namespace holotrace
