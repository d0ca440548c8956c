#pragma once

#include "holotrace/data/scene.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// Reads one table [materials.NAME] of a scene file: a surface of the type that it names, and the keys that all types
/// have (emission, normal map, sides). Colour textures are decoded to linear light; normal maps and
/// metallic-roughness textures are data and are not decoded.
/// @throws Error with file:line:column for unknown types, keys, metals and glasses (naming the nearest), for numbers
///         out of range, and for textures that cannot be read
Material read_material(TomlTable table);

}  // namespace holotrace
