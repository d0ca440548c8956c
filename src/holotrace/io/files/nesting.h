#pragma once

#include <string>
#include <string_view>

// Parsers of JSON and TOML call themselves for each level of nesting, and so do the functions that copy or free what
// they read. A short text of brackets would end the program by a stack overflow. So its depth is limited before.

namespace holotrace {

/// Levels of brackets in a file, and parts of a dotted TOML key: many times those of any real file.
constexpr int most_nesting = 64;

/// @throws Error naming file and line if brackets outside texts are nested deeper than most_nesting
void check_json_nesting(std::string_view text, const std::string& path);

/// The same for TOML: brackets outside texts and comments, and the parts of a dotted key or heading.
void check_toml_nesting(std::string_view text, const std::string& path);

}  // namespace holotrace
