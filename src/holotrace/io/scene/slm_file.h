#pragma once

#include <string>
#include <vector>

#include "holotrace/data/slm.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// The folders that are searched for panels, in this order: $HOLOTRACE_PANELS; holotrace/panels in the user's folder
/// of settings ($XDG_CONFIG_HOME or ~/.config); panels beside the program or the shared library that holds this code, as
/// in the Python package; share/holotrace/panels and holotrace/panels beside the program's own folder; where it was
/// installed; and the source tree that it was built from. Missing folders are left out.
std::vector<std::string> panel_folders();

/// A panel that is known by name: a file NAME.toml in one of those folders.
struct KnownPanel {
  std::string name, file;
  bool is_users = false;  ///< the file is in a folder of the user's
};

/// The panels that slm_preset knows, in alphabetical order. The first of those folders that has a name wins.
std::vector<KnownPanel> known_panels();

/// Their names.
std::vector<std::string> slm_preset_names();

/// Reads a panel by name, from the first folder that has NAME.toml, a file with the keys of a scene's [slm] table. Its
/// effects are included. Those of a panel that comes with the program are typical figures, which are used where they are
/// named (with_effects); those of a panel in a folder of the user's are its own (Slm::own_effects).
/// @throws Error for an unknown name, suggesting the nearest and listing all; with file:line:column for a file
///         that cannot be read
Slm slm_preset(const std::string& name);

/// Reads a table with the keys of [slm] (docs/explanation/slm.md); its keys replace those of a panel, one by one. The
/// effects that it defines, and those of a panel file that it changes, are the panel's own (Slm::own_effects).
/// @param preset  the panel to change, by name or as a file, unless the table names one; "": none
/// @throws Error   with file:line:column for invalid keys and values
Slm read_slm(TomlTable table, const std::string& preset);

/// Reads a calibration of `levels` levels from a CSV file: a line of headings, then one line per level, ascending.
/// Columns: `level` (or `grey`, `gray`); `phase_rad` (or `phase`), `phase_pi` or `phase_deg`; and `amplitude`, 1 where
/// it is left out. Values between the levels of the file are interpolated. Lines that begin with # are comments.
/// @throws Error   with file:line for a table that does not begin at level 0 or does not reach level `levels` − 1, a
///                 phase that falls, an amplitude outside [0, 1], and text that is not a number
std::vector<CalibrationPoint> load_calibration(const std::string& path, int levels);

/// The same for the delays of a crystal [rad], which may rise and fall: columns `level`, and `delay_rad`, `delay_pi` or `delay_deg`.
std::vector<double> load_delays(const std::string& path, int levels);

}  // namespace holotrace
