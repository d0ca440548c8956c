#include "holotrace/io/files/output.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/new_file.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

// Files by what is the same for all paths that lead to them: the canonical path, and device and inode if there is a file.
class Files {
 public:
  void add(const std::string& path) {
    paths_.insert(canonical(path));
    if (const auto inode = inode_of(path)) inodes_.insert(*inode);
  }
  bool has(const std::string& path) const {
    const auto inode = inode_of(path);
    return (inode && inodes_.contains(*inode)) || paths_.contains(canonical(path));
  }

 private:
  using Inode = std::pair<dev_t, ino_t>;

  static std::string canonical(const std::string& path) {
    std::error_code error;
    const fs::path found = fs::weakly_canonical(fs::absolute(path, error), error);
    return error ? path : found.string();
  }
  static std::optional<Inode> inode_of(const std::string& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return std::nullopt;
    return Inode{status.st_dev, status.st_ino};
  }

  std::set<std::string> paths_;
  std::set<Inode> inodes_;
};

struct Noted {
  std::mutex mutex;  // textures are read by several threads
  bool is_active = false;
  Files inputs, outputs;
};

Noted& noted() {
  static Noted files;
  return files;
}

[[noreturn]] void fail_both(const std::string& path) {
  fail("expected an output other than the input {}, got the same file; choose another name for the output", path);
}

}  // namespace

CommandFiles::CommandFiles() {
  const std::lock_guard lock(noted().mutex);
  noted().is_active = true;
}

CommandFiles::~CommandFiles() {
  const std::lock_guard lock(noted().mutex);
  noted().is_active = false;
  noted().inputs = noted().outputs = Files();
}

void note_input(const std::string& path) {
  const std::lock_guard lock(noted().mutex);
  if (!noted().is_active) return;
  if (noted().outputs.has(path)) fail_both(path);
  noted().inputs.add(path);
}

void note_output(const std::string& path) {
  const std::lock_guard lock(noted().mutex);
  if (!noted().is_active) return;
  if (noted().inputs.has(path)) fail_both(path);
  require(!noted().outputs.has(path), "expected a file for each output, got {} for two of them; choose another name",
          path);
  noted().outputs.add(path);
}

bool is_input(const std::string& path) {
  const std::lock_guard lock(noted().mutex);
  return noted().inputs.has(path);
}

namespace fs = std::filesystem;

void check_output(const std::string& path, const std::vector<std::string>& extensions) {
  const bool is_known = std::find(extensions.begin(), extensions.end(), extension_of(path)) != extensions.end();
  require(extensions.empty() || is_known, "expected an output file {}, got {}; change its extension",
          fmt::join(extensions, " or "), path);
  require(!is_folder(path), "expected the name of a file to write, got the folder {}; name a file in it", path);
  const fs::path parent = fs::path(path).parent_path();
  const fs::path folder = parent.empty() ? fs::path(".") : parent;
  require(is_folder(folder), "cannot write {}: the folder {} does not exist; create it first", path, folder.string());
  require(access(folder.c_str(), W_OK) == 0, "cannot write {}: the folder {} is not writable; choose another place",
          path, folder.string());
  note_output(path);
  remove_abandoned(folder.string());
}

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  require(!error && is_folder(path), "cannot create the folder {}: {}; choose another place", path,
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
