#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace holotrace {

/// The known name with the smallest edit distance to `name`, or "" where all differ in more than half its letters.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// The message `unknown KIND "nmae"; did you mean "name"?`, or with the list of known names when none is near.
std::string unknown_name_message(std::string_view kind, std::string_view name, const std::vector<std::string>& known);

}  // namespace holotrace
