#include "holotrace/io/files/file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/command_files.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/files/text_lines.h"

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

}  // namespace holotrace
