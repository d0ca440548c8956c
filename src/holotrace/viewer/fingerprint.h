#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/choice.h"

namespace holotrace {

/// A visitor of `describe` that writes all values of a stage into one text, exactly: equal texts mean equal parameters.
struct ValueWriter {
  std::string& text;

  template <class Integer>
  void count(const char*, Integer& v, const Range&, const char*) {
    text += fmt::format("{};", v);
  }
  void number(const char*, double& v, const Range&, const char*) { text += fmt::format("{:a};", v); }
  void length(const char*, double& v, const Range&, const char*) { text += fmt::format("{:a};", v); }
  void angle(const char*, double& v, const Range&, const char*) { text += fmt::format("{:a};", v); }
  void lengths(const char*, std::vector<double>& values, const Range&, const char*) {
    for (const double v : values) text += fmt::format("{:a},", v);
    text += ';';
  }
  void position(const char*, Vec3& v, const Range&, const char*) {
    text += fmt::format("{:a},{:a},{:a};", v.x, v.y, v.z);
  }
  void flag(const char*, bool& v, const char*) { text += v ? "1;" : "0;"; }
  void texts(const char*, std::vector<std::string>& values, const char*) {
    for (const std::string& v : values) text += fmt::format("{}:{},", v.size(), v);
    text += ';';
  }
  void device(const char*, DeviceChoice& v, const char*) { text += fmt::format("{}:{};", int(v.kind), v.number); }
  template <class Enum>
  void choice(const char*, Enum& v, std::initializer_list<Choice<Enum>>, const char*) {
    text += fmt::format("{};", int(v));
  }
};

/// All values of a stage's parameters as a text.
template <class Params>
std::string values_text(Params params) {
  std::string text;
  ValueWriter writer{text};
  describe(writer, params);
  return text;
}

}  // namespace holotrace
