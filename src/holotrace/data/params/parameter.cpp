#include "holotrace/data/params/parameter.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

std::string value_text(double value, Quantity quantity) {
  if (is_length(quantity) && std::isfinite(value)) return format_length(value);
  if (is_length(quantity)) return fmt::format("{} m", value);
  if (quantity == Quantity::angle) return fmt::format("{:.6g} deg", value * 180 / pi);
  if (quantity == Quantity::time) return std::isfinite(value) ? format_time(value) : fmt::format("{} s", value);
  if (quantity == Quantity::count) return fmt::format("{:.0f}", value);
  return fmt::format("{}", value);
}

const char* noun(Quantity quantity) {
  switch (quantity) {
    case Quantity::count:
      return "a whole number";
    case Quantity::length:
    case Quantity::wavelength:
      return "a length";
    case Quantity::angle:
      return "an angle";
    case Quantity::time:
      return "a time";
    case Quantity::number:
      break;
  }
  return "a number";
}

// The interval of the range in words, without the value beside it: "above 0 m".
std::string interval_text(const Range& range, Quantity quantity) {
  const std::string low = value_text(range.low, quantity), high = value_text(range.high, quantity);
  const bool has_low = std::isfinite(range.low), has_high = std::isfinite(range.high);
  if (has_low && has_high) {
    if (range.low == range.high) return low;
    if (range.is_low_open)
      return fmt::format("above {}{}{}", low, range.is_high_open ? " and below " : ", up to ", high);
    return fmt::format("{} to {}{}", low, range.is_high_open ? "less than " : "", high);
  }
  if (has_low) return range.is_low_open ? "above " + low : low + " or more";
  if (has_high) return range.is_high_open ? "below " + high : "at most " + high;
  return "";
}

}  // namespace

bool Range::has(double value) const {
  if (!std::isfinite(value)) return false;
  if (beside && value == *beside) return true;
  return (is_low_open ? value > low : value >= low) && (is_high_open ? value < high : value <= high);
}

std::string bounds_text(const Range& range, Quantity quantity) {
  const std::string interval = interval_text(range, quantity);
  return range.beside ? value_text(*range.beside, quantity) + " or " + interval : interval;
}

std::string expected_text(const Range& range, Quantity quantity) {
  const std::string bounds = bounds_text(range, quantity);
  if (bounds.empty()) return std::string(noun(quantity)) + (quantity == Quantity::number ? " that is finite" : "");
  if (range.beside) return bounds;  // such as "0 or 2 to 65536"
  const bool is_span = std::isfinite(range.low) && std::isfinite(range.high) && !range.is_low_open;
  const bool has_preposition = range.is_low_open || bounds.starts_with("below") || bounds.starts_with("at most");
  return fmt::format("{} {}{}", noun(quantity), is_span ? "from " : has_preposition ? "" : "of ", bounds);
}

void check_range(double value, const Range& range, Quantity quantity, const std::string& about) {
  if (!range.has(value))
    fail("expected {}{}, got {}", expected_text(range, quantity), about, value_text(value, quantity));
  const double most = is_length(quantity)            ? most_length
                      : quantity == Quantity::number ? most_number
                                                     : std::numeric_limits<double>::infinity();
  if (std::abs(value) > most)
    fail("expected {} of at most {}{}, got {}", noun(quantity), value_text(most, quantity), about,
         value_text(value, quantity));
}

}  // namespace holotrace
