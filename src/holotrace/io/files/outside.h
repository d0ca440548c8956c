#pragma once

#include <string>

namespace holotrace {

/// Whether files that a model or field names may lie outside its own folder: a file from elsewhere could otherwise show
/// private files, or read devices.
enum class Outside { refused, allowed };

/// @param file    file that `holder` names
/// @param holder  a model or field
/// @throws Error  if `outside` is refused and the file is not in the folder of `holder` or below it, links followed
void require_inside(const std::string& file, const std::string& holder, Outside outside);

}  // namespace holotrace
