#include "holotrace/data/params/parameter_texts.h"

#include <algorithm>
#include <charconv>

#include "holotrace/base/units.h"
#include "holotrace/data/named_light.h"

namespace holotrace {
namespace {

template <class Number>
Number parse_number(const std::string& text, const char* expected) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  require(error == std::errc() && end == text.data() + text.size(), "expected {}, got \"{}\"", expected, text);
  return number;
}

template <class Integer>
void set_count(const Parameter<Integer>& parameter, const std::string& text) {
  const Integer number = parse_number<Integer>(text, "a whole number");
  check_range(double(number), parameter.range, Quantity::count);
  parameter.value = number;
}

}  // namespace

double value_within(const std::string& text, const Range& range, const std::string& name, Quantity quantity) {
  const double value = quantity == Quantity::wavelength ? parse_wavelength(text, name)
                       : quantity == Quantity::length   ? parse_length(text, name)
                       : quantity == Quantity::angle    ? parse_angle(text)
                       : quantity == Quantity::time     ? parse_time(text)
                                                        : parse_number<double>(text, "a number");
  check_range(value, range, quantity);
  return value;
}

void check_bare_angle(double radians, const std::string& name) {
  const bool is_phase = name.find("phase") != std::string::npos || name.find("delay") != std::string::npos;
  constexpr double turn = 6.2832;  // 2π, rounded up
  require(is_phase || std::abs(radians) <= turn,
          "expected radians for \"{0}\", got {1:g}; write \"{1:g} deg\", or \"{1:g} rad\" if you mean it", name,
          radians);
}

std::vector<double> values_within(const std::string& text, const Range& range, const std::string& name,
                                  Quantity quantity) {
  std::vector<double> values = quantity == Quantity::wavelength ? parse_wavelengths(text, name)
                               : quantity == Quantity::time     ? parse_times(text)
                                                                : parse_lengths(text, name);
  for (const double value : values) check_range(value, range, quantity);
  return values;
}

void set_from_text(const Parameter<int>& parameter, const std::string& text) { set_count(parameter, text); }
void set_from_text(const Parameter<int64_t>& parameter, const std::string& text) { set_count(parameter, text); }

void set_from_text(const Parameter<double>& parameter, const std::string& text) {
  parameter.value = value_within(text, parameter.range, parameter.name, parameter.quantity);
}

void set_from_text(const Parameter<bool>& parameter, const std::string& text) {
  require(text == "true" || text == "false", "expected true or false, got \"{}\"", text);
  parameter.value = text == "true";
}

void set_from_text(const Parameter<std::vector<double>>& parameter, const std::string& text) {
  parameter.value = values_within(text, parameter.range, parameter.name, parameter.quantity);
}

void set_from_text(const Parameter<Vec3>& parameter, const std::string& text) {
  const std::vector<double> lengths = parse_lengths(text, parameter.name);
  require(lengths.size() == 3, "expected three lengths x, y and z, got {}", lengths.size());
  check_range(lengths[2], parameter.range, Quantity::length, " for z");
  parameter.value = {lengths[0], lengths[1], lengths[2]};
}

void set_from_text(const Parameter<std::vector<std::string>>& parameter, const std::string& text) {
  parameter.value.clear();  // separated by commas
  for (size_t at = 0; at <= text.size();) {
    const size_t end = std::min(text.find(',', at), text.size());
    parameter.value.push_back(text.substr(at, end - at));
    at = end + 1;
  }
}

void set_from_text(const Parameter<DeviceChoice>& parameter, const std::string& text) {
  parameter.value = parse_device(text);
}

void set_from_text(const Parameter<std::string>& parameter, const std::string& text) { parameter.value = text; }

}  // namespace holotrace
