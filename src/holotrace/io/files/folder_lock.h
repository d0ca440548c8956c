#pragma once

#include <string>

namespace holotrace {

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

}  // namespace holotrace
