#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace holotrace {

/// Names and sizes [bytes] of files that were written together. A file of such a name and another size is not the
/// recorded one.
using FileRecord = std::set<std::pair<std::string, uint64_t>>;

/// The files of one command while they are written: in a folder with a temporary name beside their places. A program
/// that is killed leaves that folder, which `remove_abandoned` removes.
class OutputSet {
 public:
  /// @param folder  where the files go; it exists
  explicit OutputSet(const std::string& folder);
  ~OutputSet();  ///< removes the folder and what was not published
  OutputSet(const OutputSet&) = delete;
  OutputSet& operator=(const OutputSet&) = delete;

  /// The path under which a file is written.
  std::string path(const std::string& name) const;

  /// The files written so far, and those that were not yet written when `before` was the record.
  FileRecord record() const;
  FileRecord record_since(const FileRecord& before) const;

  /// A text, such as that of an error, with the paths that the files will have.
  std::string final_text(const std::string& text) const;

  /// Removes the files that `earlier` records, and gives the new files their names, `main` last.
  /// @return  a sentence for each file that was set aside
  std::vector<std::string> publish(const FileRecord& earlier, const std::string& main) const;

 private:
  std::string folder_, staging_;
  int lock_ = -1;
};

/// Writes the files of a command so that they replace those of an earlier call together: all that can fail or takes long
/// is over before the first old file is replaced.
///
/// No file of a user is lost: apart from `main`, a file is only removed or replaced if the earlier call recorded it.
/// Others are set aside: view_2.png becomes view_2.png~.
///
/// @param main     path of the file that was asked for by name; the others go to its folder
/// @param earlier  the record of the earlier call, which its main file holds
/// @param write    writes all files under the paths of the set
/// @return         a sentence for each file that was set aside, for a warning
/// @throws Error   as `write` does, with the paths that the files would have had
std::vector<std::string> write_together(const std::string& main, const FileRecord& earlier,
                                        const std::function<void(const OutputSet& set)>& write);

/// Renames a file that is not ours: view_2.png becomes view_2.png~, or view_2.png~2~, … @return a sentence about it
std::string set_aside(const std::string& path);

/// A record as JSON, [{name, bytes}, …], and back. JSON that is no record gives an empty one.
nlohmann::ordered_json record_json(const FileRecord& record);
FileRecord record_from(const nlohmann::json& json);

/// The same from JSON as text.
FileRecord record_from_text(const std::string& text);

// The record inside a picture has "*" in place of the picture's own stem: its bytes do not depend on the name that it
// gets, and a series that is renamed as a whole keeps its record.

/// A record as the picture at `path` holds it: "view_2.png" of view.png becomes "*_2.png".
FileRecord record_inside(const std::string& path, const FileRecord& record);

/// The inverse.
FileRecord record_outside(const std::string& path, const FileRecord& record);

/// A record as one line of text, for files that can hold a comment: "holotrace_files [{…}]". No end of line.
std::string record_line(const std::string& path, const FileRecord& record);

/// The record in the first such line of the file at `path`, among its first and last 64 KiB; empty if there is none.
FileRecord record_in_text(const std::string& path);

}  // namespace holotrace
