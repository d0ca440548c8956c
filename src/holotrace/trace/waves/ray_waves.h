#pragma once

#include <optional>
#include <vector>

#include "holotrace/data/astigmatic_wave.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/specular.h"
#include "holotrace/trace/waves/source_phase.h"

// What a ray from the panel finds: the waves that reach the panel along it, with their light and phase. The
// strategies (trace.h, gather.h) use them in different ways.

namespace holotrace {

/// Light that leaves a surface, for each sum (PathScene::sums), before any change by mirrors and glass.
struct LeafLight {
  std::vector<Vec3> radiance;    ///< at the lines [W/m²/sr]
  std::vector<Phasors> phasors;  ///< for a laser, instead of radiance: amplitudes whose squared modulus is radiance
};

/// A wave that reaches the panel along a ray.
struct RayWave {
  SpecularLeaf leaf;
  Vec3 origin;                               ///< apparent origin, by the mean of its curvatures [m]
  std::optional<AstigmaticWave> astigmatic;  ///< if its source is to have focal lines
  uint64_t key = 0;                          ///< key of its random phase, or Sources::no_phase_key
  WaveCell cell;                             ///< cell of equal phase that it belongs to
  LeafLight light;
  bool is_diffuse = false;  ///< whether its surface is diffuse only, so that it looks the same from everywhere
};

/// The waves that a ray finds: one from its first hit, or, if phases follow mirrors (follows_mirrors), one from
/// each leaf of the tree that begins there (specular.h). A ray that meets nothing finds none, or that of the background
/// (PathParams::shows_background), which comes from the distance background_distance.
///
/// With the strategy gather, all rays that meet one cell use the phase of one place, so that rays of different pixels
/// agree. The place is the middle of the cell, projected onto the plane of the surface. Its path to the panel is exact
/// for a surface seen directly, and correct to first order in the cell's side behind mirrors and glass.
///
/// @param side    side of the cells of equal phase [m]
/// @param sample  number of the ray; it selects the phase and the random numbers of its light paths
std::vector<RayWave> find_waves(const PathScene& scene, const TraceParams& params, double side, const Ray& ray,
                                uint64_t sample, PathCounts& counts);

/// Phase of a wave at the ray's starting point on the panel, less 2π·`length`/λ, without its random part and the
/// laser's [rad]: 2π·frac((optical path − length)/λ) + Fresnel phase, at one line of the path. If `length` is the
/// apparent distance, this is the starting phase of the wave at its origin.
double phase_beyond(const RayWave& wave, double length, double wavelength, int line);

/// Light of the wave toward another place on the panel, if it is visible from there: `weight` of its mirrors and glass,
/// and the light that leaves its surface. Without `light` the light of the wave itself applies.
struct SeenLight {
  std::optional<LeafLight> light;
  Vec3 weight;
};

/// - Seen directly: a shadow ray must be free, and the surface must show its same side to the place. The light of a
///   surface that is diffuse only is used again; other surfaces are evaluated anew, with the same random numbers.
/// - Behind mirrors and glass: a ray from the place, back along the wave, must pass the same reflections and
///   refractions, and end at the same surface (shows_the_same of specular.h).
std::optional<SeenLight> light_toward(const PathScene& scene, const TraceParams& params, const RayWave& wave,
                                      Vec3 place, uint64_t sample, PathCounts& counts);

}  // namespace holotrace
