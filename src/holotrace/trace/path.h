#pragma once

#include <cstdint>

#include "holotrace/base/observer.h"
#include "holotrace/base/random.h"
#include "holotrace/trace/accelerator.h"

namespace holotrace {

/// What happened along a number of paths.
struct PathCounts {
  int64_t paths = 0;
  int64_t vertices = 0;     ///< surfaces met, the first hits included
  int64_t rays = 0;         ///< that looked for the nearest surface
  int64_t shadow_rays = 0;  ///< that asked whether a light is seen
  int64_t escaped = 0;      ///< paths that left the scene
  int64_t absorbed = 0;     ///< paths that a surface took: roulette, or a direction into the surface
  int64_t cut = 0;          ///< paths that roulette would have let go on beyond max_depth

  PathCounts& operator+=(const PathCounts& other);

  /// Surfaces met per path: l_avg of Eq. 20.
  double mean_path_length() const { return paths > 0 ? double(vertices) / double(paths) : 0; }
};

/// States the counts as facts "rays", "shadow_rays", "paths", "mean_path_length", "escaped",
/// "absorbed" and "cut", and warns when cut paths cost light.
void report(const PathCounts& counts, int max_depth, const Observer& observer);

/// Radiance that one light path finds leaving a surface point toward where the path came from, in red,
/// green and blue [W/m²/sr]: an unbiased estimate of the rendering equation up to `max_depth` surfaces.
///
///     L = Σₖ βₖ · (emissionₖ + Σ_lights f·cosθ·radiance/pdf · visibility)  (+ β · background where it escapes)
///
/// - Every light is asked at every surface (next-event estimation): the cost grows with their number.
///   Rectangle lights are met in no other way, for paths pass through them; meshes that emit are found
///   by hitting them and not asked, so no light counts twice.
/// - Roulette from the first surface on: with β the throughput and ρ = f·cosθ/pdf the weight of the
///   drawn direction, the path goes on with probability q = max(β·ρ), and β becomes β·ρ/q. The largest
///   component of β is therefore always 1, q is the albedo on grey surfaces, and in a closed grey scene
///   the mean number of surfaces is 1/(1−ρ) (Eq. 20).
/// - Paths that would go on beyond `max_depth` surfaces are cut, which loses their light.
///
/// @param scene      the scene, ready for rays
/// @param first      where the path begins, its normals toward the viewer
/// @param max_depth  most surfaces on the path, `first` included, ≥ 1
/// @param random     the path's own numbers
/// @param counts     what happened is added here
Vec3 path_radiance(const Accelerator& scene, const SurfacePoint& first, int max_depth, CounterRandom& random,
                   PathCounts& counts);

/// The mean of `paths` independent paths from the same point.
Vec3 mean_path_radiance(const Accelerator& scene, const SurfacePoint& first, int paths, int max_depth,
                        CounterRandom& random, PathCounts& counts);

}  // namespace holotrace
