#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace holotrace {

/// While such an object exists, no file is both read and written by the command that it stands for: the second of
/// note_input and note_output for one file throws. Without one, which is how the library is used, any order is allowed.
class CommandFiles {
 public:
  CommandFiles();
  ~CommandFiles();
  CommandFiles(const CommandFiles&) = delete;
  CommandFiles& operator=(const CommandFiles&) = delete;
};

/// Notes that a file is read. All readers call it, through check_file_exists.
/// @throws Error if it is an output of this command
void note_input(const std::string& path);

/// Notes that a file will be written, before the work is done. check_output calls it.
/// @throws Error if this command has read it, or if it is another output of it, too
void note_output(const std::string& path);

/// Whether this command has read a file.
bool is_input(const std::string& path);

/// Checks that an output path can be written, before the work is done, and notes that the command writes it
/// (note_output). Removes what killed programs left in its folder (remove_abandoned).
/// @param extensions  extensions of the formats that can be written, such as ".npy"; none: any
/// @throws Error  if its folder is missing or not writable, the path is a folder, or its extension is not one of them;
///                     and as note_output does
void check_output(const std::string& path, const std::vector<std::string>& extensions = {});

/// Makes a folder and its parents, and removes what killed programs left in it. @throws Error if it cannot, or if a file has that name
void make_folder(const std::string& path);

/// The path of the i-th of several outputs: view.png, view_2.png, view_3.png, …
std::string numbered_path(const std::string& path, size_t i);

/// The path with a suffix after its name: ("out/view.png", "_left") → "out/view_left.png".
std::string path_with_suffix(const std::string& path, const std::string& suffix);

}  // namespace holotrace
