#pragma once

#include <vector>

#include "holotrace/data/image.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// What the tables of a scene that was made in memory hold instead of the names of files. A table names one of them by
/// its index: an image where the name of an image file is expected, and `arrays` in place of `file` in an object of the
/// type mesh or points.
struct SceneArrays {
  std::vector<Mesh> meshes;  ///< their materials are those of their objects
  std::vector<std::vector<ScenePoint>> points;
  std::vector<Image> images;  ///< linear light, or data as they are
};

}  // namespace holotrace
