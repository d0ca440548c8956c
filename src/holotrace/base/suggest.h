#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace holotrace {

/// The known name nearest to `name` by edit distance, or "" when none is near (half its letters).
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// "unknown KIND "nmae"; did you mean "name"?" or the list of known names when none is near.
std::string unknown_name_message(std::string_view kind, std::string_view name, const std::vector<std::string>& known);

}  // namespace holotrace
