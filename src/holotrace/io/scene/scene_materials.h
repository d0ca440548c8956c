#pragma once

#include <map>
#include <string>

#include "holotrace/data/refractive_index.h"
#include "holotrace/data/scene.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// Reads the complex index n + ik of a metal at `key`, if it is there: `{ n = 0.05, k = 3.4 }` at every wavelength, a
/// list `[["450 nm", 0.04, 2.6], …]`, or the name of a table file (load_index_table) beside the scene.
/// @throws Error with file:line:column for values of another kind, n ≤ 0, and a wavelength that occurs twice
void read_metal_index(TomlTable& table, const char* key, RefractiveIndex& index);

/// Reads the index of a glass in the same way, without k: `1.5`, `[["450 nm", 1.526], …]`, or a table file.
void read_glass_index(TomlTable& table, const char* key, RefractiveIndex& index);

/// Reads a table of refractive indices from a text file with a line per wavelength, `450 nm  0.04  2.6`: wavelength
/// with its unit, n, and k if it is not 0. Commas count as spaces, # begins a comment, lines may be in any order.
/// @throws Error naming file and line for a line that is not of this form
RefractiveIndex load_index_table(const std::string& path);

/// Reads one table [materials.NAME] of a scene file: a surface of the type that it names, and the keys that all types
/// have (emission, normal map, sides). Colour textures are decoded to linear light; normal maps and
/// metallic-roughness textures are data and are not decoded.
/// @throws Error with file:line:column for unknown types, keys, metals and glasses (naming the nearest), for numbers
///         out of range, and for textures that cannot be read
/// @param media  index of each medium that a material may be filled with
Material read_material(TomlTable table, const std::map<std::string, int>& media);

}  // namespace holotrace
