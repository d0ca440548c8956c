#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace holotrace {

/// Parses JSON of limited nesting (nesting.h).
/// @param path  file that the text is from, for messages
/// @throws Error with file and line for broken JSON, for deep nesting and for numbers beyond those of a double
nlohmann::json parse_json(const std::string& text, const std::string& path);

/// JSON that may be half written or not ours: is_discarded() where it is broken or nested too deep.
nlohmann::ordered_json parse_json_if_sound(const std::string& text);

}  // namespace holotrace
