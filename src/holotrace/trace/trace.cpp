#include "holotrace/trace/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/check_ranges.h"
#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/tiles.h"
#include "holotrace/trace/trace_report.h"
#include "holotrace/trace/trace_samples.h"
#include "holotrace/trace/waves/merge_waves.h"
#include "holotrace/trace/waves/source_phase.h"
#include "holotrace/trace/waves/wave_sets.h"

namespace holotrace {

namespace {

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
  // Hash table of the cells, one set after the other (merge_waves.h): about 100 bytes per wave.
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
  const std::vector<PanelTile> tiles = make_tiles(params, panel);
  const double side = cell_side(params, panel);
  const Cones cones = cones_of(wavelengths, params);
  std::optional<FirstHits> pattern;

  std::vector<Sources> sets;
  Totals totals;
  bool has_laser = false;
  const auto groups = group_wavelengths(scene, wavelengths);
  for (size_t g = 0; g < groups.size(); ++g) {
    const PathScene path_scene(scene, lines_of(groups[g]), params.path_expressions, path_params(params));
    if (!pattern && has_surfaces(scene)) pattern.emplace(params, panel, cones.of_rays);
    if (g == 0) warn_of_caustics(path_scene, observer);
    const std::vector<WaveSet> wave_sets = list_sets(path_scene, params, groups[g], cones);
    for (const WaveSet& set : wave_sets) has_laser |= set.has_laser;
    const Tracing tracing{path_scene, params,       pattern ? &*pattern : nullptr, tiles, wave_sets, side,
                          panel,      cones.of_rays};
    const Observer part = part_of(observer, int(g), int(groups.size()));
    trace_group(tracing, part, totals, sets);
  }
  if (has_surfaces(scene)) {
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
  require(
      !params.separate_path_groups && !params.separate_lights,
      "expected parameters that make one set of waves, got separate_path_groups = {}, separate_lights = {}; trace a "
      "list of wavelengths, which returns all sets",
      params.separate_path_groups, params.separate_lights);
  return std::move(trace(scene, panel, std::vector<double>{wavelength}, params, observer).front());
}

}  // namespace holotrace
