#pragma once

#include "holotrace/data/scene.h"

namespace holotrace {

/// A board with 32 lathe-turned pieces of 48 segments, tilted, 0.3 m behind the panel: about 65 000 triangles, lit by
/// two rectangles and a point.
Scene make_board_scene();

/// A Cornell box with two blocks under a rectangle, in 1 m³ behind the plane z = −0.05 m: mostly light from walls.
Scene make_box_scene();

}  // namespace holotrace
