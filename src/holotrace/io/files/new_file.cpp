#include "holotrace/io/files/new_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

constexpr size_t digits = 16;  // of a random name

void check_destination(const std::string& path) {
  std::error_code ignored;
  require(!path.empty(), "expected a path to write to, got an empty one");
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) fail("expected a file to write at {}, got a folder; add a file name", path);
  if (fs::exists(status) && !fs::is_regular_file(status))
    fail("expected a file to write at {}, got a device or a pipe; choose another name", path);
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty() && !is_folder(folder))
    fail("expected the folder {} to write {} into, but it does not exist; make it first", folder.string(), path);
}

// Locks a whole file for its open description: the system releases it when the program ends, however that ends. It is
// independent of flock, by which HDF5 locks the same file.
bool lock_file(int file) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return fcntl(file, F_OFD_SETLK, &whole) == 0;
}

// A new file of that name, open and locked; -1 with EEXIST if another program has the name or removed the file before
// it was locked, -1 with another errno if none can be made.
int make_locked(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0) return -1;
  // Where the file system has no locks, remove_abandoned cannot lock the file either, and leaves it.
  const bool is_taken = !lock_file(file) && (errno == EAGAIN || errno == EACCES);
  if (!is_taken && access(path.c_str(), F_OK) == 0) return file;
  close(file);
  errno = EEXIST;
  return -1;
}

bool is_temporary_name(const std::string& name) {
  const std::string prefix = temporary_prefix;
  const size_t end = prefix.size() + digits;
  return name.starts_with(prefix) && name.size() >= end &&
         name.find_first_not_of("0123456789abcdef", prefix.size()) >= end && (name.size() == end || name[end] == '.');
}

void remove_if_abandoned(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(path, ignored);
  const bool is_folder = fs::is_directory(status);
  if (!is_folder && !fs::is_regular_file(status)) return;
  const int file = open(path.c_str(), (is_folder ? O_RDONLY | O_DIRECTORY : O_RDWR) | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return;
  if (is_folder ? flock(file, LOCK_EX | LOCK_NB) == 0 : lock_file(file)) fs::remove_all(path, ignored);
  close(file);
}

// What to do about the system's reason not to open a file.
std::string advice_on(const std::string& reason, const char* usual) {
  const bool is_too_many = reason == std::strerror(EMFILE) || reason == std::strerror(ENFILE);
  return is_too_many ? "raise the limit on open files (ulimit -n), or close other programs" : usual;
}

}  // namespace

void fail_to_write(const std::string& path, const std::string& reason) {
  fail("expected to write {}, got \"{}\"; {}", path, reason,
       advice_on(reason, "choose a path in a folder with room where you may write"));
}

void fail_to_read(const std::string& path) {
  const std::string reason = std::strerror(errno);
  fail("expected to read {}, got \"{}\"; {}", path, reason, advice_on(reason, "check its permissions"));
}

std::string temporary_name(const std::string& extension) {
  uint64_t random = 0;
  const bool is_drawn = getentropy(&random, sizeof random) == 0;
  require(is_drawn, "expected random numbers from the system, got \"{}\"", std::strerror(errno));
  return fmt::format("{}{:016x}{}", temporary_prefix, random, extension);
}

void remove_abandoned(const std::string& folder) {
  std::error_code ignored;
  std::vector<fs::path> found;
  for (fs::directory_iterator i(folder.empty() ? "." : folder, ignored), end; i != end; i.increment(ignored))
    if (is_temporary_name(i->path().filename().string())) found.push_back(i->path());
  for (const fs::path& path : found) remove_if_abandoned(path);
}

NewFile::NewFile(const std::string& path) : path_(path) {
  check_destination(path);
  const fs::path p(path);
  int file = -1;
  for (int tries = 0; file < 0; ++tries) {
    temporary_ = (p.parent_path() / temporary_name(p.extension().string())).string();
    file = make_locked(temporary_);
    if (file < 0 && (errno != EEXIST || tries == 100)) fail_to_write(path, std::strerror(errno));
  }
  stream_ = fdopen(file, "w+b");
  if (stream_ == nullptr) {
    const int reason = errno;
    close(file);
    unlink(temporary_.c_str());
    fail_to_write(path, std::strerror(reason));
  }
}

NewFile::~NewFile() {
  if (stream_ != nullptr) std::fclose(stream_);
  if (!is_finished_) unlink(temporary_.c_str());
}

bool NewFile::keep_reason(bool holds) {
  if (!holds && reason_ == 0) reason_ = errno != 0 ? errno : EIO;
  return holds;
}

bool NewFile::put(const void* bytes, size_t size) {
  errno = 0;
  return keep_reason(std::fwrite(bytes, 1, size, stream_) == size);
}

bool NewFile::seek(int64_t place) {
  errno = 0;
  return keep_reason(fseeko(stream_, off_t(place), SEEK_SET) == 0);
}

int64_t NewFile::tell() const { return int64_t(ftello(stream_)); }

void NewFile::check() const {
  if (reason_ != 0) fail_to_write(path_, std::strerror(reason_));
}

void NewFile::sync() {
  errno = 0;
  if (keep_reason(std::fflush(stream_) == 0)) keep_reason(fsync(fileno(stream_)) == 0 || errno == EINVAL);
  check();
}

void NewFile::finish() {
  const int lock = dup(fileno(stream_));  // keeps the lock until the file has its name
  errno = 0;
  keep_reason(std::fclose(std::exchange(stream_, nullptr)) == 0);
  std::error_code error;
  if (reason_ == 0) fs::rename(temporary_, path_, error);
  if (lock >= 0) close(lock);
  check();
  if (error) fail_to_write(path_, error.message());
  is_finished_ = true;
}

}  // namespace holotrace
