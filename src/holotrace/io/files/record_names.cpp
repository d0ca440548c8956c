#include "holotrace/io/files/record_names.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace holotrace {
namespace {

const std::string record_mark = "holotrace_files ";

// The record with `to` in place of `from` where a name begins with it.
FileRecord renamed(const FileRecord& record, const std::string& from, const std::string& to) {
  FileRecord result;
  for (const auto& [name, bytes] : record)
    result.emplace(name.starts_with(from) ? to + name.substr(from.size()) : name, bytes);
  return result;
}

std::string stem_of(const std::string& path) { return std::filesystem::path(path).stem().string(); }

}  // namespace

FileRecord record_inside(const std::string& path, const FileRecord& record) {
  return renamed(record, stem_of(path), "*");
}

FileRecord record_outside(const std::string& path, const FileRecord& record) {
  return renamed(record, "*", stem_of(path));
}

std::string record_line(const std::string& path, const FileRecord& record) {
  return record_mark + record_json(record_inside(path, record)).dump(-1, ' ', true);
}

FileRecord record_in_text(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};
  std::ifstream file(path, std::ios::binary);  // an output, so not by read_text, which notes inputs
  constexpr std::streamoff most = 1 << 16;
  file.seekg(0, std::ios::end);
  const std::streamoff size = file.tellg();
  if (!file || size < 0) return {};  // it cannot be read
  for (const std::streamoff begin : {std::streamoff(0), std::max<std::streamoff>(0, size - most)}) {
    std::string text(size_t(std::min(most, size)), ' ');
    file.seekg(begin);
    file.read(text.data(), std::streamsize(text.size()));
    const size_t at = text.find(record_mark);
    if (at == std::string::npos) continue;
    const size_t json = at + record_mark.size(), end = text.find('\n', json);
    return record_outside(path, record_from_text(text.substr(json, end - json)));
  }
  return {};
}

}  // namespace holotrace
