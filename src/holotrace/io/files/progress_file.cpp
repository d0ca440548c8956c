#include "holotrace/io/files/progress_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

constexpr const char* ending = ".progress";

// Whether another open description has locked the file: its program runs.
bool is_locked(const fs::path& path) {
  const int file = open(path.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return false;
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  const bool is = fcntl(file, F_OFD_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
  close(file);
  return is;
}

}  // namespace

ProgressFile::ProgressFile(const std::string& folder) {
  try {
    file_ = std::make_unique<NewFile>((fs::path(folder) / (std::string("job") + ending)).string());
  } catch (const Error&) {
    file_.reset();  // the job itself will say what is wrong with its folder
  }
}

void ProgressFile::begin_stage(const std::string& stage) {
  stage_ = stage;
  status_.clear();
  fraction_ = 0;
  history_.clear();
  calls_ = 0;
  step_ = 1;
  write();
}

void ProgressFile::tell(const std::string& status) {
  status_ = status;
  if (calls_++ % step_ != 0) return;
  history_.emplace_back(fraction_, status);
  if (history_.size() < most_entries) return;
  for (size_t i = 0; 2 * i < history_.size(); ++i) history_[i] = history_[2 * i];
  history_.resize((history_.size() + 1) / 2);
  step_ *= 2;
}

void ProgressFile::update(double fraction) {
  fraction_ = std::max(fraction_, std::min(fraction, 1.0));
  if (Clock::now() - written_ > std::chrono::milliseconds(500)) write();
}

void ProgressFile::write() {
  if (!file_) return;
  written_ = Clock::now();
  const nlohmann::ordered_json json{{"stage", stage_},
                                    {"fraction", fraction_},
                                    {"seconds", std::chrono::duration<double>(written_ - start_).count()},
                                    {"status", status_},
                                    {"history", history_}};
  std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  longest_ = std::max(longest_, text.size());
  text.resize(longest_, ' ');  // the file does not become shorter
  file_->put(text.data(), text.size());
  file_->seek(0);  // which also writes what is in the buffer
}

std::optional<std::string> running_progress(const std::string& folder) {
  std::error_code ignored;
  std::optional<fs::path> newest;
  fs::file_time_type time{};
  for (fs::directory_iterator i(folder.empty() ? "." : folder, ignored), end; i != end; i.increment(ignored)) {
    const fs::path& path = i->path();
    if (path.extension() != ending || !path.filename().string().starts_with(temporary_prefix) || !is_locked(path))
      continue;
    const auto written = fs::last_write_time(path, ignored);
    if (newest && written < time) continue;
    newest = path;
    time = written;
  }
  if (!newest) return std::nullopt;
  std::ifstream in(*newest, std::ios::binary);
  std::string text(size_t(1) << 20, '\0');
  in.read(text.data(), std::streamsize(text.size()));
  text.resize(size_t(std::max<std::streamsize>(0, in.gcount())));
  return text;
}

}  // namespace holotrace
