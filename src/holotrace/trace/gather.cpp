#include "holotrace/trace/gather.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/check_ranges.h"
#include "holotrace/data/point_strength.h"
#include "holotrace/data/sources.h"
#include "holotrace/trace/first_hits.h"
#include "holotrace/trace/ray_waves.h"
#include "holotrace/trace/source_phase.h"
#include "holotrace/trace/trace_report.h"
#include "holotrace/trace/wave_sets.h"

namespace holotrace {

namespace {

struct Gathering {
  const PathScene& scene;
  const TraceParams& params;
  const Grid& panel;
  const std::vector<WaveSet>& sets;
  double widest;           // wavelength whose acceptance the rays fill
  double side;             // of the cells of equal surface phase
  double point_amplitude;  // on the panel, of a luminous point of 1 W/m²/sr
};

/// The complex amplitudes of one pixel: sums[set·frames + frame].
using PixelSums = std::vector<std::complex<double>>;

/// Adds a wave of that amplitude and phase (in cycles, without its random part) to every frame.
void add_wave(const Gathering& g, size_t set, double amplitude, double cycles, uint64_t key, PixelSums& sums) {
  const size_t frames = size_t(g.params.frames);
  for (size_t frame = 0; frame < frames; ++frame) {
    const double random =
        key == Sources::no_phase_key ? 0 : random_phase(uint64_t(g.params.seed), uint32_t(frame), key);
    sums[set * frames + frame] += amplitude * cis_cycles(cycles + random / (2 * pi));
  }
}

/// What the rays of a row, or of all, have found.
struct Found {
  PathCounts counts;
  int64_t first_hits = 0, waves = 0;
  Brightness surfaces;
};

/// Ray j of S from a pixel.
void add_sample(const Gathering& g, Vec3 pixel, int64_t j, uint64_t sample, PixelSums& sums, Found& found) {
  const int64_t samples = g.params.pixel_samples;
  CounterRandom random(uint64_t(g.params.seed), 0, sample);
  const double u = random.uniform(), v = random.uniform();
  const Vec2 sines = stratum(j, samples, u, v);
  const auto direction = accepted_direction(2 * sines.x - 1, 2 * sines.y - 1, g.panel, g.widest);
  if (!direction) return;
  const std::vector<RayWave> waves = find_waves(g.scene, g.params, g.side, {pixel, *direction}, sample, found.counts);
  found.first_hits += !waves.empty();
  const double limit = acceptance_sine(g.widest, g.panel.pitch), share = 4 * limit * limit / double(samples);
  for (const RayWave& wave : waves)
    for (size_t i = 0; i < g.sets.size(); ++i) {
      const WaveSet& set = g.sets[i];
      if (!is_accepted(*direction, g.panel, set.cone())) continue;
      const SetLight light = light_of(set, wave.light, wave.leaf.weight);
      if (!(light.radiance > 0)) continue;
      const double amplitude = std::sqrt(squared_amplitude_of(light.radiance, g.params.amplitude) * share);
      const double phase = phase_beyond(wave, 0, set.wavelength, set.line) + light.phase;
      add_wave(g, i, amplitude, phase / (2 * pi), key_in(set, g.params.phase, wave.key, sample), sums);
      ++found.waves;
      found.surfaces.add(squared_amplitude_of(light.radiance, g.params.amplitude));
    }
}

/// The luminous points: U = a·(d₀/r)·exp(i(kr + φ₀)) inside their boxes, a as point_strength.h says.
void add_points(const Gathering& g, Vec3 pixel, PixelSums& sums) {
  const std::vector<ScenePoint>& points = g.scene.scene.points;
  for (size_t p = 0; p < points.size(); ++p) {
    const ScenePoint& point = points[p];
    const Vec3 way = point.position - pixel;
    const double depth = -point.position.z, distance = length(way);
    if (g.scene.accelerator.is_occluded(pixel, point.position)) continue;
    for (size_t i = 0; i < g.sets.size(); ++i) {
      const double radius = box_radius(depth, g.sets[i].cone(), g.panel.pitch);
      if (!g.sets[i].has_points || std::abs(way.x) > radius || std::abs(way.y) > radius) continue;
      const double cycles = cycle_fraction(distance, g.sets[i].wavelength) + point.phase / (2 * pi);
      const uint64_t key = point_key(g.scene.scene, g.params, g.sets[i], p, g.side);
      add_wave(g, i, g.point_amplitude * point.amplitude * depth / distance, cycles, key, sums);
    }
  }
}

/// Powers that tell waves from noise: of the whole, and of what two halves of the rays share.
struct Agreement {
  double power = 0, shared = 0;

  /// Adds a pixel: U_A and U_B of the halves, whose noise is independent, so that 4·Re(U_A·U_B*) has the mean |E U|².
  void add(std::complex<double> whole, std::complex<double> half) {
    power += std::norm(whole);
    shared += 4 * std::real(half * std::conj(whole - half));
  }
};

/// States the part of the light that is waves and not noise, and warns where it is the smaller one.
void report(const std::vector<Agreement>& rows, int samples, const Observer& observer) {
  Agreement all;
  for (const Agreement& row : rows) {
    all.power += row.power;
    all.shared += row.shared;
  }
  if (!(all.power > 0)) return;
  const double part = all.shared / all.power;
  observer.fact("coherent_fraction", Fact(part));
  if (part >= 0.5) return;
  // The waves' power grows as S and the noise stays.
  const std::string need = part > 0.01 ? fmt::format("about {:.0f} or more", samples * (1 - part) / part)
                                       : fmt::format("a hundred times {} or more", samples);
  observer.warn(
      fmt::format("{:.0f} % of the light on the panel is noise of {} rays per pixel that find other points than their "
                  "neighbours'; take pixel_samples of {}, a wider grain on flat surfaces, or the strategy shared",
                  100 * std::min(1.0, 1 - part), samples, need));
}

/// Adds the fields of one group of wavelengths.
void gather_group(const Gathering& g, const Observer& observer, Found& total, std::vector<Agreement>& agreement,
                  std::vector<Field>& fields) {
  const Grid& panel = g.panel;
  const size_t frames = size_t(g.params.frames);
  require_memory(double(g.sets.size() * frames) * sizeof(std::complex<float>) * double(panel.pixels()),
                 fmt::format("{} fields of {} × {} pixels", g.sets.size() * frames, panel.nx, panel.ny));
  std::vector<Field> made;
  for (const WaveSet& set : g.sets)
    for (size_t frame = 0; frame < frames; ++frame) {
      made.emplace_back(panel, set.wavelength);
      made.back().cone_wavelength = set.cone_wavelength;
    }
  std::vector<Found> found(size_t(panel.ny), Found{});
  const uint64_t points = g.scene.scene.points.size();  // whose numbers come first
  const auto gather_row = [&](int64_t row) {
    PixelSums sums(made.size()), half(made.size());
    for (int column = 0; column < panel.nx; ++column) {
      const Vec3 pixel{panel.x(column), panel.y(double(row)), 0};
      std::fill(sums.begin(), sums.end(), 0.0);
      add_points(g, pixel, sums);
      for (size_t i = 0; i < made.size(); ++i) half[i] = 0.5 * sums[i];
      const uint64_t first =
          points + (uint64_t(row) * uint64_t(panel.nx) + uint64_t(column)) * uint64_t(g.params.pixel_samples);
      for (int64_t j = 1; j < g.params.pixel_samples; j += 2)
        add_sample(g, pixel, j, first + uint64_t(j), half, found[size_t(row)]);
      for (size_t i = 0; i < made.size(); ++i) sums[i] = 0.5 * sums[i] + half[i];
      for (int64_t j = 0; j < g.params.pixel_samples; j += 2)
        add_sample(g, pixel, j, first + uint64_t(j), sums, found[size_t(row)]);
      for (size_t i = 0; i < made.size(); i += frames) agreement[size_t(row)].add(sums[i], half[i]);
      for (size_t i = 0; i < made.size(); ++i) made[i].samples(int(row), column) = std::complex<float>(sums[i]);
    }
  };
  parallel_for(0, panel.ny, gather_row, observer);
  for (const Found& row : found) {
    total.counts += row.counts;
    total.first_hits += row.first_hits;
    total.waves += row.waves;
    total.surfaces += row.surfaces;
  }
  const bool is_whole = !g.params.separate_layers && !g.params.separate_lights;
  for (size_t i = 0; i < made.size(); i += frames)
    if (is_whole || power(made[i]) > 0)
      for (size_t frame = 0; frame < frames; ++frame) fields.push_back(std::move(made[i + frame]));
}

}  // namespace

void check_gather(const TraceParams& params) {
  require(params.phase != SourcePhase::random && params.phase != SourcePhase::constant,
          "expected the phase surface, path or laser with the strategy gather, got {}: every pixel finds points of its "
          "own, so phases that are not the surface's would make noise of the field, not waves",
          params.phase == SourcePhase::random ? "random" : "constant");
  check_ranges(params);
}

std::vector<Field> gather(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                          const TraceParams& params, const Observer& observer) {
  check_scene(scene);
  check_grid(panel);
  require(!wavelengths.empty(), "expected at least one wavelength, got none");
  for (const double wavelength : wavelengths) check_wavelength(wavelength);
  check_gather(params);
  const double side = cell_side(params, panel);
  const Cones cones = cones_of(wavelengths, params);

  std::vector<Field> fields;
  Found found;
  bool has_laser = false;
  std::vector<Agreement> agreement(size_t(panel.ny), Agreement{});
  const auto groups = group_wavelengths(scene, wavelengths);
  for (size_t g = 0; g < groups.size(); ++g) {
    const PathScene path_scene(scene, lines_of(groups[g]), params.layers, path_params(params));
    const std::vector<WaveSet> sets = list_sets(path_scene, params, groups[g], cones);
    for (const WaveSet& set : sets) has_laser |= set.has_laser;
    gather_group({path_scene, params, panel, sets, cones.of_rays, side, point_amplitude(panel, wavelengths.front())},
                 part_of(observer, int(g), int(groups.size())), found, agreement, fields);
  }
  report(found.counts, params.max_depth, observer);
  observer.fact("first_hits", Fact(found.first_hits));
  const int64_t rays = panel.pixels() * params.pixel_samples * int64_t(groups.size());
  TraceParams gathering = params;
  gathering.strategy = Strategy::gather;
  Brightness points;
  for (const ScenePoint& point : scene.points) points.add(double(point.amplitude) * point.amplitude);
  warn_of_findings({rays, found.first_hits, found.waves == 0, has_laser, points, found.surfaces}, scene, panel,
                   cones.of_rays, gathering, observer);
  report(cones, wavelengths, panel, observer);
  if (params.pixel_samples > 1) report(agreement, params.pixel_samples, observer);
  return fields;
}

}  // namespace holotrace
