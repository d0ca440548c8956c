#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"

// The surfaces of visible rectangle lights, which are seen and block light.

namespace holotrace {

/// The surface of a visible rectangle light: two triangles, counter-clockwise as seen from the emitting side.
struct LightSurface {
  int light = 0;  ///< index into Scene::lights
  Mesh mesh;      ///< without a material
};

/// The light surfaces of a scene, in the order of its lights. Where hits number meshes, they follow Scene::meshes.
std::vector<LightSurface> light_surfaces(const Scene& scene);

/// Whether rays can meet anything: a mesh, the surface of a light or a medium.
bool has_surfaces(const Scene& scene);

/// Where single precision is fine in a scene, and how coarse it is elsewhere. Numbers of 24 bits have a resolution of
/// 6e-8 of their size, so the error of a place grows with its distance from the centre:
///
///     clearance = 2e-6 · distance from the centre
///
/// about ten times the rounding of a ray and a triangle. The centre is near the detail and the panel: the mean of
/// all vertices p, each with the weight 1/|p|³. A lamp or a backdrop far away does not move it; only places near such
/// an object have large errors.
struct ScenePrecision {
  Vec3 centre;
  double unit = 1;    ///< mean distance of the vertices from the centre, with the same weights [m]
  double radius = 0;  ///< radius of the sphere about the centre that contains all surfaces [m]

  /// The clearance of a place [m]; within a thousandth of the unit from the centre, that of this distance.
  double clearance(Vec3 place) const { return clearance_at(length(place - centre)); }

  /// The clearance of a triangle or another surface with these corners [m]: rounding of a corner moves all of it.
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

/// Distance by which the surface of each light of light_surfaces is moved toward rays that look for it [m]: two
/// clearances, its own or those of surfaces that it touches. A lamp in the plane of a ceiling is thus met
/// before the ceiling. The hit itself is computed at the true place.
std::vector<double> light_lifts(const Scene& scene, const ScenePrecision& precision);

/// The same; finds the precision if there is such a light.
std::vector<double> light_lifts(const Scene& scene);

/// The surface of a light moved by its lift, as rays look for it.
Mesh lifted(const LightSurface& surface, double lift);

/// All light surfaces of a scene, moved by their lifts (light_lifts).
std::vector<Mesh> lifted_light_surfaces(const Scene& scene, const std::vector<double>& lifts);

}  // namespace holotrace
