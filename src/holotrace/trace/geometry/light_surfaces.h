#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"

// The surfaces of lights that are seen and stand in the way of light: those of visible rectangles.

namespace holotrace {

/// The surface of a visible rectangle light: two triangles, counter-clockwise as seen from the side that shines.
struct LightSurface {
  int light = 0;  ///< index into Scene::lights
  Mesh mesh;      ///< of no material
};

/// Those of a scene, in the order of its lights. Where hits number meshes, they come after Scene::meshes.
std::vector<LightSurface> light_surfaces(const Scene& scene);

/// Whether rays can meet anything: a mesh or the surface of a light.
bool has_surfaces(const Scene& scene);

/// Where single precision is fine in a scene, and how coarse it is elsewhere. Numbers of 24 bits are told apart by
/// 6e-8 of their size, so that the error of a place grows with its distance from the centre:
///
///     clearance = 2e-6 · distance from the centre
///
/// some ten times the rounding of a ray and a triangle. The centre is where the detail is, near the panel: the mean of
/// all vertices p, each with the weight 1/|p|³. A lamp or a backdrop far away does not move it, and its own rounding is
/// its own.
struct ScenePrecision {
  Vec3 centre;
  double unit = 1;    ///< mean distance of the vertices from the centre, with those weights [m]
  double radius = 0;  ///< of the sphere about the centre that holds all surfaces [m]

  /// Of a place [m]; that of a thousandth of the unit from the centre where it is nearer.
  double clearance(Vec3 place) const { return clearance_at(length(place - centre)); }

  /// Of a triangle or of another surface with these corners [m]: rounding of its corners moves all of it.
  template <class Corners>
  double clearance_of(const Corners& corners) const {
    double farthest = 0;
    for (const Vec3& corner : corners) farthest = std::max(farthest, length_squared(corner - centre));
    return clearance_at(std::sqrt(farthest));
  }

 private:
  static double length_squared(Vec3 v) { return dot(v, v); }
  double clearance_at(double distance) const { return 2e-6 * std::max(distance, 1e-3 * unit); }
};

/// @throws Error  if the surfaces have no extent
ScenePrecision precision_of(const Scene& scene);

/// How far the surface of each light of light_surfaces stands before its place when rays look for it [m]: two
/// clearances, its own or those of the surfaces that it touches, so that a lamp in the plane of a ceiling is met
/// before the ceiling. Where a ray meets it is computed at its place.
std::vector<double> light_lifts(const Scene& scene, const ScenePrecision& precision);

/// The surfaces as rays look for them.
std::vector<Mesh> lifted_light_surfaces(const Scene& scene);

}  // namespace holotrace
