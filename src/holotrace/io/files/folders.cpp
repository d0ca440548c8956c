#include "holotrace/io/files/folders.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"

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
  if (!is_folder(folder) || access(folder.c_str(), W_OK) != 0) return std::nullopt;
  return folder.string();
}

std::string locked_message(const std::string& path, const std::string& consequence) {
  return fmt::format(
      "the cache {} has been locked by another program for 3 s and is not used: {}; end that program if it is stopped",
      path, consequence);
}

LockFile::LockFile(const std::string& path)
    : descriptor_(open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0644)) {}

LockFile::~LockFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool LockFile::lock() {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::seconds(3);
  while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) return true;
    if (Clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

void LockFile::unlock() { flock(descriptor_, LOCK_UN); }

FolderLock::FolderLock(const std::string& folder)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  close(descriptor_);
  fail(
      "expected the folder {} for this run alone, but another run writes into it; wait for its end, or choose another "
      "folder",
      folder);
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder(const std::string& name) {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  path_ = (parent / (name + "_XXXXXX")).string();
  require(!error && mkdtemp(path_.data()) != nullptr,
          "expected a folder for temporary files, but {} cannot be written; set TMPDIR to another one",
          error ? "the one that TMPDIR, TMP or TEMP names" : parent.string());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace holotrace
