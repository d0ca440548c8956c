#include "holotrace/io/files/file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "holotrace/base/error.h"
#include "holotrace/io/files/command_files.h"
#include "holotrace/io/files/new_file.h"

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

void check_file_exists(const std::string& path, const char* kind) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) fail("expected {} at {}, got a folder; name a file in it", kind, path);
  if (!fs::exists(path, ignored)) fail("expected {} at {}, but there is no such file; check the path", kind, path);
  note_input(path);
}

std::string read_text(const std::string& path) {
  check_file_exists(path, "a file");
  const File file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) fail("expected to read {}, got \"{}\"; check its permissions", path, std::strerror(errno));
  std::string text;
  std::error_code unknown_size;
  const auto size = fs::file_size(path, unknown_size);
  if (!unknown_size) text.reserve(size);
  char block[1 << 16];
  for (size_t got; (got = std::fread(block, 1, sizeof block, file.get())) > 0;) text.append(block, got);
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

std::string extension_of(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

std::string sidecar_path(const std::string& path) { return path + ".json"; }

std::string old_sidecar_path(const std::string& path) { return fs::path(path).replace_extension(".json").string(); }

}  // namespace holotrace
