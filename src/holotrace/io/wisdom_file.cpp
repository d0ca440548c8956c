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
  store.open = [path, lock]() -> std::string {
    lock->lock();
    return std::filesystem::exists(path) ? read_text(path) : "";
  };
  store.close = [path, lock](const std::string& wisdom) {
    try {
      write_text(path, wisdom);
    } catch (const Error&) {
      // If the cache cannot be written, the next run plans again; nothing else is lost.
    }
    lock->unlock();
  };
  set_fft_wisdom_store(std::move(store));
}

}  // namespace holotrace
