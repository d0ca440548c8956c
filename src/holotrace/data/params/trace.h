#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/data/params/acceleration.h"
#include "holotrace/data/params/choice.h"

// trace: Scene → Sources

namespace holotrace {

/// What a traced sample lights: every pixel in its box; the same, with visibility and radiance of each tile of the
/// panel; or one pixel alone (the paper's algorithm; docs/path_tracing.md has the differences), which makes
/// no waves but the field itself.
enum class Strategy { shared, tiled, gather };

/// Which rays look for first hits: a raster seen from the panel's centre, or random ones over the panel's acceptance.
enum class Pattern { grid, random };

/// The phase of a wave: even over the circle; 0; a fixed function of the surface point; that plus k times the optical
/// path from the last diffuse or glossy surface; that plus k times the optical path from a laser to the surface.
enum class SourcePhase { random, constant, surface, path, laser };

/// Directions that the rays of `gather` fill: those that the panel accepts, or the whole hemisphere before each pixel.
enum class Directions { acceptance, hemisphere };

/// Where a light path asks the lights: at each of its surfaces, or at the one where it ends.
enum class ShadowRays { each_surface, path_end };

/// How the amplitude of a wave follows from radiance L: as √L, or as L itself (the paper's Step 5).
enum class AmplitudeLaw { sqrt, linear };

/// Where a scene's waves begin, and how much light is followed for each.
struct TraceParams {
  Strategy strategy = Strategy::shared;               ///< what a traced sample lights
  Pattern pattern = Pattern::grid;                    ///< which rays look for first hits
  int columns = 256, rows = 256;                      ///< of the raster of first hits (grid)
  int64_t samples = 65536;                            ///< first hits (random)
  int pixel_samples = 16;                             ///< S, rays from every pixel (gather)
  Directions directions = Directions::acceptance;     ///< of those rays (gather)
  int tile_columns = 8, tile_rows = 4;                ///< of the panel (tiled)
  double field_of_view = 0;                           ///< half angle of the raster [rad]; 0: the panel's acceptance
  bool has_common_cone = true;                        ///< all wavelengths keep to the cone of the shortest
  int paths = 64;                                     ///< light paths per first hit
  int max_depth = 8;                                  ///< surfaces on a path
  ShadowRays shadow_rays = ShadowRays::each_surface;  ///< where lights are asked
  double clamp = 0;                                   ///< most radiance that one path may bring [W/m²/sr]; 0: no clamp
  SourcePhase phase = SourcePhase::random;            ///< that waves start with
  double grain = 0;                             ///< side of the cells of equal surface phase [m]; 0: the pixel pitch
  bool one_wave_per_cell = true;                ///< first hits in a cell of equal phase make one wave, or each its own
  AmplitudeLaw amplitude = AmplitudeLaw::sqrt;  ///< from radiance
  std::vector<std::string> path_expressions{};  ///< light path expressions; none: all light, "E.*L"
  bool separate_path_groups = false;            ///< each path group a hologram of its own, or all in one
  bool separate_lights = false;                 ///< each light a hologram of its own: they do not interfere
  int frames = 1;                               ///< M, holograms with independent phases, shown one after the other
  Acceleration accelerator = Acceleration::embree;  ///< of the rays
  int64_t seed = 1;                                 ///< of every random number
};

template <class Visitor>
void describe(Visitor& v, TraceParams& p) {
  v.choice("strategy", p.strategy,
           {{"shared", Strategy::shared}, {"tiled", Strategy::tiled}, {"gather", Strategy::gather}},
           "each sample lights every pixel; the same with the light that each tile sees; or one pixel alone");
  v.choice("pattern", p.pattern, {{"grid", Pattern::grid}, {"random", Pattern::random}},
           "first hits: a raster seen from the panel's centre, or random over the panel's acceptance");
  v.count("columns", p.columns, range::at_least(1), "columns of the raster");
  v.count("rows", p.rows, range::at_least(1), "rows of the raster");
  v.count("samples", p.samples, range::from_to(1, 0x1p40), "first hits of the random pattern");
  v.count("pixel_samples", p.pixel_samples, range::at_least(1), "gather: rays from every pixel");
  v.choice("directions", p.directions, {{"acceptance", Directions::acceptance}, {"hemisphere", Directions::hemisphere}},
           "directions of the rays of gather: those that the panel accepts, or the whole hemisphere");
  v.count("tile_columns", p.tile_columns, range::at_least(1), "tiled: columns of tiles that the panel is cut into");
  v.count("tile_rows", p.tile_rows, range::at_least(1), "tiled: rows of tiles");
  v.angle("field_of_view", p.field_of_view, range::half_angle,
          "half angle of the raster; 0 deg: the panel's acceptance asin(lambda/2p)");
  v.flag("common_cone", p.has_common_cone,
         "all wavelengths keep to the cone of the shortest, so that the view has no coloured rim; or each has its own");
  v.count("paths", p.paths, range::at_least(1), "light paths per first hit");
  v.count("max_depth", p.max_depth, range::at_least(1), "most surfaces on a path");
  v.choice("shadow_rays", p.shadow_rays,
           {{"each-surface", ShadowRays::each_surface}, {"path-end", ShadowRays::path_end}},
           "surfaces of a light path that ask the lights: each, or the last alone, noisier with the same mean");
  v.number("clamp", p.clamp, range::not_negative,
           "most radiance that one path may bring; 0: no clamp, which is right but may be noisy");
  v.choice("phase", p.phase,
           {{"random", SourcePhase::random},
            {"constant", SourcePhase::constant},
            {"surface", SourcePhase::surface},
            {"path", SourcePhase::path},
            {"laser", SourcePhase::laser}},
           "of the waves: random, 0, fixed to the surface, that and the way through mirrors and glass, a laser's");
  v.length("grain", p.grain, range::not_negative, "side of the cells of equal surface phase; 0 m: the pixel pitch");
  v.flag("one_wave_per_cell", p.one_wave_per_cell,
         "one wave for all first hits in a cell of equal phase: brightness is radiance; false: a wave for each");
  v.choice("amplitude", p.amplitude, {{"sqrt", AmplitudeLaw::sqrt}, {"linear", AmplitudeLaw::linear}},
           "amplitude from radiance L: its root (brightness is radiance) or L itself (the paper's Step 5)");
  v.texts("path_expressions", p.path_expressions, "light path expressions, as E(D|G)L; none: all light");
  v.flag("separate_path_groups", p.separate_path_groups, "each path group a hologram of its own, or all in one");
  v.flag("separate_lights", p.separate_lights, "each light a hologram of its own, added without interference");
  v.count("frames", p.frames, range::at_least(1), "holograms with independent phases, shown one after the other");
  v.choice("accelerator", p.accelerator, {{"embree", Acceleration::embree}, {"grid", Acceleration::grid}},
           "of the rays: Embree's trees, or a uniform grid of cells (the paper's appendix)");
  v.count("seed", p.seed, range::not_negative, "seed for all random numbers");
}

}  // namespace holotrace
