#pragma once

#include <string>

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

}  // namespace holotrace
