#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace holotrace {

/// The known name with the smallest edit distance to `name`, or "" where all differ in more than half its letters.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// The message `unknown KIND "nmae"; did you mean "name"?`, or with the list of known names when none is near.
std::string unknown_name_message(std::string_view kind, std::string_view name, const std::vector<std::string>& known);

/// A text from a file, such as the name of a mesh, as it may be shown on a terminal or in a report: valid UTF-8 without
/// control characters, which could move the cursor, change colours or hide what follows. They, the marks that
/// turn the direction of writing, and bytes that are not UTF-8 become "\x1b" or "\u202e". Beyond `most` bytes the text is cut.
std::string printable(std::string_view text, size_t most = 4000);

}  // namespace holotrace
