#pragma once

#include <string>
#include <vector>

#include "holotrace/data/slm.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// The folders that panels are looked for in, first one first: $HOLOTRACE_PANELS; holotrace/panels in the user's folder
/// of settings ($XDG_CONFIG_HOME or ~/.config); share/holotrace/panels beside the program's own folder and where it was
/// installed; and the source tree it was built from. Those that are not there are left out.
std::vector<std::string> panel_folders();

/// The names that slm_preset knows, in the order of the alphabet: of each file NAME.toml in those folders.
std::vector<std::string> slm_preset_names();

/// A panel by name, from the first folder that has NAME.toml: a file with the keys of a scene's [slm] table. Its own
/// effects are there, to be turned on by name (with_effects).
/// @throws Error for an unknown name, suggesting the nearest and listing those known; with file:line:column for a file
///         that cannot be read
Slm slm_preset(const std::string& name);

/// Reads a table with the keys of [slm] (docs/explanation/slm.md) over a panel, key by key.
/// @param preset  of which the table is a change, where it names none itself; "": a panel of its own
/// @param effects  takes the names of the effects that the table itself says something of
/// @throws Error   with file:line:column
Slm read_slm(TomlTable table, const std::string& preset, std::vector<std::string>& effects);

/// A calibration of `levels` levels from a CSV file: a line of headings, then one line per level, in rising order.
/// Columns: `level` (or `grey`, `gray`); `phase_rad` (or `phase`), `phase_pi` or `phase_deg`; and `amplitude`, 1 where
/// it is left out. Between the levels of the file values are straight. Lines that begin with # are comments.
/// @throws Error   with file:line for a table that does not begin at level 0 or does not reach level `levels` − 1, a
///                 phase that falls, an amplitude beyond [0, 1], and what is no number
std::vector<CalibrationPoint> load_calibration(const std::string& path, int levels);

}  // namespace holotrace
