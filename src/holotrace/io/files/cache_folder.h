#pragma once

#include <optional>
#include <string>

namespace holotrace {

/// The program's folder in the user's cache, ($XDG_CACHE_HOME or ~/.cache)/holotrace. It is made if it is missing.
/// Empty if no folder can be written to.
std::optional<std::string> writable_cache_folder();

/// A file whose lock only one program holds at a time; the system releases it if the program dies.
class LockFile {
 public:
  explicit LockFile(const std::string& path);
  ~LockFile();
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;

  void lock();  ///< waits until no other program holds the lock
  void unlock();

 private:
  int descriptor_;
};

}  // namespace holotrace
