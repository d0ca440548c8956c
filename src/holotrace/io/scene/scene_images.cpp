#include "holotrace/io/scene/scene_images.h"

#include <string>

#include "holotrace/io/scene/scene_tables.h"

namespace holotrace {

Image read_image(TomlTable& table, const char* key, ImageContent content) {
  if (const auto index = table.array_index(key)) {
    const auto& images = table.arrays()->images;
    require(*index < images.size(), "{}expected the index of one of {} images for \"{}\", got {}", table.where(key),
            images.size(), key, *index);
    return images[*index];
  }
  std::string name;
  table.text(key, name);
  Image image;
  table.locate(key, [&] { image = load_image(table.beside(key, name), content); });
  return image;
}

}  // namespace holotrace
