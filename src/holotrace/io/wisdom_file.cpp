#include "holotrace/io/wisdom_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/io/file.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

fs::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return fs::path(cache) / "holotrace";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "holotrace";
  return {};
}

// A file whose lock one program holds at a time; the system lets go of it if the program dies.
class LockFile {
 public:
  explicit LockFile(const std::string& path) : descriptor_(open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {}
  ~LockFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;

  void lock() { flock(descriptor_, LOCK_EX); }
  void unlock() { flock(descriptor_, LOCK_UN); }

 private:
  int descriptor_;
};

}  // namespace

void keep_fft_wisdom() {
  std::error_code ignored;
  const fs::path folder = cache_folder();
  if (folder.empty()) return;
  fs::create_directories(folder, ignored);
  if (access(folder.c_str(), W_OK) != 0) return;
  const std::string path = (folder / "fftw_wisdom").string();
  const auto lock = std::make_shared<LockFile>(path + ".lock");
  FftWisdomStore store;
  store.open = [path, lock]() -> std::string {
    lock->lock();
    return fs::exists(path) ? read_text(path) : "";
  };
  store.close = [path, lock](const std::string& wisdom) {
    try {
      write_text(path, wisdom);
    } catch (const Error&) {
      // A cache that cannot be written costs the next run some planning, and nothing else.
    }
    lock->unlock();
  };
  set_fft_wisdom_store(std::move(store));
}

}  // namespace holotrace
