#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace holotrace {

/// JSON as a text in which bytes that are not UTF-8, which would end the program, are replaced.
inline std::string text_of(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace holotrace
