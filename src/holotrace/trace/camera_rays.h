#pragma once

#include <span>

#include "holotrace/data/grid.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/shared/ray.h"

// What pictures and focal stacks share: the light that arrives along a ray of a camera.

namespace holotrace {

/// The scene prepared for the paths of a picture.
PathScene make_path_scene(const Scene& scene, const RenderParams& params);

/// Radiance that one light path finds along each of up to most_together rays, in red, green and blue; the sum of all path
/// groups. Rays without a surface find the background, if it is asked for.
/// @param dimension  of the numbers, the first that has not been taken; the numbers are at any path of the block
/// @param lights     as many as rays, overwritten [W/m²/sr]
void radiance_along(const PathScene& scene, std::span<const NumberedRay> rays, bool has_background, int dimension,
                    LowDiscrepancy& numbers, std::span<Vec3> lights, PathCounts& counts);

/// White light that a luminous point sends to a place, if nothing hides it: its radiance times the area of its picture,
/// measured in tangents. With the wave's irradiance E = a²·(d₀/r)² at the place, and θ its angle to the axis,
///
///     L·dA = E/cos⁴θ
///
/// @param place  at z ≥ 0 [m]
double point_light(const ScenePoint& point, Vec3 place, const Grid& panel, double wavelength);

}  // namespace holotrace
