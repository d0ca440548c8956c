#include "holotrace/io/files/temporary_folder.h"

#include <cstdlib>
#include <filesystem>

#include "holotrace/base/error.h"

namespace holotrace {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder(const std::string& name)
    : path_((fs::temp_directory_path() / (name + "_XXXXXX")).string()) {
  require(mkdtemp(path_.data()) != nullptr, "expected a folder for temporary files, but {} cannot be written",
          fs::temp_directory_path().string());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace holotrace
