#include "holotrace/io/wisdom_file.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/io/file.h"

namespace holotrace {
namespace {

std::filesystem::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return std::filesystem::path(cache) / "holotrace";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".cache" / "holotrace";
  return {};
}

}  // namespace

WisdomFile::WisdomFile() {
  std::error_code ignored;
  const std::filesystem::path folder = cache_folder();
  if (folder.empty()) return;
  std::filesystem::create_directories(folder, ignored);
  if (access(folder.c_str(), W_OK) != 0) return;
  path_ = (folder / "fftw_wisdom").string();
  set_fft_planning(FftPlanning::measure);
  if (!std::filesystem::exists(path_, ignored)) return;
  import_fft_wisdom(read_text(path_));
  loaded_ = export_fft_wisdom();
}

WisdomFile::~WisdomFile() {
  if (path_.empty()) return;
  try {
    const std::string wisdom = export_fft_wisdom();
    if (wisdom != loaded_) write_text(path_, wisdom);
  } catch (const std::exception&) {
    // A cache that cannot be written costs the next run some planning, and nothing else.
  }
}

}  // namespace holotrace
