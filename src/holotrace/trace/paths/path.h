#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>

#include "holotrace/base/low_discrepancy.h"
#include "holotrace/base/observer.h"
#include "holotrace/trace/paths/path_scene.h"

namespace holotrace {

/// What happened along a number of paths.
struct PathCounts {
  int64_t paths = 0;
  int64_t vertices = 0;     ///< surfaces met, the first hits included
  int64_t rays = 0;         ///< that looked for the nearest surface
  int64_t shadow_rays = 0;  ///< that asked whether a light is seen
  int64_t escaped = 0;      ///< paths that left the scene
  int64_t absorbed = 0;     ///< paths that a surface took: roulette, or a direction into the surface
  int64_t cut = 0;          ///< paths that would have met, or could have met, a surface beyond max_depth
  int64_t left_out = 0;     ///< paths ended because no path group can take them any more
  int64_t clamped = 0;      ///< paths that brought more than PathParams::clamp

  PathCounts& operator+=(const PathCounts& other);

  /// Surfaces met per path: l_avg of Eq. 20.
  double mean_path_length() const { return paths > 0 ? double(vertices) / double(paths) : 0; }
};

/// States the counts as facts "rays", "shadow_rays", "paths", "mean_path_length", "escaped",
/// "absorbed", "cut", "left_out" and "clamped", and warns when cut paths cost light.
void report(const PathCounts& counts, int max_depth, const Observer& observer);

/// Where light paths begin: a surface that a ray from the panel or a lens has met, perhaps by way of mirrors and glass.
struct PathStart {
  SurfacePoint point;              ///< as shading_point returns it
  Vec3 outgoing;                   ///< unit, from the surface back along the ray
  PathAutomaton::State state = 0;  ///< after E and an S for each mirror or glass surface on the way
  int depth = 1;                   ///< surfaces so far, this one included
  double index = 1;                ///< of the medium before the surface
  Vec3 phase_move{};               ///< from `point` to the place of the surface whose phase counts [m]
};

/// Adds the radiance that one light path finds leaving `start.point` along `start.outgoing`, at the lines
/// [W/m²/sr], to sums[i] (PathScene::sums): an unbiased estimate of the rendering equation up to
/// `max_depth` surfaces, as long as there is no clamp.
///
///     L = Σₖ βₖ·(wₑ·emissionₖ + Σ_ℓ Σ_lights w·f_ℓ·|cosθ|·radiance/pdf · visibility)  + β·w·(light met on the way)
///
/// At each surface k every light is asked by one shadow ray (emissive meshes together, and the environment, by one
/// each), and the path goes on in one direction that the BSDF draws. Light that both can find is shared by the power
/// heuristic, for each lobe ℓ by itself, so that path expressions split it exactly: w = p²/(p² + p′²), p the density of
/// the way that found it, p′ that of the other one (E. Veach, Robust Monte Carlo Methods for Light Transport
/// Simulation, 1997, section 9.2.4). Point, spot and directional lights are only asked (w = 1); the even background,
/// and all that comes by a specular way or at first hit, is only met (w = 1).
///
/// Thin panes do not hide those lights: each lets 1 − 2R/(1 + R) of their light straight through, and is a surface and
/// an S of the path. Solid glass does hide them.
///
/// With PathParams::asks_at_end the lights are asked by the surface alone that roulette ends the path at (the paper's
/// Steps 3 and 4), and what they bring is divided by the probability of that end: the same mean, with fewer shadow rays
/// and more noise. Such surfaces, unless they only reflect or refract smoothly, end at least a tenth of the paths. The
/// last surface that max_depth leaves is asked in any case.
///
/// Roulette lets a path go on with probability min(1, max β), so a surface of weight 1 takes none. After the last
/// surface one more ray looks for what shines beyond surfaces, if anything does.
///
/// Clamp: what all path groups together take from the path, each light counted once, is held to `clamp` at each line, and
/// the sums shrink in proportion.
///
/// Cost: per surface one ray, and one shadow ray for each light that may reach it.
///
/// @param numbers  the path's own, started
/// @param sums     as many as PathScene::sums()
/// @param counts   what happened is added here
void add_radiance(const PathScene& scene, const PathStart& start, LowDiscrepancy& numbers, std::span<Vec3> sums,
                  PathCounts& counts);

/// Adds the light that a ray of radiance weight 1 from a mirror or a glass surface meets before `distance` [m] and
/// not on a surface: rectangles on the way, and for an infinite distance background and environment. For those
/// who follow specular ways from the panel themselves; `state` is that of the ray.
void add_light_on_way(const PathScene& scene, const Ray& ray, double distance, PathAutomaton::State state,
                      std::span<Vec3> sums);

/// The mean of `paths` paths from the same start, numbers keyed by (scene.params.seed, sample). `sums` is overwritten.
void mean_radiance(const PathScene& scene, const PathStart& start, int paths, uint64_t sample, std::span<Vec3> sums,
                   PathCounts& counts);

/// Complex amplitudes at the three lines.
using Phasors = std::array<std::complex<double>, 3>;

/// Light of lasers that leaves `start.point` along `start.outgoing`, as amplitudes whose squared modulus is radiance
/// and whose phase is 2π/λ times the optical path from the laser to the point, Σ n·d, plus Fresnel's phases. The
/// path starts at a point light, or in the plane through a beam's position. `sums` is overwritten.
///
/// - Ways without a random bounce (a laser lights the point directly, or by way of mirrors and glass from it on) that
///   meet the same surfaces in the same manner are all alike: they add up as √L·exp(iφ), L their mean.
/// - A way with random bounces is one of `paths` equally bright ones: √(L/paths)·exp(iφ) each, so that E|U|² is the
///   mean radiance and the sum is speckle, as laser light off rough surfaces is.
/// - Other light has no phase to follow: its mean L adds √L with a random phase, drawn from (seed, sample).
///
/// A clamp holds what each way brings by itself.
void laser_phasors(const PathScene& scene, const PathStart& start, int paths, uint64_t sample, std::span<Phasors> sums,
                   PathCounts& counts);

}  // namespace holotrace
