#include "holotrace/io/files/cache_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace holotrace {
namespace {

namespace fs = std::filesystem;

fs::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return fs::path(cache) / "holotrace";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "holotrace";
  return {};
}

}  // namespace

std::optional<std::string> writable_cache_folder() {
  const fs::path folder = cache_folder();
  if (folder.empty()) return std::nullopt;
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  if (!fs::is_directory(folder, ignored) || access(folder.c_str(), W_OK) != 0) return std::nullopt;
  return folder.string();
}

LockFile::LockFile(const std::string& path) : descriptor_(open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {}

LockFile::~LockFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void LockFile::lock() { flock(descriptor_, LOCK_EX); }
void LockFile::unlock() { flock(descriptor_, LOCK_UN); }

}  // namespace holotrace
