#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/params/parameter.h"

namespace holotrace::test {

/// A value just inside or just outside the range of a parameter, as written in a scene file or in a flag.
struct Try {
  std::string key, text;
  bool has_quotes = false;  ///< whether a scene file needs quotes, for its unit
  bool is_inside = false;
};

/// A visitor of `describe` that lists the values on both sides of each bound. A bound that belongs to the range is
/// itself a value; the one across it is the next whole number, or differs by a billionth of the bound's size (1 m,
/// 1 rad or 1 for a bound of 0). If a range has no bound, -1 and 1 are inside.
struct Bounds {
  std::vector<Try> tries;

  template <class Value>
  void operator()(const Parameter<Value>& p) {
    const bool is_count = std::is_integral_v<Value>;
    const char* unit = is_length(p.quantity) ? " m" : p.quantity == Quantity::angle ? " rad" : "";
    if constexpr (is_number<Value>) add(p.name, p.range, "", unit, is_count ? 1 : 1e-9);
    if constexpr (std::is_same_v<Value, std::vector<double>>) add(p.name, p.range, "1 ", unit, 1e-9);
    if constexpr (std::is_same_v<Value, Vec3>) add(p.name, p.range, "-1 -1 ", unit, 1e-9);
  }

 private:
  void add(const std::string& key, const Range& range, const std::string& before, const std::string& after,
           double step) {
    const auto add_try = [&](double value, bool is_inside) {
      tries.push_back({key, before + fmt::format("{}", value) + after, !after.empty(), is_inside});
    };
    const auto add_bound = [&](double bound, bool is_open, double inward) {
      const double next = step == 1 ? 1 : step * (bound == 0 ? 1 : std::abs(bound));
      add_try(is_open ? bound + inward * next : bound, true);
      add_try(is_open ? bound : bound - inward * next, false);
    };
    if (std::isfinite(range.low)) add_bound(range.low, range.is_low_open, 1);
    if (std::isfinite(range.high)) add_bound(range.high, range.is_high_open, -1);
    if (range.beside) {
      add_try(*range.beside, true);
      for (const double value : {*range.beside - 1, *range.beside + 1}) add_try(value, false);
    }
    if (!std::isfinite(range.low) && !std::isfinite(range.high)) {
      add_try(-1, true);
      add_try(1, true);
    }
  }
};

template <class Params>
std::vector<Try> bounds_of() {
  Bounds bounds;
  Params params;
  describe(bounds, params);
  return bounds.tries;
}

}  // namespace holotrace::test
