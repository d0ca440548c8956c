#pragma once

#include "holotrace/data/refractive_index.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// The complex index n + ik of a metal at `key`, where it is there: `{ n = 0.05, k = 3.4 }` at every wavelength, a
/// list `[["450 nm", 0.04, 2.6], …]`, or the name of a table file (load_index_table) beside the scene.
/// @throws Error with file:line:column for values of another kind, n ≤ 0, and a wavelength that comes twice
void read_metal_index(TomlTable& table, const char* key, RefractiveIndex& index);

/// The same of a glass, which has no k: `1.5`, `[["450 nm", 1.526], …]`, or a table file.
void read_glass_index(TomlTable& table, const char* key, RefractiveIndex& index);

/// A table of refractive indices in a text file: a line per wavelength, `450 nm  0.04  2.6`, of the wavelength with
/// its unit, n, and k where it is not 0. Commas are spaces, # begins a comment, and the lines may stand in any order.
/// @throws Error naming file and line for what is none
RefractiveIndex load_index_table(const std::string& path);

}  // namespace holotrace
