#pragma once

#include <string>

namespace holotrace {

/// FFTW's knowledge of fast plans, kept between runs in the user's cache folder
/// ($XDG_CACHE_HOME or ~/.cache)/holotrace. Read on construction, written back on destruction if
/// plans were added. Where the folder cannot be written, plans are estimated, which is slower but the
/// same on every run.
class WisdomFile {
 public:
  WisdomFile();
  ~WisdomFile();
  WisdomFile(const WisdomFile&) = delete;
  WisdomFile& operator=(const WisdomFile&) = delete;

 private:
  std::string path_;  // empty: no cache
  std::string loaded_;
};

}  // namespace holotrace
