#pragma once

#include <string>

namespace holotrace {

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
