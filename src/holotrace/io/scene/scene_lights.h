#pragma once

#include "holotrace/data/scene.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// One table [[light]] of a scene file.
/// @throws Error with file:line:column for unknown types and keys (naming the nearest), missing keys, and a direction
///         that points nowhere
Light read_light(TomlTable table);

/// The table [environment] of a scene file: light from all around, of an equirectangular map.
/// @throws Error with file:line:column for a map that is none: not an image, not twice as wide as high, or with
///         light below 0
Environment read_environment(TomlTable table);

}  // namespace holotrace
