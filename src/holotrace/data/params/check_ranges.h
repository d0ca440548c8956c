#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/choice.h"
#include "holotrace/data/params/device.h"

namespace holotrace {

/// A visitor of `describe` that checks each value against the range of its parameter.
struct RangeChecker {
  bool may_take_all_devices = false;

  static std::string about(const char* name) { return std::string(" for \"") + name + "\""; }

  template <class Integer>
  void count(const char* name, Integer& value, const Range& range, const char*) {
    check_range(double(value), range, Quantity::count, about(name));
  }
  void number(const char* name, double& value, const Range& range, const char*) {
    check_range(value, range, Quantity::number, about(name));
  }
  void length(const char* name, double& value, const Range& range, const char*) {
    check_range(value, range, Quantity::length, about(name));
  }
  void angle(const char* name, double& value, const Range& range, const char*) {
    check_range(value, range, Quantity::angle, about(name));
  }
  void lengths(const char* name, std::vector<double>& values, const Range& range, const char* help) {
    for (double& value : values) length(name, value, range, help);
  }
  void position(const char* name, Vec3& value, const Range& range_of_z, const char* help) {
    length(name, value.x, range::any, help);
    length(name, value.y, range::any, help);
    check_range(value.z, range_of_z, Quantity::length, " for z of \"" + std::string(name) + "\"");
  }
  void flag(const char*, bool&, const char*) {}
  void texts(const char*, std::vector<std::string>&, const char*) {}
  void device(const char* name, DeviceChoice& value, const char*) {
    if (!may_take_all_devices) require_one_device(value, about(name));
  }
  template <class Enum>
  void choice(const char*, Enum&, std::initializer_list<std::type_identity_t<Choice<Enum>>>, const char*) {}
};

/// Checks each parameter of a stage against the range that its list (`describe`) states. Each verb calls it first.
/// @throws Error, naming the first parameter outside its range
template <class Params>
void check_ranges(Params params) {
  RangeChecker checker{runs_on_all_devices<Params>};
  describe(checker, params);
}

}  // namespace holotrace
