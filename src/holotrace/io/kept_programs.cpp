#include "holotrace/io/kept_programs.h"

#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/fingerprint.h"
#include "holotrace/io/files/cache_folder.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

std::string path_in_cache(const std::string& name) {
  const std::optional<std::string> cache = writable_cache_folder();
  if (!cache) return "";
  const std::string folder = *cache + "/opencl";
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  return failed ? "" : folder + "/" + name;
}

std::string path_of(const std::string& key) {
  Fingerprint fingerprint;
  fingerprint.add_text(key);
  return path_in_cache(fmt::format("{:016x}.bin", fingerprint.value()));
}

// Different keys may have the same fingerprint, so a file begins with its key.
std::string head_of(const std::string& key) { return fmt::format("{}\n{}\n", key.size(), key); }

}  // namespace

std::optional<std::string> load_kept_program(const std::string& key) {
  const std::string path = path_of(key), head = head_of(key);
  if (path.empty() || !std::filesystem::is_regular_file(path)) return std::nullopt;
  try {
    std::string content = read_text(path);
    if (content.size() <= head.size() || !content.starts_with(head)) return std::nullopt;
    return content.substr(head.size());
  } catch (const Error&) {
    return std::nullopt;
  }
}

void keep_program(const std::string& key, const std::string& binary) {
  const std::string path = path_of(key);
  if (path.empty()) return;
  try {
    write_text(path, head_of(key) + binary);
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
