#pragma once

#include "holotrace/data/scene.h"

namespace holotrace {

/// A board with 32 lathe-turned pieces of 48 segments, tilted, 0.3 m behind the panel: about 65 000 triangles, lit by
/// two rectangles and a point.
Scene make_board_scene();

/// A Cornell box with two blocks under a rectangle, 1 m wide, open toward the panel at 1.4 m: mostly light from walls.
Scene make_box_scene();

}  // namespace holotrace
