#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "holotrace/base/low_discrepancy.h"
#include "holotrace/data/params/path_tracing.h"
#include "holotrace/data/path_expression.h"
#include "holotrace/data/polarization.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/accelerator.h"
#include "holotrace/trace/lights/emitters.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/caustic_bundles.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// A plane of a mesh that reflects as a mirror does: polished metal, smooth glass, a coat. Lights that no ray can meet shine by
/// it as their mirror images do.
struct FlatMirror {
  uint32_t mesh = 0;
  Vec3 place, normal;         ///< a point of the plane [m], and its unit normal
  std::vector<Light> images;  ///< mirror image of each light of the scene; rectangles as they are

  /// Whether a ray that met this point has met the plane.
  bool holds(const SurfacePoint& point) const;
};

/// Mirrors and glass between a surface and a light.
struct MirrorOnWay {
  int number = 0;  ///< of the way: a flat mirror, or one of the ways of caustic_light; from 1 on; 0: straight
  Vec3 phase{};    ///< that they add at the lines [rad]
};

/// The planes of all meshes that reflect, if there are lights that rays cannot meet. Meshes of more than 16 planes, and those with
/// smooth normals or a normal map, count as curved and have none.
std::vector<FlatMirror> flat_mirrors(const Scene& scene, const std::vector<Light>& lights, const Lines& lines);

/// Whether a mesh has more than 16 planes and no smooth normals: it is curved, of flat facets.
bool is_faceted(const Mesh& mesh);

/// Which light paths are followed, and how far.
struct PathParams {
  int max_depth = 8;              ///< surfaces on a path
  int roulette_depth = 4;         ///< first surface at which roulette may end a path; with asks_at_end each may
  double clamp = 0;               ///< largest radiance that one path may bring at a line [W/m²/sr]; 0: no clamp
  bool separate_lights = false;   ///< separate sums for each light
  bool asks_at_end = false;       ///< lights are sampled only at the last surface of a path
  int caustic_rays = 1024;        ///< rays that look for caustics, from each small lamp, about; 0: none
  bool shows_background = false;  ///< rays from the panel that meet no surface find the background
  uint64_t seed = 1;
  Acceleration accelerator = Acceleration::embree;
  std::optional<StokesVector> detector{};  ///< in place of the scene's analyser
};

/// A scene prepared for light paths at three wavelengths. Keeps a reference to the scene; calls may run on several
/// threads at once.
struct PathScene {
  const Scene& scene;
  Accelerator accelerator;
  Emitters emitters;
  PathAutomaton automaton;  ///< automaton of the path groups
  Lines lines;
  bool parts_lines;  ///< whether glass of the scene bends the three lines differently: each path has a hero (Hero)
  std::optional<StokesVector> detector;  ///< what is seen of polarised light; none: light has no polarization
  PathParams params;
  std::vector<LightLanes> light_lanes;  ///< of each light in Emitters::lights; set for rectangles and point lights
  std::vector<FlatMirror> mirrors;      ///< that reflect the light of lights which no ray can meet
  bool has_panes;                       ///< whether a mesh is of thin glass, which transmits light straight on
  Caustics caustics;                    ///< light of small lamps by mirrors and glass

  /// @throws Error  as Accelerator and PathAutomaton do, and for a max_depth or roulette_depth below 1 or a clamp
  /// below 0
  PathScene(const Scene& scene, const Lines& lines, const std::vector<std::string>& path_expressions,
            const PathParams& params);

  /// Number of sums that paths make: one per path group and, with separate lights, per light group. Sum
  /// g·path_groups + l is that of path group l and light group g.
  int sums() const { return automaton.path_groups() * (params.separate_lights ? emitters.groups() : 1); }

  /// Whether a surface sends the lines different ways.
  bool parts(const Material& material) const { return parts_lines && is_dispersive(material); }

  /// Number of heroes, one of which each path has.
  int heroes() const { return parts_lines ? 3 : 1; }

  /// A hero by its number, 0 … heroes() − 1.
  Hero hero(int number) const;

  /// The hero of the current path of the numbers.
  Hero hero_of(const LowDiscrepancy& numbers) const { return hero(parts_lines ? numbers.stratum(heroes()) : 0); }

  /// The lines, with glass that bends them by the index at a hero.
  Lines lines_of(const Hero& hero) const;

  /// What the viewer sees of unpolarised light that meets nothing on its way.
  double share_of_unpolarised() const { return detector ? (*detector)[0] : 1; }
};

}  // namespace holotrace
