#include "holotrace/io/wisdom_file.h"

#include <filesystem>
#include <memory>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/io/files/cache_folder.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

void keep_fft_wisdom() {
  const std::optional<std::string> folder = writable_cache_folder();
  if (!folder) return;
  const std::string path = *folder + "/fftw_wisdom";
  const auto lock = std::make_shared<LockFile>(path + ".lock");
  FftWisdomStore store;
  const auto kept = std::make_shared<std::string>();
  store.open = [path, lock, kept]() -> std::string {
    lock->lock();
    *kept = std::filesystem::exists(path) ? read_text(path) : "";
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
