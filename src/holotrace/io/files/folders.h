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

/// Keeps a folder for one program while it lives. The system releases it when the program ends, however that ends.
class FolderLock {
 public:
  /// @throws Error if another program keeps the folder
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

/// A folder for temporary files that only this user can read. It is removed with this object.
class TemporaryFolder {
 public:
  /// @param name  begin of the folder's name
  /// @throws Error  if there is no place for temporary files
  explicit TemporaryFolder(const std::string& name);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace holotrace
