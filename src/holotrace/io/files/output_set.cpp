#include "holotrace/io/files/output_set.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/files/output.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

bool is_recorded(const FileRecord& record, const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(fs::symlink_status(path, error)) &&
         record.contains({path.filename().string(), fs::file_size(path, error)}) && !is_input(path.string());
}

}  // namespace

OutputSet::OutputSet(const std::string& folder) : folder_(folder.empty() ? "." : folder) {
  // Another program may remove the new folder as abandoned before it is locked: then another is made.
  for (int tries = 0; tries < 100; ++tries) {
    staging_ = (fs::path(folder_) / temporary_name("")).string();
    if (mkdir(staging_.c_str(), 0777) != 0) fail_to_write(folder_, std::strerror(errno));
    lock_ = open(staging_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ < 0 && (errno == EMFILE || errno == ENFILE)) fail_to_write(folder_, std::strerror(errno));
    const bool is_taken = lock_ < 0 || (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK);
    if (!is_taken && is_there(staging_)) return;
    if (lock_ >= 0) close(lock_);
  }
  fail_to_write(folder_, "other programs remove what is written");
}

OutputSet::~OutputSet() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  if (lock_ >= 0) close(lock_);
}

std::string OutputSet::path(const std::string& name) const { return (fs::path(staging_) / name).string(); }

FileRecord OutputSet::record() const {
  FileRecord record;
  std::error_code error;
  const fs::directory_iterator entries(staging_, error);
  if (error) fail_to_write(folder_, error.message());
  for (const auto& entry : entries) record.emplace(entry.path().filename().string(), entry.file_size());
  return record;
}

FileRecord OutputSet::record_since(const FileRecord& before) const {
  FileRecord since = record();
  for (const auto& file : before) since.erase(file);
  return since;
}

std::vector<std::string> OutputSet::publish(const FileRecord& earlier, const std::string& main) const {
  std::vector<std::string> notes, names;
  for (const auto& [name, size] : record())
    if (name != main) names.push_back(name);
  names.push_back(main);
  const fs::path folder = folder_ == "." ? fs::path() : fs::path(folder_);
  for (const auto& [name, size] : earlier)
    if (name != main && is_recorded(earlier, folder / name)) {
      std::error_code error;
      fs::remove(folder / name, error);
      if (error) fail_to_write((folder / name).string(), error.message());
    }
  for (const std::string& name : names) {
    const fs::path target = folder / name;
    std::error_code error;
    if (name != main && fs::exists(fs::symlink_status(target, error))) notes.push_back(set_aside(target.string()));
    fs::rename(path(name), target, error);
    if (error) fail_to_write(target.string(), error.message());
  }
  return notes;
}

std::string OutputSet::final_text(const std::string& text) const {
  return replace_all(text, path(""), folder_ == "." ? "" : (fs::path(folder_) / "").string());
}

std::string set_aside(const std::string& path) {
  std::string aside = path + "~";
  std::error_code error;
  for (int n = 2; fs::exists(fs::symlink_status(aside, error)); ++n) aside = fmt::format("{}~{}~", path, n);
  fs::rename(path, aside, error);
  if (error) fail_to_write(path, error.message());
  return fmt::format("{} was not written by an earlier call of this command; it is kept as {}", path, aside);
}

std::vector<std::string> write_together(const std::string& main, const FileRecord& earlier,
                                        const std::function<void(const OutputSet& set)>& write) {
  const fs::path path(main);
  const OutputSet set(path.parent_path().string());
  try {
    write(set);
    return set.publish(earlier, path.filename().string());
  } catch (const Error& error) {
    throw Error(set.final_text(error.what()));
  }
}

nlohmann::ordered_json record_json(const FileRecord& record) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& [name, bytes] : record) json.push_back({{"name", name}, {"bytes", bytes}});
  return json;
}

FileRecord record_from(const nlohmann::json& json) {
  FileRecord record;
  if (!json.is_array()) return record;
  for (const nlohmann::json& file : json) {
    if (!file.is_object() || !file.contains("name") || !file.contains("bytes")) continue;
    if (!file["name"].is_string() || !file["bytes"].is_number_unsigned()) continue;
    const std::string name = file["name"].get<std::string>();
    if (fs::path(name).filename() == name) record.emplace(name, file["bytes"].get<uint64_t>());  // of this folder alone
  }
  return record;
}

FileRecord record_from_text(const std::string& text) {
  return record_from(nlohmann::json::parse(text, nullptr, false));
}

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
  if (!is_file(path)) return {};
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
