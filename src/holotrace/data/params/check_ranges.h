#pragma once

#include <string>
#include <vector>

#include "holotrace/data/params/parameter.h"

namespace holotrace {

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
