#pragma once

#include <toml++/toml.h>

#include "holotrace/data/job.h"
#include "holotrace/io/files/outside.h"
#include "holotrace/io/scene/scene_arrays.h"

// Scenes and panels of tables that were made in memory, with the keys of their files.

namespace holotrace {

/// The job of tables with the keys of a scene file, except `extends`. Relative paths in them begin at the working
/// directory.
/// @param arrays  what they hold instead of the names of files
/// @throws Error starting with the name of the table, as load_job does
Job job_of_tables(const toml::table& tables, const SceneArrays& arrays, Outside outside = Outside::refused);

/// The panel of a table with the keys of [slm]. @throws Error as job_of_tables does
Slm slm_of_table(const toml::table& table);

}  // namespace holotrace
