#include "holotrace/io/files/outside.h"

#include <algorithm>
#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/io/files/text_lines.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

bool is_inside(const fs::path& file, const std::string& holder) {
  std::error_code error;
  const fs::path parent = fs::path(holder).parent_path();
  const fs::path folder = fs::canonical(parent.empty() ? fs::path(".") : parent, error);
  const fs::path target = fs::weakly_canonical(file, error);
  return !error && std::mismatch(folder.begin(), folder.end(), target.begin(), target.end()).first == folder.end();
}

bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
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
  if (named.empty() || fs::is_directory(whole)) return "";
  if (is_there(whole) && (outside == Outside::allowed || is_inside(whole, holder))) return whole.string();
  for (auto first = named.begin(); first != named.end(); ++first) {
    if (*first == "/" || *first == "." || *first == "..") continue;
    fs::path last_parts;
    for (auto part = first; part != named.end(); ++part) last_parts /= *part;
    const fs::path found = below(folder, last_parts);
    if (found.empty() || fs::is_directory(found)) continue;
    if (outside == Outside::allowed || is_inside(found, holder)) return found.string();
  }
  if (!is_there(whole)) return "";
  require_inside(whole.string(), holder, outside);
  return whole.string();
}

}  // namespace holotrace
