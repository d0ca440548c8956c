#include "flags.h"

#include <fmt/ranges.h>

#include <cmath>

#include "holotrace/base/suggest.h"
#include "holotrace/data/params/renamed.h"
#include "say.h"

namespace holotrace {
namespace {

// The help text states bounds, except a lower bound of 0 alone, which most parameters have.
std::string with_bounds(const char* help, const Range& range, Quantity quantity) {
  const bool is_plain = range.low == 0 && !range.is_low_open && !std::isfinite(range.high);
  const std::string bounds = bounds_text(range, quantity);
  return is_plain || bounds.empty() ? help : fmt::format("{} ({})", help, bounds);
}

}  // namespace

std::string dashed(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name == "distances" ? "--distance" : "--" + name;
}

void check_flag(const char* flag, double value, const Range& range, Quantity quantity) {
  read_flag(flag, [&] { check_range(value, range, quantity); });
}

double parse_length_flag(const char* flag, const std::string& text, const Range& range) {
  return read_flag(flag, [&] { return length_within(text, range, flag); });
}

std::vector<double> parse_lengths_flag(const char* flag, const std::string& text, const Range& range) {
  return read_flag(flag, [&] { return lengths_within(text, range, flag); });
}

double parse_angle_flag(const char* flag, const std::string& text, const Range& range) {
  return read_flag(flag, [&] { return angle_within(text, range); });
}

double parse_size_flag(const char* flag, const std::string& text) {
  return read_flag(flag, [&] { return parse_size(text); });
}

void Flags::Adder::add(const std::string& name, const std::string& help, const std::string& shown,
                       const std::string& kind) {
  if ((names.count(name) > 0) != is_only) return;
  const std::string other = name == "distances" ? ",--distances" : "";
  const auto keep = [&given = given, name](const std::string& text) { given[name] = text; };
  const auto origin = from.find(name);
  const std::string value = origin == from.end() ? shown : origin->second + ", or " + shown;
  Option* option =
      command.add_option_function(flag_of(name, other_names) + other, keep, help + " [" + value + "]")->type_name(kind);
  if (!group.empty()) option->group(group);
  if (const char* before = name_before(name)) add_old_name(name, before);
}

// The flag with its old name; the help text leaves it out. Its callback is called after that of the new one.
void Flags::Adder::add_old_name(const std::string& name, const std::string& before) {
  const auto keep = [&given = given, name, before](const std::string& text) {
    if (given.count(name)) fail_as_excluded(dashed(before), dashed(name));
    given[name] = text;
    say("warning: {}\n", renamed_message(dashed(before), dashed(name)));
  };
  command.add_option_function(dashed(before), keep)->group("");
}

void Flags::Adder::add_count(const char* name, const std::string& shown, const Range& range, const char* help) {
  add(name, with_bounds(help, range, Quantity::count), shown, "N");
}

void Flags::Adder::add_choice(const char* name, const std::vector<std::string>& names_of_values,
                              const std::string& shown, const char* help) {
  add(name, help, shown, fmt::format("{}", fmt::join(names_of_values, "|")));
}

void Flags::Adder::number(const char* name, double& v, const Range& range, const char* help) {
  add(name, with_bounds(help, range, Quantity::number), fmt::format("{:g}", v), "NUMBER");
}

void Flags::Adder::flag(const char* name, bool& v, const char* help) { add(name, help, v ? "true" : "false", "BOOL"); }

void Flags::Adder::length(const char* name, double& v, const Range& range, const char* help) {
  add(name, with_bounds(help, range, Quantity::length), format_length(v), "LENGTH");
}

void Flags::Adder::angle(const char* name, double& v, const Range& range, const char* help) {
  add(name, with_bounds(help, range, Quantity::angle), format_angle(v), "ANGLE");
}

void Flags::Adder::lengths(const char* name, std::vector<double>& v, const Range& range, const char* help) {
  std::string shown;
  for (const double value : v) shown += (shown.empty() ? "" : ", ") + format_length(value);
  add(name, with_bounds(help, range, Quantity::length), shown, "LENGTHS");
}

void Flags::Adder::position(const char* name, Vec3& v, const Range&, const char* help) {
  add(name, help, fmt::format("{}, {}, {}", format_length(v.x), format_length(v.y), format_length(v.z)), "LENGTHS");
}

void Flags::Adder::texts(const char* name, std::vector<std::string>& v, const char* help) {
  add(name, help, fmt::format("{}", fmt::join(v, ", ")), "TEXTS");
}

void Flags::Adder::device(const char* name, DeviceChoice& v, const char* help) {
  add(name, help, device_text(v), "DEVICE");
}

}  // namespace holotrace
