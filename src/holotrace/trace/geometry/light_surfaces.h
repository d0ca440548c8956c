#pragma once

#include <vector>

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

/// A sphere around all surfaces.
struct SceneSphere {
  Vec3 centre;
  double radius = 0;  ///< [m]

  /// How far from a surface rays start (Accelerator::clearance).
  double clearance() const { return 2e-6 * radius; }
};

/// @throws Error  if the surfaces have no extent
SceneSphere sphere_around(const Scene& scene);

/// Clearances by which the surface of a light stands before its place when rays look for it, so that a lamp in
/// the plane of a ceiling is met before the ceiling. Where a ray meets it is computed at its place.
inline constexpr double light_lift = 2;

/// The surfaces as rays look for them.
std::vector<Mesh> lifted_light_surfaces(const Scene& scene);

}  // namespace holotrace
