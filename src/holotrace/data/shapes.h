#pragma once

#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// A cube of side `size` [m] centred at the origin, as points on its twelve edges: `per_edge` points on each
/// edge with its corners; corners occur once: 12·per_edge − 16 points of amplitude 1.
/// @throws Error unless size > 0 and per_edge ≥ 2.
std::vector<ScenePoint> make_wireframe_cube(double size, int per_edge);

/// A sphere of diameter `size` [m] centred at the origin, as circles of points: `meridians` half
/// circles from pole to pole and `parallels` circles between the poles, `per_circle` points on a full circle.
/// @throws Error unless size > 0, meridians ≥ 1, parallels ≥ 0 and per_circle ≥ 3.
std::vector<ScenePoint> make_wireframe_sphere(double size, int meridians, int parallels, int per_circle);

/// columns × rows points spread evenly over a rectangle in the xy plane, centred at the origin, the outer
/// ones on its border. With a texture, a point's amplitude is the root of the texture's light there, with the
/// channels weighted by `weights` (channel_weights at the hologram's wavelength).
/// @throws Error unless width, height > 0 and columns, rows ≥ 2.
std::vector<ScenePoint> make_point_quad(double width, double height, int columns, int rows,
                                        const Image* texture = nullptr, Vec3 weights = {1, 0, 0});

/// A rectangle in the xy plane, centred at the origin, facing +z: two triangles with texture coordinates. Sizes in [m].
Mesh make_quad(double width, double height);

/// A box of `size` [m] centred at the origin, with flat faces.
Mesh make_box(Vec3 size);

/// A closed sphere of diameter `size` [m], centred at the origin, with smooth normals.
Mesh make_sphere(double size, int segments);

/// The surface of revolution of a profile of (radius, height) pairs [m] about the y axis, in `segments`
/// steps. Normals are smooth except where the profile turns by more than 30°; those of points on a circle, the axis and
/// the rim among them, are the circle's.
/// @throws Error unless there are two or more profile points, radii ≥ 0 and segments ≥ 3.
Mesh make_lathe(const std::vector<Vec2>& profile, int segments);

/// The solid of a closed outline [m] in the xy plane, extruded along z by ±depth/2, with triangulated front and
/// back. The outline may be clockwise or counter-clockwise, and may be concave.
/// @throws Error unless the outline has three or more points and does not cross itself.
Mesh make_extrusion(const std::vector<Vec2>& outline, double depth);

/// Volume of the image of a unit cube; below 0 for reflections, which turn triangles inside out.
double determinant(const Frame& frame);

/// A normal of the surface that `frame` maps, unit.
Vec3 transform_normal(const Frame& frame, Vec3 normal);

/// Moves the mesh by `frame`; its normals are transformed, too.
void transform_mesh(const Frame& frame, Mesh& mesh);

/// The light moved by a frame. Scaled by s, points and cones have s² of their intensity, so surfaces that are scaled with them
/// are as bright as before.
Light transform_light(const Frame& frame, Light light);

/// Removes the vertices of no triangle.
void drop_unused_vertices(Mesh& mesh);

/// Half of space: the places p with normal·p ≥ least.
struct HalfSpace {
  Vec3 normal;
  double least = 0;
};

/// The part of a mesh that is in all the half spaces. Triangles at a border are cut; what their vertices have is interpolated.
Mesh clip_mesh(const Mesh& mesh, const std::vector<HalfSpace>& inside);

/// Moves each vertex by a frame of its own, as joints do. @param frames  one per position
void bend_mesh(const std::vector<Frame>& frames, Mesh& mesh);

}  // namespace holotrace
