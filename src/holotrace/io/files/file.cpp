#include "holotrace/io/files/file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/text.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

}  // namespace

std::string replace_all(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

void check_is_file(const std::string& path, const char* kind) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) fail("expected {} at {}, got a folder; name a file in it", kind, path);
  if (!fs::exists(status)) fail("expected {} at {}, but there is no such file; check the path", kind, path);
  if (!fs::is_regular_file(status))
    fail("expected {} at {}, got {}; only files on a disk are read, so save its content to one", kind, path,
         fs::is_fifo(status)     ? "a pipe"
         : fs::is_socket(status) ? "a socket"
                                 : "a device");
}

void check_file_exists(const std::string& path, const char* kind) {
  check_is_file(path, kind);
  require(!is_lfs_pointer(path), "{}: expected {}, got a pointer of Git LFS in its place; fetch it by `git lfs pull`",
          path, kind);
  note_input(path);
}

std::string read_text(const std::string& path, uint64_t most) {
  check_file_exists(path, "a file");
  // Another file may take the name after this check: without O_NONBLOCK opening a pipe would wait for its writer.
  const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const File file(descriptor < 0 ? nullptr : fdopen(descriptor, "rb"), std::fclose);
  if (!file) fail_to_read(path);
  struct stat status {};
  require(fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode), "expected a file at {}, got something else",
          path);
  const auto check_size = [&](uint64_t size) {
    require(size <= most, "{}: expected a file of this kind to have at most {}, got {} or more; is it another file?",
            path, format_bytes(double(most)), format_bytes(double(size)));
  };
  check_size(uint64_t(status.st_size));
  require_memory(double(status.st_size), path);
  std::string text;
  text.reserve(size_t(status.st_size));
  std::vector<char> block(1 << 16);
  for (size_t got; (got = std::fread(block.data(), 1, block.size(), file.get())) > 0;) {
    text.append(block.data(), got);
    check_size(text.size());
  }
  if (std::ferror(file.get())) fail("expected to read {}, got \"{}\"", path, std::strerror(errno));
  return text;
}

void write_atomically(const std::string& path, const std::function<void(const std::string& temporary)>& write) {
  NewFile file(path);
  try {
    write(file.temporary());
  } catch (const Error& e) {
    throw Error(replace_all(e.what(), file.temporary(), path));
  }
  file.finish();
}

void write_text(const std::string& path, const std::string& text) {
  NewFile file(path);
  file.put(text.data(), text.size());
  file.finish();
}

std::string extension_of(const std::string& path) { return lower_case(fs::path(path).extension().string()); }

std::string sidecar_path(const std::string& path) { return path + ".json"; }

std::string old_sidecar_path(const std::string& path) { return fs::path(path).replace_extension(".json").string(); }

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

namespace {

bool is_inside(const fs::path& file, const std::string& holder) {
  std::error_code error;
  const fs::path parent = fs::path(holder).parent_path();
  const fs::path folder = fs::canonical(parent.empty() ? fs::path(".") : parent, error);
  const fs::path target = fs::weakly_canonical(file, error);
  return !error && std::mismatch(folder.begin(), folder.end(), target.begin(), target.end()).first == folder.end();
}

// A file below a folder, by a path with letters of either case; "" if there is none.
fs::path below(const fs::path& folder, const fs::path& parts) {
  fs::path place = folder;
  for (const fs::path& part : parts) {
    if (is_there(place / part)) {
      place /= part;
      continue;
    }
    fs::path found;
    std::error_code error;
    for (fs::directory_iterator entry(place.empty() ? fs::path(".") : place, error), end; !error && entry != end;
         entry.increment(error)) {
      const fs::path name = entry->path().filename();
      if (lower_case(name.string()) == lower_case(part.string()) && (found.empty() || name < found)) found = name;
    }
    if (found.empty()) return {};
    place /= found;
  }
  return place;
}

}  // namespace

void require_inside(const std::string& file, const std::string& holder, Outside outside) {
  require(outside == Outside::allowed || is_inside(file, holder),
          "{}: expected files in its own folder, got {}; copy it there, or give --allow-outside", holder, file);
}

std::string find_beside(const std::string& name, const std::string& holder, Outside outside) {
  const fs::path folder = fs::path(holder).parent_path(), named = replace_all(name, "\\", "/");
  const fs::path whole = folder / named;
  if (named.empty() || is_folder(whole)) return "";
  if (is_there(whole) && (outside == Outside::allowed || is_inside(whole, holder))) return whole.string();
  for (auto first = named.begin(); first != named.end(); ++first) {
    if (*first == "/" || *first == "." || *first == "..") continue;
    fs::path last_parts;
    for (auto part = first; part != named.end(); ++part) last_parts /= *part;
    const fs::path found = below(folder, last_parts);
    if (found.empty() || is_folder(found)) continue;
    if (outside == Outside::allowed || is_inside(found, holder)) return found.string();
  }
  if (!is_there(whole)) return "";
  require_inside(whole.string(), holder, outside);
  return whole.string();
}

}  // namespace holotrace
