#include "holotrace/io/files/record_names.h"

#include <filesystem>

namespace holotrace {
namespace {

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

}  // namespace holotrace
