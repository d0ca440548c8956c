#include "holotrace/io/files/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "holotrace/base/error.h"
#include "holotrace/io/files/new_file.h"

namespace holotrace {

ByteSource::ByteSource(const std::string& path) : name_(path), file_(nullptr, std::fclose) {
  // Another file may take the name after it was checked: without O_NONBLOCK opening a pipe would wait for its writer.
  const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  file_.reset(descriptor < 0 ? nullptr : fdopen(descriptor, "rb"));
  if (!file_) fail_to_read(path);
  struct stat status {};
  require(fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode), "expected a file at {}, got something else",
          path);
  size_ = uint64_t(status.st_size);
}

ByteSource::ByteSource(const void* bytes, size_t size, std::string name)
    : name_(std::move(name)),
      file_(nullptr, std::fclose),
      memory_(static_cast<const unsigned char*>(bytes)),
      size_(size) {}

size_t ByteSource::read(void* to, size_t size) {
  size = size_t(std::min<uint64_t>(size, size_ - place_));
  if (size == 0) return 0;
  if (memory_)
    std::memcpy(to, memory_ + place_, size);
  else
    size = std::fread(to, 1, size, file_.get());
  place_ += size;
  return size;
}

int ByteSource::next() {
  if (place_ == size_) return -1;
  const int byte = memory_ ? memory_[place_] : getc_unlocked(file_.get());
  if (byte >= 0) ++place_;
  return byte;
}

void ByteSource::seek(uint64_t place) {
  place_ = std::min(place, size_);
  if (file_) fseeko(file_.get(), off_t(place_), SEEK_SET);
}

}  // namespace holotrace
