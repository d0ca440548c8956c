#pragma once

#include "holotrace/data/scene.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// One table [materials.NAME] of a scene file: a surface of the type that it names, and what all types may have
/// (emission, normal map, sides). Textures of colour are decoded to linear light; normal maps and
/// metallic-roughness textures are numbers, taken as they are.
/// @throws Error with file:line:column for unknown types, keys, metals and glasses (naming the nearest), for numbers
///         out of range, and for textures that cannot be read
Material read_material(TomlTable table);

}  // namespace holotrace
