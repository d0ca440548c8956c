#pragma once

#include <string>

#include "holotrace/io/files/output_set.h"

// The record inside a picture has "*" in place of the picture's own stem: its bytes do not depend on the name that it
// gets, and a series that is renamed as a whole keeps its record.

namespace holotrace {

/// A record as the picture at `path` holds it: "view_2.png" of view.png becomes "*_2.png".
FileRecord record_inside(const std::string& path, const FileRecord& record);

/// The inverse.
FileRecord record_outside(const std::string& path, const FileRecord& record);

/// A record as one line of text, for files that can hold a comment: "holotrace_files [{…}]". No end of line.
std::string record_line(const std::string& path, const FileRecord& record);

/// The record in the first such line of the file at `path`, among its first and last 64 KiB; empty if there is none.
FileRecord record_in_text(const std::string& path);

}  // namespace holotrace
