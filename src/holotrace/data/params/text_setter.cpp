#include "holotrace/data/params/text_setter.h"

#include "holotrace/base/suggest.h"
#include "holotrace/base/units.h"

namespace holotrace {

double length_within(const std::string& text, const Range& range, const std::string& name) {
  const double metres = parse_length(text, name);
  check_range(metres, range, Quantity::length);
  return metres;
}

std::vector<double> lengths_within(const std::string& text, const Range& range, const std::string& name) {
  std::vector<double> lengths = parse_lengths(text, name);
  for (const double metres : lengths) check_range(metres, range, Quantity::length);
  return lengths;
}

double angle_within(const std::string& text, const Range& range) {
  const double radians = parse_angle(text);
  check_range(radians, range, Quantity::angle);
  return radians;
}

void TextSetter::set(const char* name, const std::function<void(const std::string& text)>& parse) const {
  const auto found = given_.find(name);
  if (found != given_.end()) read_flag(shown_name_(name), [&] { parse(found->second); });
}

void TextSetter::fail_count(const std::string& text) { fail("expected a whole number, got \"{}\"", text); }

size_t TextSetter::chosen(const char* name, const std::string& text, const std::vector<std::string>& known) {
  const auto found = std::find(known.begin(), known.end(), text);
  if (found == known.end()) throw Error(unknown_name_message(name, text, known));
  return size_t(found - known.begin());
}

void TextSetter::number(const char* name, double& v, const Range& range, const char*) {
  set(name, [&](const std::string& text) {
    double value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    require(error == std::errc() && end == text.data() + text.size(), "expected a number, got \"{}\"", text);
    check_range(value, range, Quantity::number);
    v = value;
  });
}

void TextSetter::flag(const char* name, bool& v, const char*) {
  set(name, [&](const std::string& text) {
    require(text == "true" || text == "false", "expected true or false, got \"{}\"", text);
    v = text == "true";
  });
}

void TextSetter::length(const char* name, double& v, const Range& range, const char*) {
  set(name, [&](const std::string& text) { v = length_within(text, range, name); });
}

void TextSetter::angle(const char* name, double& v, const Range& range, const char*) {
  set(name, [&](const std::string& text) { v = angle_within(text, range); });
}

void TextSetter::lengths(const char* name, std::vector<double>& v, const Range& range, const char*) {
  set(name, [&](const std::string& text) { v = lengths_within(text, range, name); });
}

void TextSetter::position(const char* name, Vec3& v, const Range& range_of_z, const char*) {
  set(name, [&](const std::string& text) {
    const std::vector<double> lengths = parse_lengths(text, name);
    require(lengths.size() == 3, "expected three lengths x, y and z, got {}", lengths.size());
    check_range(lengths[2], range_of_z, Quantity::length, " for z");
    v = {lengths[0], lengths[1], lengths[2]};
  });
}

void TextSetter::texts(const char* name, std::vector<std::string>& v, const char*) {
  set(name, [&](const std::string& text) {  // separated by commas
    v.clear();
    for (size_t at = 0; at <= text.size();) {
      const size_t end = std::min(text.find(',', at), text.size());
      v.push_back(text.substr(at, end - at));
      at = end + 1;
    }
  });
}

void TextSetter::device(const char* name, DeviceChoice& v, const char*) {
  set(name, [&](const std::string& text) { v = parse_device(text); });
}

}  // namespace holotrace
