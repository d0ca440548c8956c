#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>

#include "holotrace/base/low_discrepancy.h"
#include "holotrace/base/observer.h"
#include "holotrace/trace/path_scene.h"

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

/// Where light paths begin: a surface that a ray from the panel or a lens has met, perhaps by way of mirrors and glass.
struct PathStart {
  SurfacePoint point;              ///< as shading_point returns it
  Vec3 outgoing;                   ///< unit, from the surface back along the ray
  PathAutomaton::State state = 0;  ///< after E and an S for each mirror or glass surface on the way
  int depth = 1;                   ///< surfaces so far, this one included
};

/// Adds the radiance that one light path finds leaving `start.point` along `start.outgoing`, at the lines
/// [W/m²/sr], to sums[i] (PathScene::sums): an unbiased estimate of the rendering equation up to
/// `max_depth` surfaces.
///
///     L = Σₖ βₖ · (emissionₖ + Σ_lights f·cosθ·radiance/pdf · visibility)  (+ β · background where it escapes)
///
/// @param numbers  the path's own, started
/// @param sums     as many as PathScene::sums()
/// @param counts   what happened is added here
void add_radiance(const PathScene& scene, const PathStart& start, LowDiscrepancy& numbers, std::span<Vec3> sums,
                  PathCounts& counts);

/// The mean of `paths` paths from the same start, numbers keyed by (scene.params.seed, sample). `sums` is overwritten.
void mean_radiance(const PathScene& scene, const PathStart& start, int paths, uint64_t sample, std::span<Vec3> sums,
                   PathCounts& counts);

/// Complex amplitudes at the three lines.
using Phasors = std::array<std::complex<double>, 3>;

/// Light of a laser that leaves `start.point` along `start.outgoing`, as amplitudes whose squared modulus is radiance
/// and whose phase is 2π/λ times the optical path from the laser to the point, plus Fresnel's phases. `sums` is
/// overwritten.
///
/// - Ways without a free choice (the laser lights the point directly, through no random bounce) are all alike and add
///   up coherently as they are: √L·exp(iφ), L their mean.
/// - A way with random bounces is one of `paths` equally bright ones: √(L/paths)·exp(iφ) each, so that E|U|² is the
/// mean
///   radiance and the sum is speckle, as laser light off rough surfaces is.
/// - Other light has no phase to follow: it adds with random phases.
void laser_phasors(const PathScene& scene, const PathStart& start, int paths, uint64_t sample, std::span<Phasors> sums,
                   PathCounts& counts);

}  // namespace holotrace
