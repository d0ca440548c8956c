#pragma once

#include <string>
#include <vector>

#include "holotrace/data/scene.h"
#include "holotrace/io/files/ply.h"

namespace holotrace {

/// Surfaces in place of the points of a PLY file without faces, so that they are lit, hide each other and cast shadows as
/// any model does. A point with a normal becomes a disc (a hexagon), one without becomes a small ball (an octahedron with
/// smooth normals); its radius is 0.75 times the median distance to the fourth-nearest point, so that points spread
/// evenly over a surface close it. Gaussian splats (`scale_0`, `rot_0`, `opacity`, …) become ellipsoids of one
/// standard deviation; those of an opacity below 0.3 are left out.
///
/// Above 400 000 points, some are left out evenly, with a warning.
/// @param colours   linear, of the points, or empty
/// @param mesh      receives positions, normals, colours and triangles
/// @throws Error    for splats without a property that they need, or without a visible one
void add_point_solids(const PlyVertices& points, const std::vector<Vec3>& colours, Mesh& mesh,
                      std::vector<std::string>& warnings);

}  // namespace holotrace
