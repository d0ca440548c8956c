#include "holotrace/io/files/outside.h"

#include <algorithm>
#include <filesystem>

#include "holotrace/base/error.h"

namespace holotrace {

void require_inside(const std::string& file, const std::string& holder, Outside outside) {
  namespace fs = std::filesystem;
  if (outside == Outside::allowed) return;
  std::error_code error;
  const fs::path parent = fs::path(holder).parent_path();
  const fs::path folder = fs::canonical(parent.empty() ? fs::path(".") : parent, error);
  const fs::path target = fs::weakly_canonical(file, error);
  const bool is_inside =
      !error && std::mismatch(folder.begin(), folder.end(), target.begin(), target.end()).first == folder.end();
  require(is_inside, "{}: expected files in its own folder, got {}; copy it there, or give --allow-outside", holder,
          file);
}

}  // namespace holotrace
