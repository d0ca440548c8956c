#include "holotrace/io/files/json_text.h"

#include <algorithm>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/io/files/nesting.h"

namespace holotrace {
namespace {

auto line_of(const std::string& text, size_t at) {
  return 1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(std::min(at, text.size())), '\n');
}

}  // namespace

nlohmann::json parse_json(const std::string& text, const std::string& path) {
  check_json_nesting(text, path);
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    fail("{}:{}: expected valid JSON, but it is truncated or wrong at byte {}; write the file again", path,
         line_of(text, e.byte), e.byte);
  } catch (const nlohmann::json::out_of_range& e) {  // its message ends with the number in quotes
    const std::string_view message = e.what();
    const size_t begin = std::min(message.find('\''), message.size() - 1) + 1;
    const std::string_view number = message.substr(begin, message.find('\'', begin) - begin);
    fail("{}:{}: expected numbers below 1.8e308, got {}; write the file again", path, line_of(text, text.find(number)),
         number.substr(0, 40));
  }
}

nlohmann::ordered_json parse_json_if_sound(const std::string& text) {
  using Json = nlohmann::ordered_json;
  try {
    check_json_nesting(text, "");
  } catch (const Error&) {
    return Json(Json::value_t::discarded);
  }
  return Json::parse(text, nullptr, false);
}

}  // namespace holotrace
