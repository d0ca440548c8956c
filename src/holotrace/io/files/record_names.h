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

}  // namespace holotrace
