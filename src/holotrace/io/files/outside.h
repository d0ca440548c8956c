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

/// The file that a model or field names, where it lies on this machine: at the place that is named, or, as authors'
/// programs write paths of their own machines ("C:\\Users\\me\\Wood.PNG"), beside `holder` by the last parts of that path,
/// with letters of either case.
/// @param name    as `holder` names it, with "/" or "\\"
/// @return        a file that is there; "" if there is none
/// @throws Error  as require_inside, if the only such file is one outside the folder
std::string find_beside(const std::string& name, const std::string& holder, Outside outside);

}  // namespace holotrace
