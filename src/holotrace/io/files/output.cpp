#include "holotrace/io/files/output.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/io/files/command_files.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/new_file.h"

namespace holotrace {
namespace fs = std::filesystem;

void check_output(const std::string& path, const std::vector<std::string>& extensions) {
  const bool is_known = std::find(extensions.begin(), extensions.end(), extension_of(path)) != extensions.end();
  require(extensions.empty() || is_known, "expected an output file {}, got {}; change its extension",
          fmt::join(extensions, " or "), path);
  std::error_code error;
  require(!fs::is_directory(path, error), "expected the name of a file to write, got the folder {}; name a file in it",
          path);
  const fs::path parent = fs::path(path).parent_path();
  const fs::path folder = parent.empty() ? fs::path(".") : parent;
  require(fs::is_directory(folder, error), "cannot write {}: the folder {} does not exist; create it first", path,
          folder.string());
  require(access(folder.c_str(), W_OK) == 0, "cannot write {}: the folder {} is not writable; choose another place",
          path, folder.string());
  note_output(path);
  remove_abandoned(folder.string());
}

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  require(!error && fs::is_directory(path), "cannot create the folder {}: {}; choose another place", path,
          error ? error.message() : "a file of that name exists");
  require(access(path.c_str(), W_OK) == 0, "cannot write into the folder {}: it is not writable; choose another place",
          path);
  remove_abandoned(path);
}

std::string numbered_path(const std::string& path, size_t i) {
  if (i == 0) return path;
  const fs::path p(path);
  return (p.parent_path() / fmt::format("{}_{}{}", p.stem().string(), i + 1, p.extension().string())).string();
}

std::string path_with_suffix(const std::string& path, const std::string& suffix) {
  const fs::path p(path);
  return (p.parent_path() / (p.stem().string() + suffix + p.extension().string())).string();
}

}  // namespace holotrace
