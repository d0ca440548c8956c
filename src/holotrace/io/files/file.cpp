#include "holotrace/io/files/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

[[noreturn]] void fail_to_write(const std::string& path, const std::string& reason) {
  fail("expected to write {}, got \"{}\"; choose a path in a folder with room where you may write", path, reason);
}

void check_destination(const std::string& path) {
  std::error_code ignored;
  require(!path.empty(), "expected a path to write to, got an empty one");
  if (fs::is_directory(path, ignored)) fail("expected a file to write at {}, got a folder; add a file name", path);
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, ignored))
    fail("expected the folder {} to write {} into, but it does not exist; make it first", folder.string(), path);
}

// ".name.tmp-PID-N.ext": unlike any file a user keeps, with the extension that selects the format.
std::string temporary_name(const fs::path& path) {
  static std::atomic<int> counter{0};
  const std::string name =
      fmt::format(".{}.tmp-{}-{}{}", path.stem().string(), getpid(), counter++, path.extension().string());
  return (path.parent_path() / name).string();
}

std::string replace_all(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace

void check_file_exists(const std::string& path, const char* kind) {
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

std::string read_text(const std::string& path, uint64_t most) {
  check_file_exists(path, "a file");
  // Another file may take the name after this check: without O_NONBLOCK opening a pipe would wait for its writer.
  const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const File file(descriptor < 0 ? nullptr : fdopen(descriptor, "rb"), std::fclose);
  if (!file) fail("expected to read {}, got \"{}\"; check its permissions", path, std::strerror(errno));
  struct stat status {};
  require(fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode), "expected a file at {}, got something else",
          path);
  const auto check_size = [&](uint64_t size) {
    require(size <= most, "{}: expected at most {} of this kind of file, got {} or more; is it another file?", path,
            format_bytes(double(most)), format_bytes(double(size)));
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

void write_bytes(const std::string& path, const void* bytes, size_t size) {
  File file(std::fopen(path.c_str(), "wb"), std::fclose);
  if (!file) fail_to_write(path, std::strerror(errno));
  const bool written = std::fwrite(bytes, 1, size, file.get()) == size && std::fflush(file.get()) == 0;
  const int reason = errno;
  if (std::fclose(file.release()) != 0 || !written) fail_to_write(path, std::strerror(written ? errno : reason));
}

void write_atomically(const std::string& path, const std::function<void(const std::string& temporary)>& write) {
  check_destination(path);
  const std::string temporary = temporary_name(path);
  std::error_code error;
  try {
    write_bytes(temporary, "", 0);  // explains a folder without write permission better than an image library would
    write(temporary);
    fs::rename(temporary, path, error);
    if (error) fail_to_write(path, error.message());
  } catch (const Error& e) {
    fs::remove(temporary, error);
    throw Error(replace_all(e.what(), temporary, path));
  } catch (...) {
    fs::remove(temporary, error);
    throw;
  }
}

void write_text(const std::string& path, const std::string& text) {
  write_atomically(path, [&](const std::string& temporary) { write_bytes(temporary, text.data(), text.size()); });
}

std::string extension_of(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

std::string sidecar_path(const std::string& path) { return fs::path(path).replace_extension(".json").string(); }

}  // namespace holotrace
