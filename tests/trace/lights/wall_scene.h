#pragma once

#include "trace/follow.h"

namespace holotrace {

inline const Ray onto_the_wall{{0, 0, -0.2}, {0, 0, -1}};

/// A diffuse wall of albedo 0.6 at z = −0.3 that faces the panel.
inline Scene wall_scene() {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  return scene;
}

}  // namespace holotrace
