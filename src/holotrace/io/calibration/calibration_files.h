#pragma once

#include <functional>
#include <string>
#include <vector>

#include "holotrace/data/calibration.h"
#include "holotrace/data/image.h"
#include "holotrace/data/slm.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// Writes the patterns of a calibration into a folder, NAME.png with NAME.json each (hologram_file.h), and the plan that
/// lists them, calibration.toml:
///
///     distance = "300 mm"
///     [[pattern]]
///     file = "01_spots.png"
///     kind = "spots"          # or "levels", "focus"
///
/// The folder is made if it is missing. Once all files are written, they replace the patterns of an earlier plan in it.
/// @return        notes about other files of these names, which are set aside (write_together)
/// @throws Error  as save_hologram and write_text do
std::vector<std::string> save_plan(const std::string& folder, const CalibrationPlan& plan);

/// The file that save_plan writes in a folder.
std::string plan_path(const std::string& folder);

/// Reads a plan and its patterns.
/// @throws Error  with file:line:column for a missing or unknown key and for a plan without patterns, and as
///                load_hologram does
CalibrationPlan load_plan(const std::string& path);

/// Reads the photographs of a plan's patterns: from a folder, the file named as the pattern with the extension .png,
/// .tif, .tiff, .jpg, .jpeg or .exr.
/// @throws Error  naming all missing photographs; and as load_image does
std::vector<Image> load_photographs(const std::string& folder, const CalibrationPlan& plan);

/// Writes a panel as a panel file (slm_file.h) that does not depend on another: NAME.toml, beside it NAME_phase.csv (its
/// calibration) and NAME_light.exr (its light map). Reading it gives the same panel. A phase map is not written.
/// @param files  record of the files that belong to the panel file, which holds it as a comment; asked for last
/// @throws Error  for an extension other than .toml, and where write_text and save_image throw
void save_panel(const std::string& path, const Slm& slm, const std::function<FileRecord()>& files = {});

/// The files that save_panel writes.
std::vector<std::string> panel_paths(const std::string& path, const Slm& slm);

}  // namespace holotrace
