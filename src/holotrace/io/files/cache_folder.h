#pragma once

#include <optional>
#include <string>

namespace holotrace {

/// The user's cache folder of this program, ($XDG_CACHE_HOME or ~/.cache)/holotrace, made if it is missing; nothing
/// where there is none that can be written to.
std::optional<std::string> writable_cache_folder();

/// A file whose lock one program holds at a time; the system lets go of it if the program dies.
class LockFile {
 public:
  explicit LockFile(const std::string& path);
  ~LockFile();
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;

  void lock();
  void unlock();

 private:
  int descriptor_;
};

}  // namespace holotrace
