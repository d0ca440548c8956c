#pragma once

#include <toml++/toml.h>

#include <string>

namespace holotrace {

/// Parses a TOML file of at most most_text bytes (io/files/file.h) and of limited nesting (io/files/nesting.h).
/// @param kind  what was expected at the path, for messages ("a scene file")
/// @throws Error with file:line:column for invalid TOML, and as read_text does
toml::table parse_toml(const std::string& path, const char* kind);

}  // namespace holotrace
