#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

namespace holotrace {

/// A file that gets its name only when it is complete. Until then it has a random name in the same folder, with the
/// same extension, and is locked: `remove_abandoned` knows by the lock that its program still runs.
///
/// Every error of writing is kept and reported at the latest by finish(), also those that show only when the file is
/// closed, and those of libraries that do not pass them on.
class NewFile {
 public:
  /// @throws Error  if the folder is missing, the path is a folder or a device, or the file cannot be made
  explicit NewFile(const std::string& path);
  ~NewFile();  ///< removes the file unless it is finished
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// The name until then, for libraries that open files by their names.
  const std::string& temporary() const { return temporary_; }

  /// Writes at the current place. @return whether it could; finish() and check() throw the reason
  bool put(const void* bytes, size_t size);
  bool seek(int64_t place);  ///< [bytes from the beginning]
  int64_t tell() const;

  /// @throws Error  if a write failed, naming the path and the system's reason
  void check() const;

  /// Waits until what is written is on the disk, so that it survives a power cut. @throws Error as check() does
  void sync();

  /// Closes the file and gives it its name; an earlier file of that name is replaced. @throws Error as check() does
  void finish();

 private:
  bool keep_reason(bool holds);

  std::string path_, temporary_;
  std::FILE* stream_ = nullptr;
  int reason_ = 0;  // errno of the first write that failed
  bool is_finished_ = false;
};

/// The beginning of the names of unfinished files and folders: no file of a user has it.
constexpr const char* temporary_prefix = ".holotrace-";

/// A random name for an unfinished file: ".holotrace-", 16 hexadecimal digits, and the extension.
std::string temporary_name(const std::string& extension);

/// Removes the unfinished files and folders in `folder` (temporary_prefix) whose programs have ended. Those of running
/// programs are locked and stay.
void remove_abandoned(const std::string& folder);

/// @throws Error  for a file that cannot be written, with the system's reason for it
[[noreturn]] void fail_to_write(const std::string& path, const std::string& reason);

/// @throws Error  for a file that cannot be opened for reading, with the reason in `errno`
[[noreturn]] void fail_to_read(const std::string& path);

}  // namespace holotrace
