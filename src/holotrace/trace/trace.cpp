#include "holotrace/trace/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/trace_report.h"
#include "holotrace/trace/waves/ray_waves.h"
#include "holotrace/trace/waves/source_phase.h"
#include "holotrace/trace/waves/wave_sets.h"

namespace holotrace {
namespace {

/// A tile of the panel. `centre` is the place from which visibility and radiance are evaluated [m].
struct PanelTile {
  PixelBox box;
  Vec3 centre;
};

/// The tiles of the panel, each of which sees a source from its own place: params.tile_columns × tile_rows, row by row
/// from the top. Only the strategy tiled has tiles; the list is empty for the others.
/// @throws Error  for fewer than 1 × 1 tiles, or more columns or rows than the panel has pixels
std::vector<PanelTile> make_tiles(const TraceParams& params, const Grid& panel) {
  if (params.strategy != Strategy::tiled) return {};
  const int columns = params.tile_columns, rows = params.tile_rows;
  require(columns >= 1 && rows >= 1 && columns <= panel.nx && rows <= panel.ny,
          "expected 1 to {} tile_columns and 1 to {} tile_rows on a panel of that many pixels, got {} and {}", panel.nx,
          panel.ny, columns, rows);
  std::vector<PanelTile> tiles;
  for (int t = 0; t < columns * rows; ++t) {
    const PixelBox box = tile_box(panel, columns, rows, t);
    tiles.push_back({box, centre_of(panel, box)});
  }
  return tiles;
}

// The waves of single rays and points, before `join` makes sets of them.

/// Data shared by all rays of a tracing.
struct Tracing {
  const PathScene& scene;
  const TraceParams& params;
  const FirstHits* pattern;  // nullptr for a scene of points alone
  const std::vector<PanelTile>& tiles;
  const std::vector<WaveSet>& sets;
  double side;  // side of the cells of equal phase [m]
  const Grid& panel;
  double widest;  // wavelength whose acceptance contains all boxes [m]
};

/// Results of one task.
struct Block {
  std::vector<TracedWaves> sets;
  PathCounts counts;
  int64_t first_hits = 0, far_waves = 0;
  Brightness surfaces;
};

/// Adds a wave to a set. `key` selects its random phase.
void add_wave(const Tracing& t, TracedWaves& set, Source wave, double phase, uint64_t key, const WaveCell& cell,
              const SecondFocus& second = {}) {
  if (key != Sources::no_phase_key) phase += random_phase(uint64_t(t.params.seed), 0, key);
  wave.phase = float(phase);
  set.waves.push_back(wave);
  set.keys.push_back(key);
  set.cells.push_back(cell);
  set.second_foci.push_back(second);
}

/// The wave with focal lines that a ray has found, if a spherical one would be wrong by more than λ/20 where it lights the panel.
std::optional<AstigmaticWave> astigmatic_wave(const Tracing& t, const Ray& ray, const SpecularLeaf& leaf) {
  if (!leaf.lines) return std::nullopt;
  const auto& [first, second, line] = *leaf.lines;
  double shortest = t.widest;
  for (const WaveSet& set : t.sets) shortest = std::min(shortest, set.wavelength);
  // Either curvature is off by half the difference.
  const auto is_seen = [&](double reach) {
    return std::abs(1 / second - 1 / first) / 4 * reach * reach > shortest / 20;
  };
  if (!is_seen(std::hypot(t.panel.width(), t.panel.height()))) return std::nullopt;
  const Vec3 origin = ray.origin + ray.direction * first, place = ray.origin + ray.direction * second;
  if (origin.z == place.z || origin.z == 0 || place.z == 0) return std::nullopt;
  const AstigmaticWave wave(origin, {place, line});
  const auto lit = wave.lit(acceptance_tangent(t.widest, t.panel.pitch));
  const double reach =
      std::hypot(std::min(2 * lit.reach_x, t.panel.width()), std::min(2 * lit.reach_y, t.panel.height()));
  return is_seen(reach) ? std::optional(wave) : std::nullopt;
}

/// The angle reduced to [0, 2π), where a float is most precise.
double reduced(double phase) { return phase - 2 * pi * std::floor(phase / (2 * pi)); }

/// A wave, and the sample whose ray found it.
struct FoundWave {
  const RayWave& wave;
  uint64_t sample;
};

/// Adds a wave found by a ray to a set. Its tiles' amplitudes must be there already.
void add_ray_wave(const Tracing& t, size_t s, const FoundWave& found, double amplitude, double light_phase,
                  Block& block) {
  const WaveSet& set = t.sets[s];
  const RayWave& wave = found.wave;
  const double distance = wave.astigmatic ? wave.leaf.lines->first : wave.leaf.distance;
  const double phase = reduced(phase_beyond(wave, distance, set.wavelength, set.line) + light_phase);
  const uint64_t key = key_in(set, t.params.phase, wave.key, found.sample);
  const bool is_alone = !t.params.one_wave_per_cell || key != wave.key;
  const Vec3 origin = wave.astigmatic ? wave.astigmatic->origin() : wave.origin;
  add_wave(t, block.sets[s], {origin, float(amplitude)}, phase, key, is_alone ? WaveCell{} : wave.cell,
           wave.astigmatic ? wave.astigmatic->second() : SecondFocus{});
}

/// Adds the waves found by a ray to the sets, each with one amplitude for the whole panel.
void add_shared(const Tracing& t, const Ray& ray, const RayWave& wave, uint64_t sample, Block& block) {
  for (size_t i = 0; i < t.sets.size(); ++i) {
    const WaveSet& set = t.sets[i];
    const SetLight light = light_of(set, wave.light, wave.leaf.weight);
    if (!(light.radiance > 0)) continue;
    const double brightness = squared_amplitude_of(light.radiance, t.params.amplitude);
    const double squared = brightness * t.pattern->squared_amplitude(ray, {wave.origin, wave.astigmatic}, set.cone());
    block.surfaces.add(brightness);
    if (const double amplitude = std::sqrt(squared); amplitude > 0)
      add_ray_wave(t, i, {wave, sample}, amplitude, light.phase, block);
  }
}

/// Whether a wave's light reaches a tile within the panel's acceptance, at any of the wavelengths.
bool is_in_reach(const Tracing& t, const PixelBox& tile, const RayWave& wave) {
  const auto [foot, reach_x, reach_y, slopes, tangent] =
      WaveShape{wave.origin, wave.astigmatic}.lit(acceptance_tangent(t.widest, t.panel.pitch));
  return foot.x >= t.panel.x(tile.x0) - reach_x && foot.x <= t.panel.x(tile.x1 - 1) + reach_x &&
         foot.y <= t.panel.y(tile.y0) + reach_y && foot.y >= t.panel.y(tile.y1 - 1) - reach_y;
}

/// The same, each with an amplitude for every tile within reach that sees it.
void add_tiled(const Tracing& t, const Ray& ray, const RayWave& wave, uint64_t sample, Block& block) {
  std::vector<std::optional<SeenLight>> seen;
  std::vector<PixelBox> visible;
  size_t in_reach = 0;
  for (const PanelTile& tile : t.tiles) {
    seen.emplace_back();
    if (!is_in_reach(t, tile.box, wave)) continue;
    ++in_reach;
    seen.back() = light_toward(t.scene, t.params, wave, tile.centre, sample, block.counts);
    if (seen.back()) visible.push_back(tile.box);
  }
  if (visible.empty()) return;
  for (size_t i = 0; i < t.sets.size(); ++i) {
    const WaveSet& set = t.sets[i];
    const SetLight light = light_of(set, wave.light, wave.leaf.weight);
    const double per_radiance =
        visible.size() == in_reach
            ? t.pattern->squared_amplitude(ray, {wave.origin, wave.astigmatic}, set.cone())
            : t.pattern->squared_amplitude(ray, {wave.origin, wave.astigmatic}, set.cone(), visible);
    const auto amplitude_of = [&](const SetLight& l) {
      return std::sqrt(squared_amplitude_of(l.radiance, t.params.amplitude) * per_radiance);
    };
    std::vector<float>& tiles = block.sets[i].tiles;
    const size_t first = tiles.size();
    bool is_lit = false;
    for (const auto& toward : seen) {
      const double amplitude =
          toward ? amplitude_of(light_of(set, toward->light ? *toward->light : wave.light, toward->weight)) : 0;
      tiles.push_back(float(amplitude));
      is_lit = is_lit || amplitude > 0;
    }
    if (!is_lit) {
      tiles.resize(first);
      continue;
    }
    block.surfaces.add(squared_amplitude_of(light.radiance, t.params.amplitude));
    add_ray_wave(t, i, {wave, sample}, amplitude_of(light), light.phase, block);
  }
}

/// Follows ray `index` to its first hit and traces light there.
void trace_sample(const Tracing& t, int64_t index, Block& block) {
  const uint64_t sample = t.scene.scene.points.size() + uint64_t(index);
  CounterRandom random(uint64_t(t.params.seed), 0, sample);
  random.uniform();  // the sample's random phase
  const auto ray = t.pattern->ray(index, random);
  if (!ray) return;
  std::vector<RayWave> waves = find_waves(t.scene, t.params, t.side, *ray, sample, block.counts);
  block.first_hits += !waves.empty();
  for (RayWave& wave : waves) {
    if (wave.origin.z == 0) continue;  // a point of the panel lights no pixel
    wave.astigmatic = astigmatic_wave(t, *ray, wave.leaf);
    if (wave.astigmatic)
      wave.cell.image = wave.astigmatic->second().place;  // where both curvatures cancel, their mean is nowhere
    block.far_waves += wave.leaf.is_far;
    if (t.tiles.empty())
      add_shared(t, *ray, wave, sample, block);
    else
      add_tiled(t, *ray, wave, sample, block);
  }
}

/// Adds the luminous points that the panel's centre (for `tiled`: any tile) sees.
void add_points(const Tracing& t, std::vector<TracedWaves>& sets, Brightness& brightness) {
  const std::vector<ScenePoint>& points = t.scene.scene.points;
  const double seen = std::sqrt(t.scene.share_of_unpolarised());
  for (size_t i = 0; i < points.size(); ++i) {
    const ScenePoint& point = points[i];
    const auto is_seen = [&](Vec3 place) { return !t.scene.accelerator.is_hidden(place, point.position); };
    std::vector<char> by_tiles;
    for (const PanelTile& tile : t.tiles) by_tiles.push_back(is_seen(tile.centre));
    const bool is_lit = t.tiles.empty() ? is_seen({}) : std::count(by_tiles.begin(), by_tiles.end(), 1) > 0;
    if (!is_lit) continue;
    brightness.add(double(point.amplitude) * point.amplitude);
    for (size_t s = 0; s < sets.size(); ++s) {
      const WaveSet& set = t.sets[s];
      if (!set.has_points) continue;
      const double whole = point_amplitude(t.panel, set.wavelength, set.cone(), std::abs(point.position.z));
      const auto amplitude = float(whole * point.amplitude * seen);
      add_wave(t, sets[s], {point.position, amplitude}, point.phase, point_key(t.params, t.sets[s], i), {});
      for (const char is_seen_from : by_tiles) sets[s].tiles.push_back(is_seen_from ? amplitude : 0);
    }
  }
}

constexpr int64_t block_rays = 64;  // per task

/// Facts of all tracings in a call.
struct Totals {
  PathCounts counts;
  int64_t rays = 0, first_hits = 0, far_waves = 0, mesh_waves = 0;
  Brightness points, surfaces;
};

template <class T>
void append(std::vector<T>& to, std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
  from = {};
}

/// Joins the waves of set `s`: those of the points (`points`), then those of the blocks, merged if they share a cell.
/// Frees the blocks' memory.
Sources join(const Tracing& t, size_t s, TracedWaves& points, std::vector<Block>& blocks) {
  TracedWaves all = std::move(points);
  size_t most = all.waves.size();
  for (const Block& block : blocks) most += block.sets[s].waves.size();
  all.waves.reserve(most);
  all.keys.reserve(most);
  all.cells.reserve(most);
  all.second_foci.reserve(most);
  all.tiles.reserve(most * t.tiles.size());
  for (Block& block : blocks) {
    TracedWaves& from = block.sets[s];
    append(all.waves, from.waves);
    append(all.keys, from.keys);
    append(all.cells, from.cells);
    append(all.second_foci, from.second_foci);
    append(all.tiles, from.tiles);
  }
  const size_t tiles = t.tiles.size();
  if (t.params.phase != SourcePhase::random) merge_waves(all, t.side, tiles);
  Sources sources;
  sources.wavelength = t.sets[s].wavelength;
  sources.label.cone_wavelength = t.sets[s].cone_wavelength;
  sources.label.name = t.sets[s].name;
  sources.seed = uint64_t(t.params.seed);
  const size_t count = all.waves.size();
  if (tiles > 0) {
    sources.tiles = {t.params.tile_columns, t.params.tile_rows, std::vector<float>(tiles * count)};
    for (size_t i = 0; i < all.tiles.size(); ++i) sources.tiles.values[i % tiles * count + i / tiles] = all.tiles[i];
  }
  sources.waves = std::move(all.waves);
  const auto is_astigmatic = [](const SecondFocus& focus) { return focus.is_astigmatic(); };
  if (std::any_of(all.second_foci.begin(), all.second_foci.end(), is_astigmatic))
    sources.second_foci = std::move(all.second_foci);
  const auto is_random = [](uint64_t key) { return key != Sources::no_phase_key; };
  if (std::any_of(all.keys.begin(), all.keys.end(), is_random)) sources.phase_keys = std::move(all.keys);
  return sources;
}

/// Traces one group of wavelengths; sets of lights or path groups without a wave are left out.
void trace_group(const Tracing& t, const Observer& observer, Totals& totals, std::vector<Sources>& sets) {
  const int64_t count = t.pattern ? t.pattern->count() : 0;
  const double bytes = sizeof(Source) + sizeof(uint64_t) + sizeof(WaveCell) + sizeof(SecondFocus) +
                       sizeof(float) * double(t.tiles.size());
  // Hash table of the cells, one set after the other (source_phase.h): about 100 bytes per wave.
  const double cells = t.params.phase != SourcePhase::random && t.params.one_wave_per_cell ? 100 : 0;
  require_memory((2 * bytes * double(t.sets.size()) + cells) * double(count),
                 fmt::format("{} sets of waves of {} first hits", t.sets.size(), count));
  std::atomic<int64_t> found{0};  // a ray finds several waves behind mirrors and glass
  std::vector<TracedWaves> points(t.sets.size());
  add_points(t, points, totals.points);
  std::vector<Block> blocks(size_t((count + block_rays - 1) / block_rays));
  std::atomic<int64_t> done{0};
  const auto trace_block = [&](int64_t b) {
    Block& block = blocks[size_t(b)];
    block.sets.resize(t.sets.size());
    const int64_t end = std::min(count, (b + 1) * block_rays);
    constexpr int64_t often =
        16;  // rays between reports: a block of many paths takes long, and a caller may want to stop
    for (int64_t first = b * block_rays; first < end; first += often) {
      const int64_t last = std::min(end, first + often);
      for (int64_t i = first; i < last; ++i) trace_sample(t, i, block);
      const int64_t rays = done += last - first;
      observer.progress(double(rays) / double(count));
    }
    int64_t waves = 0;
    for (const TracedWaves& set : block.sets) waves += int64_t(set.waves.size());
    waves += found.fetch_add(waves);
    require_memory(2 * bytes * double(waves), "the waves that rays find behind mirrors and glass");
  };
  parallel_for(0, int64_t(blocks.size()), trace_block);

  totals.rays += count;
  for (const Block& block : blocks) {
    totals.counts += block.counts;
    totals.first_hits += block.first_hits;
    totals.far_waves += block.far_waves;
    totals.surfaces += block.surfaces;
    for (const TracedWaves& set : block.sets) totals.mesh_waves += int64_t(set.waves.size());
  }
  const bool is_whole = !t.params.separate_path_groups && !t.params.separate_lights;
  for (size_t s = 0; s < t.sets.size(); ++s) {
    Sources sources = join(t, s, points[s], blocks);
    if (is_whole || !sources.waves.empty()) sets.push_back(std::move(sources));
  }
}

void check_params(const TraceParams& params) {
  check_ranges(params);
  require(params.strategy != Strategy::gather,
          "expected the strategy shared or tiled, got gather, which makes no waves but the field itself: use "
          "the command field or run, or call gather");
}

}  // namespace

std::vector<Sources> trace(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                           const TraceParams& params, const Observer& observer) {
  check_scene(scene);
  check_grid(panel);
  require(!wavelengths.empty(), "expected at least one wavelength, got none");
  for (const double wavelength : wavelengths) check_wavelength(wavelength, panel);
  check_params(params);
  require(
      params.strategy != Strategy::tiled || scene.media.empty(),
      "expected the strategy shared or gather in a scene with media, got tiled, which does not know what media hide");
  const std::vector<PanelTile> tiles = make_tiles(params, panel);
  const double side = cell_side(params, panel);
  const Cones cones = cones_of(wavelengths, params);
  std::optional<FirstHits> pattern;

  std::vector<Sources> sets;
  Totals totals;
  bool has_laser = false;
  const std::vector<TracedPart> parts = traced_parts(scene, wavelengths, params);
  for (size_t i = 0; i < parts.size(); ++i) {
    const auto& [group, component] = parts[i];
    const PathScene path_scene(scene, lines_of(group), params.path_expressions, path_params(component));
    if (!pattern && (has_surfaces(scene) || params.has_background)) pattern.emplace(params, panel, cones.of_rays);
    if (i == 0) warn_of_caustics(path_scene, observer);
    const std::vector<WaveSet> wave_sets = list_sets(path_scene, component, group, cones);
    for (const WaveSet& set : wave_sets) has_laser |= set.has_laser;
    const Tracing tracing{path_scene, component.params, pattern ? &*pattern : nullptr, tiles, wave_sets, side,
                          panel,      cones.of_rays};
    trace_group(tracing, part_of(observer, int(i), int(parts.size())), totals, sets);
  }
  sort_by_wavelength(sets, wavelengths);
  if (pattern) {
    report(totals.counts, params.max_depth, observer);
    observer.fact("first_hits", Fact(totals.first_hits));
    if (follows_mirrors(params.phase)) observer.fact("far_waves", Fact(totals.far_waves));
  }
  warn_of_findings({totals.rays, totals.first_hits, totals.mesh_waves == 0, has_laser, totals.points, totals.surfaces},
                   scene, panel, cones.of_rays, params, observer);
  report(cones, wavelengths, panel, observer);
  int64_t waves = 0;
  for (const Sources& set : sets) waves += int64_t(set.waves.size());
  observer.fact("waves", Fact(waves));
  return sets;
}

Sources trace(const Scene& scene, const Grid& panel, double wavelength, const TraceParams& params,
              const Observer& observer) {
  require(!params.separate_path_groups && !params.separate_lights && !params.separate_polarizations,
          "expected parameters that make one set of waves, got separate_path_groups = {}, separate_lights = {}, "
          "separate_polarizations = {}; trace a list of wavelengths, which returns all sets",
          params.separate_path_groups, params.separate_lights, params.separate_polarizations);
  return std::move(trace(scene, panel, std::vector<double>{wavelength}, params, observer).front());
}

}  // namespace holotrace
