#pragma once

#include <string>
#include <string_view>

namespace holotrace {

/// A text from a file, such as the name of a mesh, as it may be shown on a terminal or in a report: valid UTF-8 without
/// control characters, which could move the cursor, change colours or hide what follows. They, the marks that
/// turn the direction of writing, and bytes that are not UTF-8 become "\x1b" or "\u202e". Beyond `most` bytes the text is cut.
std::string printable(std::string_view text, size_t most = 4000);

}  // namespace holotrace
