#pragma once

#include <string>
#include <vector>

namespace holotrace {

/// The folders of files that come with the program, "panels" or "examples": beside the library, of the installation, and of
/// the sources. Those that exist, in the order in which they are searched.
std::vector<std::string> shipped_folders(const std::string& name);

}  // namespace holotrace
