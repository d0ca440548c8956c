#pragma once

#include "holotrace/data/image.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// The image at `key`, which is there: the file of that name, or an image in memory (SceneArrays).
/// @throws Error with the position of the key, as load_image does
Image read_image(TomlTable& table, const char* key, ImageContent content = ImageContent::colour);

}  // namespace holotrace
