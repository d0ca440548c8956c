#pragma once

#include <toml++/toml.h>

#include <optional>
#include <vector>

#include "holotrace/data/image.h"
#include "holotrace/data/job.h"
#include "holotrace/data/scene.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

/// What the tables of a scene that was made in memory hold instead of the names of files. A table names one of them by
/// its index: an image where the name of an image file is expected, and `arrays` in place of `file` in an object of the
/// type mesh or points.
struct SceneArrays {
  std::vector<Mesh> meshes;  ///< their materials are those of their objects
  std::vector<std::vector<ScenePoint>> points;
  std::vector<Image> images;  ///< linear light, or data as they are
};

// Scenes and panels of tables that were made in memory, with the keys of their files.

/// The job of tables with the keys of a scene file, except `extends`. Relative paths in them begin at the working
/// directory.
/// @param arrays  what they hold instead of the names of files
/// @param time    as load_job takes it
/// @throws Error starting with the name of the table, as load_job does
Job job_of_tables(const toml::table& tables, const SceneArrays& arrays, Outside outside = Outside::refused,
                  std::optional<double> time = std::nullopt);

/// The panel of a table with the keys of [slm]. @throws Error as job_of_tables does
Slm slm_of_table(const toml::table& table);

}  // namespace holotrace
