#pragma once

#include <optional>
#include <vector>

#include "holotrace/data/params/trace.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/specular.h"
#include "holotrace/trace/waves/merge_waves.h"

// What a ray from the panel brings home: the waves that reach the panel along it, with their light and phase. The
// strategies (trace.h, gather.h) differ in what they do with them.

namespace holotrace {

/// Light that leaves a surface, for each sum (PathScene::sums), without what mirrors and glass do to it later.
struct LeafLight {
  std::vector<Vec3> radiance;    ///< at the lines [W/m²/sr]
  std::vector<Phasors> phasors;  ///< of a laser instead: amplitudes whose squared modulus is radiance
};

/// A wave that reaches the panel along a ray.
struct RayWave {
  SpecularLeaf leaf;
  Vec3 origin;       ///< where it seems to come from [m]
  uint64_t key = 0;  ///< of its random phase, or Sources::no_phase_key
  WaveCell cell;     ///< that it shares its phase with
  LeafLight light;
  bool is_diffuse = false;  ///< its surface alone is diffuse, and so looks alike from everywhere
};

/// The waves that a ray finds: one from its first hit or, where phases follow mirrors (follows_mirrors), one from
/// each leaf of the tree that begins there (specular.h). None where the ray meets nothing.
///
/// Under the strategy gather phases are those of one place for each cell, so that rays of different pixels agree: the
/// middle of the cell, dropped onto the plane of the surface. Their path from the panel is exact where the surface is
/// seen directly, and right to first order in the cell's side behind mirrors and glass.
///
/// @param side    of the cells of equal surface phase [m]
/// @param sample  number of the ray: of its phase, and of the numbers of its light paths
std::vector<RayWave> find_waves(const PathScene& scene, const TraceParams& params, double side, const Ray& ray,
                                uint64_t sample, PathCounts& counts);

/// Phase of a wave at the ray's own place on the panel, less 2π times `length`/λ, without its random part and the
/// laser's [rad]: 2π·frac((optical path − length)/λ) + Fresnel's, at a line of the path. With the apparent
/// distance for `length` it is what the wave starts with at its origin.
double phase_beyond(const RayWave& wave, double length, double wavelength, int line);

/// Light of the wave toward another place on the panel, if it is seen from there: `weight` of its mirrors and glass,
/// and what leaves its surface, where that is not the light of the wave itself.
struct SeenLight {
  std::optional<LeafLight> light;
  Vec3 weight;
};

/// - Seen directly: a shadow ray, and the surface must turn the same side to the place. A surface that is diffuse alone
///   looks alike from everywhere: its light is used again. Others are asked for theirs, with the same numbers.
/// - Behind mirrors and glass: a ray from the place toward the wave's origin must take the same turns and end at the
///   same surface (shows_the_same of specular.h).
std::optional<SeenLight> light_toward(const PathScene& scene, const TraceParams& params, const RayWave& wave,
                                      Vec3 place, uint64_t sample, PathCounts& counts);

}  // namespace holotrace
