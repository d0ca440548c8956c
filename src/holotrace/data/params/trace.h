#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/data/params/parameter.h"
#include "holotrace/data/params/path_tracing.h"

// trace: Scene → Sources

namespace holotrace {

/// What a traced sample lights. `shared`: every panel pixel in its box. `tiled`: the same, with visibility and radiance
/// found for each tile of the panel. `gather`: one panel pixel (the paper's algorithm; docs/explanation/path_tracing.md
/// has the differences); it makes the field itself instead of waves.
enum class Strategy { shared, tiled, gather };

/// Rays that find first hits: a raster seen from the panel's centre, or random rays over the panel's acceptance.
enum class Pattern { grid, random };

/// The phase of a wave. `random`: uniform over the circle. `constant`: 0. `surface`: a fixed random phase of the point
/// on the surface. `path`: the surface phase plus k times the optical path from the last diffuse or glossy surface.
/// `laser`: the surface phase plus k times the optical path from a laser to the surface.
enum class SourcePhase { random, constant, surface, path, laser };

/// Directions of the rays of `gather`: those that the panel accepts, or the whole hemisphere in front of each pixel.
enum class Directions { acceptance, hemisphere };

/// Where a light path sends shadow rays to the lights: from each of its surfaces, or from its last surface only.
enum class ShadowRays { each_surface, path_end };

/// Amplitude of a wave as a function of the radiance L: √L, or L itself (the paper's Step 5).
enum class AmplitudeLaw { sqrt, linear };

/// Pixels along each side of the raster of first hits where none are given or chosen.
inline constexpr int default_raster = 256;

/// Where a scene's waves begin, and how much light is followed for each.
struct TraceParams {
  Strategy strategy = Strategy::shared;               ///< what a traced sample lights
  Pattern pattern = Pattern::grid;                    ///< which rays look for first hits
  int columns = 0, rows = 0;                          ///< pixels of the raster of first hits (grid); 0: chosen
  int64_t samples = 65536;                            ///< rays that look for first hits (random)
  int pixel_samples = 16;                             ///< S, rays from each panel pixel (gather)
  Directions directions = Directions::acceptance;     ///< directions of those rays (gather)
  int tile_columns = 8, tile_rows = 4;                ///< tiles of the panel (tiled)
  double field_of_view = 0;                           ///< half angle of the raster [rad]; 0: the panel's acceptance
  bool has_common_cone = true;                        ///< every wavelength uses the cone of the shortest
  int paths = 64;                                     ///< light paths per first hit
  int max_depth = 8;                                  ///< largest number of surfaces on a light path
  int roulette_depth = 4;                             ///< first surface at which roulette may end a light path
  ShadowRays shadow_rays = ShadowRays::each_surface;  ///< surfaces of a path that send shadow rays
  double clamp = 0;                             ///< upper limit of the radiance of one path [W/m²/sr]; 0: no limit
  SourcePhase phase = SourcePhase::random;      ///< phase of the waves
  double grain = 0;                             ///< side of the cells of equal surface phase [m]; 0: the pixel pitch
  bool one_wave_per_cell = true;                ///< first hits in one cell of equal phase make one wave
  AmplitudeLaw amplitude = AmplitudeLaw::sqrt;  ///< amplitude as a function of the radiance
  std::vector<std::string> path_expressions{};  ///< light path expressions; none: all light, "E.*L"
  bool separate_path_groups = false;            ///< one hologram per path expression
  bool separate_lights = false;                 ///< one hologram per light: lights do not interfere
  bool separate_polarizations = false;          ///< one hologram for horizontal and one for vertical polarization
  int frames = 0;  ///< M, holograms shown one after the other, of waves with independent phases; 0: chosen, 1 for waves
  Acceleration accelerator = Acceleration::embree;  ///< structure that finds the surface on a ray
  bool has_background = false;  ///< light from infinitely far away makes waves where a ray meets no surface
  int64_t seed = 1;             ///< seed for all random numbers
};

/// Size of the raster of first hits.
inline int raster_columns(const TraceParams& params) { return params.columns > 0 ? params.columns : default_raster; }
inline int raster_rows(const TraceParams& params) { return params.rows > 0 ? params.rows : default_raster; }

template <class Visitor>
void describe(Visitor&& v, TraceParams& p) {
  v(choice("strategy", p.strategy,
           {{"shared", Strategy::shared}, {"tiled", Strategy::tiled}, {"gather", Strategy::gather}},
           "panel pixels that one wave reaches. shared: all, with one radiance; tiled: all, with a radiance for "
           "each panel tile; gather: only the pixel of its ray"));
  v(choice(
      "pattern", p.pattern, {{"grid", Pattern::grid}, {"random", Pattern::random}},
      "rays that find first hits: a raster seen from the panel's centre, or random rays over the panel's acceptance"));
  v(count("columns", p.columns, range::not_negative,
          "columns of the raster; 0: as many as the panel resolves in the window of the views, 256 or more"));
  v(count("rows", p.rows, range::not_negative, "rows of the raster; 0: as for columns"));
  v(count("samples", p.samples, range::from_to(1, 0x1p40), "random: number of rays"));
  v(count("pixel_samples", p.pixel_samples, range::at_least(1), "gather: rays from each panel pixel"));
  v(choice("directions", p.directions, {{"acceptance", Directions::acceptance}, {"hemisphere", Directions::hemisphere}},
           "gather: directions of the rays: those that the panel accepts, or the whole hemisphere"));
  v(count("tile_columns", p.tile_columns, range::at_least(1), "tiled: number of tiles across the panel"));
  v(count("tile_rows", p.tile_rows, range::at_least(1), "tiled: number of tiles down the panel"));
  v(angle(
      "field_of_view", p.field_of_view, range::half_angle,
      "half angle of the raster; 0 deg: the window of the views if columns and rows are 0, else the panel's acceptance "
      "asin(lambda/2p)"));
  v(flag("common_cone", p.has_common_cone,
         "common cone for all wavelengths, that of the shortest; avoids a coloured border of the view; false: each "
         "wavelength uses its own cone"));
  v(count("paths", p.paths, range::at_least(1), "light paths per first hit"));
  v(count("max_depth", p.max_depth, range::at_least(1), "largest number of surfaces on a light path"));
  v(count(
      "roulette_depth", p.roulette_depth, range::at_least(1),
      "first surface at which Russian roulette may end a light path; later surfaces give longer paths and mostly less "
      "noise; with shadow_rays path-end every surface may end a path"));
  v(choice(
      "shadow_rays", p.shadow_rays, {{"each-surface", ShadowRays::each_surface}, {"path-end", ShadowRays::path_end}},
      "surfaces of a path that send shadow rays to the lights: each, or only the last (the same mean, more noise)"));
  v(number("clamp", p.clamp, range::not_negative,
           "upper limit of the radiance of one path in W/m2/sr; less noise, but some light is lost; 0: no limit"));
  v(choice(
      "phase", p.phase,
      {{"random", SourcePhase::random},
       {"constant", SourcePhase::constant},
       {"surface", SourcePhase::surface},
       {"path", SourcePhase::path},
       {"laser", SourcePhase::laser}},
      "phase of the waves: random for each wave (random); 0 (constant); random for each cell of a surface (surface); "
      "the surface phase plus k times the optical path through mirrors and glass (path); the path phase plus k times "
      "the optical path from the laser (laser)"));
  v(length("grain", p.grain, range::not_negative,
           "side of the surface cells that share one phase; 0 m: the pixel pitch"));
  v(flag("one_wave_per_cell", p.one_wave_per_cell,
         "one wave for all first hits in a cell of equal phase, so that brightness follows radiance; false: one for "
         "each hit"));
  v(choice(
      "amplitude", p.amplitude, {{"sqrt", AmplitudeLaw::sqrt}, {"linear", AmplitudeLaw::linear}},
      "amplitude of a wave of radiance L: sqrt(L), so that brightness follows radiance, or L (the paper's Step 5)"));
  v(texts("path_expressions", p.path_expressions, "light path expressions, for example E(D|G)L; empty: all light"));
  v(flag("separate_path_groups", p.separate_path_groups, "one hologram for each path expression; false: one for all"));
  v(flag("separate_lights", p.separate_lights,
         "one hologram for each light; their images are added without interference"));
  v(flag(
      "separate_polarizations", p.separate_polarizations,
      "two holograms, of horizontally and of vertically polarised light; their images are added without interference"));
  v(count("frames", p.frames, range::not_negative,
          "holograms with independent phases, shown one after the other; 0: as quality says for sgd, else 1"));
  v(choice(
      "accelerator", p.accelerator, {{"embree", Acceleration::embree}, {"grid", Acceleration::grid}},
      "structure that finds the surface on a ray: Embree's trees, or a uniform grid of cells (the paper's appendix)"));
  v(flag(
      "background", p.has_background,
      "background, environment, sky and sun in holograms, as plane waves, where a ray from the panel meets no surface; "
      "false: they light the scene only"));
  v(count("seed", p.seed, range::not_negative, "seed for all random numbers"));
}

}  // namespace holotrace
