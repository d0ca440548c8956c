#pragma once

#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// A cube of side `size` [m] centred at the origin, its twelve edges as points: `per_edge` on each
/// edge, corners counted once: 12·per_edge − 16 points of amplitude 1.
/// @throws Error unless size > 0 and per_edge ≥ 2.
std::vector<ScenePoint> make_wireframe_cube(double size, int per_edge);

/// A sphere of diameter `size` [m] centred at the origin as circles of points: `meridians` half
/// circles from pole to pole and `parallels` between the poles, `per_circle` points on a full circle.
/// @throws Error unless size > 0, meridians ≥ 1, parallels ≥ 0 and per_circle ≥ 3.
std::vector<ScenePoint> make_wireframe_sphere(double size, int meridians, int parallels, int per_circle);

/// columns × rows points evenly over a rectangle in the xy plane, centred at the origin, the outer
/// ones on its border. With a texture, a point's amplitude is the root of the texture's light there, its
/// channels weighted by `weights` (channel_weights at the hologram's wavelength).
/// @throws Error unless width, height > 0 and columns, rows ≥ 2.
std::vector<ScenePoint> make_point_quad(double width, double height, int columns, int rows,
                                        const Image* texture = nullptr, Vec3 weights = {1, 0, 0});

/// A rectangle in the xy plane, centred at the origin, facing +z: two triangles with texture coordinates.
Mesh make_quad(double width, double height);

/// A box centred at the origin, with flat faces.
Mesh make_box(Vec3 size);

/// A closed sphere of that diameter, centred at the origin, with smooth normals.
Mesh make_sphere(double size, int segments);

/// The surface of revolution of a profile of (radius, height) pairs about the y axis, in `segments`
/// steps. Normals are smooth except where the profile turns by more than 30°.
/// @throws Error unless there are two profile points or more, radii ≥ 0 and segments ≥ 3.
Mesh make_lathe(const std::vector<Vec2>& profile, int segments);

/// The solid of a closed outline in the xy plane, pushed out along z by ±depth/2, front and back
/// triangulated; the outline may turn either way and may be concave.
/// @throws Error unless the outline has three points or more and does not cross itself.
Mesh make_extrusion(const std::vector<Vec2>& outline, double depth);

/// The mesh moved by `frame`; its normals follow.
void transform_mesh(const Frame& frame, Mesh& mesh);

}  // namespace holotrace
