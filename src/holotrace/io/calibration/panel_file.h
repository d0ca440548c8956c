#pragma once

#include <functional>
#include <string>
#include <vector>

#include "holotrace/data/slm.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// Writes a panel as a panel file (slm_file.h) that does not depend on another: NAME.toml, beside it NAME_phase.csv (its
/// calibration) and NAME_light.exr (its light map). Reading it gives the same panel. A phase map is not written.
/// @param files  record of the files that belong to the panel file, which holds it as a comment; asked for last
/// @throws Error  for an extension other than .toml, and where write_text and save_image throw
void save_panel(const std::string& path, const Slm& slm, const std::function<FileRecord()>& files = {});

/// The files that save_panel writes.
std::vector<std::string> panel_paths(const std::string& path, const Slm& slm);

}  // namespace holotrace
