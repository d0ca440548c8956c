#pragma once

#include <optional>
#include <string>

namespace holotrace {

/// The program's folder in the user's cache, ($XDG_CACHE_HOME or ~/.cache)/holotrace. It is made if it is missing.
/// Empty if no folder can be written to.
std::optional<std::string> writable_cache_folder();

/// The sentence for a cache whose lock another program does not give back.
std::string locked_message(const std::string& path, const std::string& consequence);

/// A file whose lock only one program holds at a time; the system releases it if the program dies.
class LockFile {
 public:
  explicit LockFile(const std::string& path);
  ~LockFile();
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;

  /// Waits until no other program holds the lock, for 3 seconds at most: a program that is stopped keeps it for ever.
  /// @return  false if another program still holds it; true also where the file system has no locks
  bool lock();
  void unlock();

 private:
  int descriptor_;
};

}  // namespace holotrace
