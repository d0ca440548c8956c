#include "holotrace/io/kept_programs.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/fingerprint.h"
#include "holotrace/io/files/cache_folder.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

// Compiled kernels run in this process, so only files that nobody else could have written are taken.
bool is_own(const std::string& path, mode_t kind) {
  struct stat found {};
  return lstat(path.c_str(), &found) == 0 && (found.st_mode & S_IFMT) == kind && found.st_uid == geteuid();
}

std::string path_in_cache(const std::string& name) {
  const std::optional<std::string> cache = writable_cache_folder();
  if (!cache) return "";
  const std::string folder = *cache + "/opencl";
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed || !is_own(folder, S_IFDIR) || chmod(folder.c_str(), S_IRWXU) != 0) return "";
  return folder + "/" + name;
}

std::string path_of(const std::string& key) { return path_in_cache(fmt::format("{:016x}.bin", fingerprint_of(key))); }

// Different keys may have the same fingerprint, so a file begins with its key. Drivers abort on damaged programs, so the
// fingerprint of the program follows.
std::string head_of(const std::string& key, const std::string& binary) {
  return fmt::format("{}\n{}\n{:016x}\n", key.size(), key, fingerprint_of(binary));
}

}  // namespace

std::optional<std::string> load_kept_program(const std::string& key) {
  const std::string path = path_of(key);
  if (path.empty() || !is_own(path, S_IFREG)) return std::nullopt;
  try {
    const std::string content = read_text(path);
    const size_t head = head_of(key, "").size();  // as long as that of any program
    if (content.size() <= head) return std::nullopt;
    std::string binary = content.substr(head);
    if (!content.starts_with(head_of(key, binary))) return std::nullopt;
    return binary;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void keep_program(const std::string& key, const std::string& binary) {
  const std::string path = path_of(key);
  if (path.empty()) return;
  try {
    write_text(path, head_of(key, binary) + binary);
  } catch (const Error&) {
    // It will be compiled again.
  }
}

std::string keep_compiler_log(const std::string& log) {
  const std::string path = path_in_cache("compiler.log");
  if (path.empty()) return "";
  try {
    write_text(path, log);
    return path;
  } catch (const Error&) {
    return "";
  }
}

}  // namespace holotrace
