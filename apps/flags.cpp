#include "flags.h"

#include <algorithm>
#include <cmath>

#include "holotrace/data/params/renamed.h"
#include "say.h"

namespace holotrace {
std::string with_bounds(const std::string& help, const Range& range, Quantity quantity) {
  const bool is_plain = range.low == 0 && !range.is_low_open && !std::isfinite(range.high);
  const std::string bounds = bounds_text(range, quantity);
  return is_plain || bounds.empty() ? help : fmt::format("{} ({})", help, bounds);
}

std::string format_lengths(const std::vector<double>& metres) {
  std::string text;
  for (const double value : metres) text += (text.empty() ? "" : ", ") + format_length(value);
  return text;
}

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

void Flags::add_flag(CLI::App& command, const std::string& name, const FlagText& text, const std::string& group,
                     const std::map<std::string, std::string>& from) {
  const std::string other = name == "distances" ? ",--distances" : "";
  const auto keep = [this, name](const std::string& given) { texts_[name] = given; };
  const auto origin = from.find(name);
  const std::string value = origin == from.end() ? text.value : origin->second + ", or " + text.value;
  CLI::Option* option =
      command.add_option_function<std::string>(flag_of(name) + other, keep, text.help + " [" + value + "]");
  option->type_name(text.kind);
  if (!group.empty()) option->group(group);
  if (const char* before = name_before(name)) add_old_name(command, name, before);
}

// The flag with its old name; the help text leaves it out. Its callback is called after that of the new one.
void Flags::add_old_name(CLI::App& command, const std::string& name, const std::string& before) {
  const auto keep = [this, name, before](const std::string& given) {
    if (has(name)) throw CLI::ExcludesError(dashed(before), dashed(name));
    texts_[name] = given;
    say("warning: {}\n", renamed_message(dashed(before), dashed(name)));
  };
  command.add_option_function<std::string>(dashed(before), keep)->group("");
}

}  // namespace holotrace
