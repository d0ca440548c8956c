#pragma once

#include <cstddef>
#include <string>

namespace holotrace {

/// Refuses an output path that could not be written, before the work is done.
/// @throws Error  if its folder is missing or not writable, or the path is a folder
void check_output(const std::string& path);

/// Makes a folder and those above it. @throws Error if it cannot, or a file stands there
void make_folder(const std::string& path);

/// The path of the i-th of several outputs: view.png, view_2.png, view_3.png, …
std::string numbered_path(const std::string& path, size_t i);

}  // namespace holotrace
