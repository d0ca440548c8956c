#include "holotrace/io/wisdom_file.h"

#include <filesystem>
#include <memory>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/io/files/cache_folder.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

std::string read_wisdom(const std::string& path) {
  std::error_code ignored;
  try {
    if (std::filesystem::is_regular_file(path, ignored)) return read_text(path);
  } catch (const Error&) {
    // A cache that cannot be read is as good as none.
  }
  return "";
}

}  // namespace

void keep_fft_wisdom(const std::function<void(const std::string&)>& warn) {
  const std::optional<std::string> folder = writable_cache_folder();
  if (!folder) return;
  const std::string path = *folder + "/fftw_wisdom";
  const auto lock = std::make_shared<LockFile>(path + ".lock");
  const auto kept = std::make_shared<std::string>();
  FftWisdomStore store;
  store.open = [path, lock, kept, warn]() -> std::optional<std::string> {
    if (!lock->lock()) {
      warn(locked_message(path, "FFTW plans are estimated, so transforms may be slower"));
      return std::nullopt;
    }
    *kept = read_wisdom(path);
    return *kept;
  };
  store.close = [path, lock, kept](const std::string& wisdom) {
    try {
      if (wisdom != *kept) write_text(path, wisdom);
    } catch (const Error&) {
      // If the cache cannot be written, the next run plans again; nothing else is lost.
    }
    lock->unlock();
  };
  set_fft_wisdom_store(std::move(store));
}

}  // namespace holotrace
