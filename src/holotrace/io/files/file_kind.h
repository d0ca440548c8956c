#pragma once

#include <string>

namespace holotrace {

/// What a file is by its first bytes, and which command takes it, for messages about a file of another kind: "a picture
/// (PNG), which `holotrace encode` and `holotrace compare` take". "another kind of file" if it is unknown.
std::string kind_of_file(const std::string& path);

/// The same; "" if the kind is unknown.
std::string known_kind_of_file(const std::string& path);

/// Whether a file is a text, by its first bytes: without control characters but tabs and ends of lines.
bool is_text_file(const std::string& path);

}  // namespace holotrace
