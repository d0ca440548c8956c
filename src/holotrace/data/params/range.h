#pragma once

#include <limits>
#include <numbers>
#include <optional>
#include <string>

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
enum class Quantity { count, number, length, angle };

/// Ranges by name; each is used as an argument in `describe` (parameter.h).
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

}  // namespace holotrace
