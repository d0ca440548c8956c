#include "holotrace/io/field/field_series.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "holotrace/io/field/field_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/files/record_names.h"

namespace holotrace {
namespace fs = std::filesystem;

namespace {

constexpr const char* record_key = "files";

// The sidecar as JSON. It is an output, so read_text, which notes inputs, is not used.
nlohmann::ordered_json sidecar_json(const std::string& path) {
  std::ifstream file(sidecar_path(path), std::ios::binary);
  return nlohmann::ordered_json::parse(file, nullptr, false);
}

FileRecord field_record(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(sidecar_path(path), ignored)) return {};
  const nlohmann::ordered_json json = sidecar_json(path);
  if (!json.is_object() || !json.contains(record_key)) return {};
  return record_outside(path, record_from_text(json[record_key].dump(-1, ' ', true)));
}

std::vector<std::string> files_of(const std::string& path) {
  if (extension_of(path) != ".npy") return {path};
  return {path, sidecar_path(path)};
}

}  // namespace

template <class Real>
std::vector<std::string> save_field_series(const std::string& path,
                                           const std::vector<std::vector<BasicField<Real>>>& stacks) {
  const FileRecord earlier = field_record(path);
  std::vector<std::string> notes;
  FileRecord record;
  for (size_t i = stacks.size(); i-- > 0;) {
    const std::string name = numbered_path(path, i);
    for (const std::string& file : files_of(name)) {
      std::error_code ignored;
      const bool is_there = i > 0 && fs::exists(file, ignored);
      if (is_there && earlier.count({fs::path(file).filename().string(), fs::file_size(file, ignored)}) == 0)
        notes.push_back(set_aside(file));
    }
    save_fields(name, stacks[i]);
    if (i > 0)
      for (const std::string& file : files_of(name))
        record.emplace(fs::path(file).filename().string(), fs::file_size(file));
  }
  if (record.empty()) return notes;
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  if (extension_of(path) == ".npy")
    json = sidecar_json(path);
  else if (fs::exists(sidecar_path(path)) && earlier.empty())
    notes.push_back(set_aside(sidecar_path(path)));
  json[record_key] = record_json(record_inside(path, record));
  write_text(sidecar_path(path), json.dump(2) + "\n");
  return notes;
}

template std::vector<std::string> save_field_series(const std::string&, const std::vector<std::vector<Field>>&);
template std::vector<std::string> save_field_series(const std::string&, const std::vector<std::vector<FieldDouble>>&);

}  // namespace holotrace
