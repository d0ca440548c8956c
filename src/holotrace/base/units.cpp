#include "holotrace/base/units.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

struct Unit {
  std::string_view name;
  double divisor;    // number of these units in one SI unit
  int exponent = 0;  // the unit as a power of ten of the SI unit, where it is one
};

constexpr std::array<Unit, 7> length_units{
    {{"nm", 1e9, -9}, {"um", 1e6, -6}, {"µm", 1e6, -6}, {"μm", 1e6, -6}, {"mm", 1e3, -3}, {"cm", 1e2, -2}, {"m", 1}}};
constexpr std::array<Unit, 6> angle_units{
    {{"deg", 180 / pi}, {"°", 180 / pi}, {"mrad", 1e3}, {"rad", 1}, {"pi", 1 / pi}, {"π", 1 / pi}}};
constexpr std::array<Unit, 1> percent{{{"%", 1e2, -2}}};
constexpr std::array<Unit, 6> time_units{
    {{"s", 1}, {"ms", 1e3, -3}, {"us", 1e6, -6}, {"µs", 1e6, -6}, {"μs", 1e6, -6}, {"min", 1.0 / 60}}};
constexpr std::array<Unit, 9> size_units{{{"B", 1},
                                          {"kB", 1e-3, 3},
                                          {"MB", 1e-6, 6},
                                          {"GB", 1e-9, 9},
                                          {"TB", 1e-12, 12},
                                          {"KiB", 0x1p-10},
                                          {"MiB", 0x1p-20},
                                          {"GiB", 0x1p-30},
                                          {"TiB", 0x1p-40}}};

bool is_space(char c) { return c == ' ' || c == '\t' || c == ',' || c == '\n'; }

void skip_spaces(std::string_view& rest) {
  while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
}

// "nan" and "inf" are numbers, but "nanometers" is a unit.
bool read_number(std::string_view& rest, double& number) {
  std::string_view digits = rest;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (digits.size() > 3 && is_letter(digits[0]) && is_letter(digits[3])) return false;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc()) return false;
  rest = std::string_view(end, size_t(digits.data() + digits.size() - end));
  return true;
}

// The number converted to the SI unit. For a power of ten the exponent is changed in the text, so that the decimal
// number is rounded only once: "532 nm" becomes the double 532e-9.
double in_si(std::string_view digits, double number, const Unit& unit) {
  if (unit.exponent == 0) return number / unit.divisor;
  int exponent = 0;
  const size_t mark = digits.find_first_of("eE");
  if (mark != std::string_view::npos) {
    std::string_view power = digits.substr(mark + 1);
    if (power.starts_with('+')) power.remove_prefix(1);
    std::from_chars(power.data(), power.data() + power.size(), exponent);
  }
  std::string text = fmt::format("{}e{}", digits.substr(0, mark), exponent + unit.exponent);
  double value = 0;
  const auto error = std::from_chars(text.data(), text.data() + text.size(), value).ec;
  return error == std::errc() ? value : number / unit.divisor;
}

bool starts_number(std::string_view rest) {
  double number;
  return read_number(rest, number);
}

// A unit ends at a space, a comma, or the end of the text.
std::string_view read_word(std::string_view& rest) {
  size_t length = 0;
  while (length < rest.size() && !is_space(rest[length])) ++length;
  const auto word = rest.substr(0, length);
  rest.remove_prefix(length);
  return word;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// A comma between two digits may be meant as a decimal point, "632,8 nm", or between two numbers.
void refuse_decimal_comma(std::string_view text) {
  for (size_t i = 1; i + 1 < text.size(); ++i)
    if (text[i] == ',' && is_digit(text[i - 1]) && is_digit(text[i + 1]))
      fail("expected a point in a decimal number, or a space after the comma between two numbers, got \"{}\"", text);
}

template <size_t N>
std::vector<double> parse(std::string_view text, const std::array<Unit, N>& units, const char* kind,
                          const char* example) {
  refuse_decimal_comma(text);
  std::vector<double> values;
  std::vector<std::string_view> digits;
  size_t first_without_unit = 0;
  std::string_view rest = text;
  for (skip_spaces(rest); !rest.empty(); skip_spaces(rest)) {
    double number;
    const std::string_view before = rest.substr(rest.front() == '+');
    if (!read_number(rest, number)) fail("expected {} with its unit, such as \"{}\", got \"{}\"", kind, example, text);
    require(std::isfinite(number), "expected {} that is finite, got \"{}\"", kind, text);
    values.push_back(number);
    digits.push_back(before.substr(0, before.size() - rest.size()));
    skip_spaces(rest);
    if (starts_number(rest)) continue;
    const auto word = read_word(rest);
    if (word.empty()) fail("expected {} with its unit, such as \"{}\", got \"{}\" without a unit", kind, example, text);
    const Unit* unit = nullptr;
    for (const Unit& candidate : units)
      if (candidate.name == word) unit = &candidate;
    if (!unit) {
      std::string known;
      for (const Unit& candidate : units)
        if (candidate.name != "μm" && candidate.name != "μs" && candidate.name != "°" && candidate.name != "π")
          known += (known.empty() ? "" : ", ") + std::string(candidate.name);
      fail("expected {} in one of the units {}, got \"{}\"", kind, known, text);
    }
    for (; first_without_unit < values.size(); ++first_without_unit) {
      double& value = values[first_without_unit];
      value = in_si(digits[first_without_unit], value, *unit);
      require(std::isfinite(value), "expected {} that is finite, got \"{}\"", kind, text);
    }
  }
  if (values.empty()) fail("expected {} with its unit, such as \"{}\", got \"{}\"", kind, example, text);
  return values;
}

double only(const std::vector<double>& values, std::string_view text, const char* kind) {
  require(values.size() == 1, "expected one {}, got {} in \"{}\"", kind, values.size(), text);
  return values.front();
}

std::vector<double> lengths_of(std::string_view text, const char* example) {
  std::vector<double> lengths = parse(text, length_units, "a length", example);
  for (const double metres : lengths)
    require(std::abs(metres) <= most_length, "expected a length of at most {}, got \"{}\"", format_length(most_length),
            text);
  return lengths;
}

}  // namespace

const char* length_example(std::string_view name) {
  const auto has = [&](std::string_view word) { return name.find(word) != std::string_view::npos; };
  if (has("wavelength")) return "532 nm";
  if (has("bandwidth")) return "2 nm";
  if (has("pitch") || has("pixel")) return "8 um";
  if (has("blaze")) return "80 um";
  if (has("pupil") || has("eyebox") || has("radius")) return "3 mm";
  return "300 mm";
}

double parse_length(std::string_view text, std::string_view name) {
  return only(lengths_of(text, length_example(name)), text, "length");
}

double parse_angle(std::string_view text) {
  return only(parse(text, angle_units, "an angle", "15 deg"), text, "angle");
}

double parse_percent(std::string_view text) { return only(parse(text, percent, "a part", "92 %"), text, "part"); }

double parse_time(std::string_view text) { return only(parse_times(text), text, "time"); }

std::vector<double> parse_times(std::string_view text) { return parse(text, time_units, "a time", "0.5 s"); }

std::vector<double> parse_lengths(std::string_view text, std::string_view name) {
  const bool is_place = name.empty() || name == "eye" || name == "position";
  return lengths_of(text, is_place ? "0 0 -300 mm" : length_example(name));
}

double parse_size(std::string_view text) {
  const double bytes = only(parse(text, size_units, "a size", "2 GB"), text, "size");
  require(bytes > 0, "expected a size above 0 B, got \"{}\"", text);
  return bytes;
}

std::string format_percent(double part) {
  return part < 0.0995 ? fmt::format("{:.2g} %", 100 * part) : fmt::format("{:.0f} %", 100 * part);
}

std::string format_length(double metres) {
  const double size = std::abs(metres);
  if (size == 0) return "0 m";
  if (size < 1e-6) return fmt::format("{:.6g} nm", metres * 1e9);
  if (size < 1e-3) return fmt::format("{:.6g} µm", metres * 1e6);
  if (size < 1) return fmt::format("{:.6g} mm", metres * 1e3);
  return fmt::format("{:.6g} m", metres);
}

std::string format_angle(double radians) { return fmt::format("{:.4g}°", radians * 180 / pi); }

std::string format_time(double seconds) {
  const double size = std::abs(seconds);
  if (size == 0 || size >= 1) return fmt::format("{:.6g} s", seconds);
  return size < 1e-3 ? fmt::format("{:.6g} µs", seconds * 1e6) : fmt::format("{:.6g} ms", seconds * 1e3);
}

std::string format_bytes(double bytes) {
  static constexpr std::array<const char*, 5> names{"B", "KiB", "MiB", "GiB", "TiB"};
  size_t i = 0;
  while (bytes >= 1024 && i + 1 < names.size()) {
    bytes /= 1024;
    ++i;
  }
  return fmt::format("{:.{}g} {}", bytes, bytes < 1000 ? 3 : 4, names[i]);
}

}  // namespace holotrace
