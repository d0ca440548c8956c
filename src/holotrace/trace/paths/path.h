#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <optional>
#include <span>

#include "holotrace/base/low_discrepancy.h"
#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/path_expression.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/materials/polarization.h"
#include "holotrace/trace/paths/path_scene.h"

namespace holotrace {

/// Counts of events along a number of paths.
struct PathCounts {
  int64_t paths = 0;
  int64_t vertices = 0;     ///< surfaces met, the first hits included
  int64_t rays = 0;         ///< rays that looked for the nearest surface
  int64_t shadow_rays = 0;  ///< rays that tested whether a light is visible
  int64_t escaped = 0;      ///< paths that left the scene
  int64_t absorbed = 0;     ///< paths that end at a surface: roulette, a direction into it, or max_depth, less `cut`
  int64_t cut = 0;          ///< paths that had to go on after max_depth, in proportion to their light: min(1, max β)
  int64_t left_out = 0;     ///< paths ended because no path group can accept them any more
  int64_t clamped = 0;      ///< paths that brought more radiance than PathParams::clamp

  PathCounts& operator+=(const PathCounts& other);

  /// Surfaces met per path: l_avg of Eq. 20.
  double mean_path_length() const { return paths > 0 ? double(vertices) / double(paths) : 0; }
};

/// Reports the counts as facts "rays", "shadow_rays", "paths", "mean_path_length", "escaped",
/// "absorbed", "cut", "left_out" and "clamped", and warns if cut paths lose light.
void report(const PathCounts& counts, int max_depth, const Observer& observer);

/// Warns if lights that no ray can meet have reflections or refractions that are left out (Caustics).
void warn_of_caustics(const PathScene& scene, const Observer& observer);

/// Start of light paths: a surface that a ray from the panel or a lens has met, possibly by mirrors and glass.
struct PathStart {
  SurfacePoint point;              ///< as shading_point returns it
  Vec3 outgoing;                   ///< unit, from the surface back along the ray
  PathAutomaton::State state = 0;  ///< state after E, and an S for each mirror or glass surface on the way
  int depth = 1;                   ///< surfaces so far, this one included
  double index = 1;                ///< refractive index of the medium before the surface
  Vec3 phase_move{};               ///< from `point` to the place of the surface at which the phase is evaluated [m]
  Aim aim = Aim::exact;            ///< how the ray to the point was chosen
  /// What the detector sees of light that leaves along `outgoing`, if mirrors, glass or filters are on the way; else that of the scene.
  std::optional<StokesRow> seen{};
};

/// Adds the radiance that one light path finds leaving `start.point` along `start.outgoing`, at the lines
/// [W/m²/sr], to sums[i] (PathScene::sums). Without a clamp it is an unbiased estimate of the rendering equation up to
/// `max_depth` surfaces.
///
///     L = Σₖ βₖ·(wₑ·emissionₖ + Σ_ℓ Σ_lights w·f_ℓ·|cosθ|·radiance/pdf · visibility)  + β·w·(light met on the way)
///
/// At each surface k, every light is sampled by one shadow ray (emissive meshes together, and the environment, by one
/// each), and the path continues in one direction drawn from the BSDF. Light that both can find is weighted by the
/// power heuristic, for each lobe ℓ by itself, so that path expressions split it exactly: w = p²/(p² + p′²), p the
/// density of the technique that found it, p′ that of the other (E. Veach, Robust Monte Carlo Methods for Light
/// Transport Simulation, 1997, section 9.2.4). Point, spot and directional lights are only sampled (w = 1). The even
/// background, light at the first hit and light that arrives by a specular branch are only met by the path (w = 1), but for small
/// rectangles behind mirrors and glass (below).
///
/// Thin panes do not hide sampled lights: each transmits 1 − 2R/(1 + R) of their light straight on, and counts as a
/// surface and an S of the path. Points, spots, parallel light and small rectangles also arrive by mirrors and solid glass
/// (caustics.h). Paths meet rectangles that way, too; the same heuristic weights both, with the density with which the path
/// left the surface before the mirrors and glass.
///
/// With PathParams::asks_at_end, lights are sampled only at the surface at which roulette ends the path (the paper's
/// Steps 3 and 4), and their light is divided by the probability of that end. The mean is the same, with fewer shadow
/// rays and more noise. Such surfaces, unless purely specular, end at least a tenth of the paths. At the
/// last surface that max_depth allows, lights are sampled in any case.
///
/// From surface PathParams::roulette_depth on, roulette continues a path with probability min(1, max β), so a surface of
/// weight 1 ends none. The first surfaces end none either: most of the light of a scene is found there, and paths that
/// end early are most of the noise. After the last surface one more ray looks for light beyond surfaces, if there is any.
///
/// Clamp: the light that all path groups together receive from the path, each light counted once, is limited to `clamp`
/// at each line, and the sums shrink in proportion.
///
/// With polarization (PathScene::detector), L is what the detector sees: each contribution is multiplied by the row of its path
/// (polarization.h) for unpolarised sources. Directions and roulette are drawn by the whole light, as without it.
///
/// Where glass bends the lines differently, the path goes on with one of them (Hero): paths take the three in turn, and their
/// mean is that of the lines by themselves.
///
/// Cost: per surface one ray, and one shadow ray for each light that may reach it; where a caustic may lie, 10 to 20 µs more.
///
/// @param numbers  the path's own sequence, started
/// @param sums     PathScene::sums() of them
/// @param counts   events are added here
void add_radiance(const PathScene& scene, const PathStart& start, LowDiscrepancy& numbers, std::span<Vec3> sums,
                  PathCounts& counts);

/// The same for the path that begins at the first surface or particle on a ray of a camera; false, and no light, if there is none.
/// @param beyond  if there is none, set to the weight of light from beyond at the lines (Hit::weight)
bool add_radiance(const PathScene& scene, const Ray& ray, LowDiscrepancy& numbers, std::span<Vec3> sums,
                  PathCounts& counts, Vec3* beyond = nullptr);

/// A ray of a camera, and the number of its path among those of a block of random numbers.
struct NumberedRay {
  Ray ray;
  uint32_t path = 0;  ///< 0 … most_together − 1, another for each ray
};

/// The radiance that add_radiance finds along each of up to most_together rays of different `path`, for all path groups
/// together; much faster than one by one where surfaces are diffuse, and if the rays are near to each other as those of a pixel.
///
/// @param dimension  of the numbers, the first that has not been taken; the numbers are at any path of the block
/// @param lights     as many as rays, overwritten [W/m²/sr]; without a surface the weight of light from beyond
/// @return           bit i is 1 if there is no surface on ray i
/// @throws Error     for more rays, or another number of lights
uint32_t find_radiance(const PathScene& scene, std::span<const NumberedRay> rays, int dimension,
                       LowDiscrepancy& numbers, std::span<Vec3> lights, PathCounts& counts);

/// Adds the light that a ray of weight 1 from a mirror or a glass surface meets before `distance` [m] other than
/// on a surface: rectangles on the way and, for an infinite distance, background and environment. For callers
/// that follow specular branches from the panel themselves; `state` is that of the ray.
void add_light_on_way(const PathScene& scene, const Ray& ray, double distance, PathAutomaton::State state,
                      std::span<Vec3> sums);

/// The mean of `paths` paths from the same start, with numbers keyed by (scene.params.seed, sample). `sums` is
/// overwritten. Without a clamp, asks_at_end or glass that parts the lines, the paths share one shadow ray to each light that always
/// lies in the same direction from the start.
void mean_radiance(const PathScene& scene, const PathStart& start, int paths, uint64_t sample, std::span<Vec3> sums,
                   PathCounts& counts);

/// Complex amplitudes at the three lines.
using Phasors = std::array<std::complex<double>, 3>;

/// Light of lasers that leaves `start.point` along `start.outgoing`, as amplitudes whose squared modulus is radiance
/// and whose phase is 2π/λ times the optical path from the laser to the point, Σ n·d, plus Fresnel's phases. The
/// path starts at a point light, or in the plane through a beam's position. `sums` is overwritten.
///
/// - Light that meets the same surfaces in the same manner, without a random bounce (a laser lights the point directly,
///   or by mirrors and glass), has one phase and adds up to √L·exp(iφ), L its mean.
/// - Light with random bounces is one of `paths` equally bright contributions, √(L/paths)·exp(iφ) each. E|U|² is then
///   the mean radiance, and the sum is speckle, as for laser light off rough surfaces.
/// - Other light has no defined phase: its mean L adds √L with a random phase, drawn from (seed, sample).
///
/// A clamp limits each contribution by itself.
void laser_phasors(const PathScene& scene, const PathStart& start, int paths, uint64_t sample, std::span<Phasors> sums,
                   PathCounts& counts);

/// Whether no component carries light.
inline bool is_black(Vec3 v) { return v.x <= 0 && v.y <= 0 && v.z <= 0; }

/// The power heuristic: the weight of light found with density `own` if another technique has the density `other`.
inline double shared_weight(double own, double other) {
  const double ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

/// The letter of path expressions for a lobe.
inline PathEvent event_of(Lobe lobe) {
  return lobe == Lobe::diffuse ? PathEvent::diffuse : lobe == Lobe::glossy ? PathEvent::glossy : PathEvent::specular;
}

}  // namespace holotrace
