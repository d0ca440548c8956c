#include "holotrace/trace/gather.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <limits>
#include <string>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/data/sources.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/trace_report.h"
#include "holotrace/trace/waves/ray_waves.h"
#include "holotrace/trace/waves/source_phase.h"
#include "holotrace/trace/waves/wave_sets.h"

namespace holotrace {

namespace {

struct Gathering {
  const PathScene& scene;
  const TraceParams& params;
  const Grid& panel;
  const std::vector<WaveSet>& sets;
  Grid accepting;  // panel whose acceptance contains the rays' directions
  double widest;   // wavelength whose acceptance the rays fill [m]
  double side;     // side of the cells of equal phase [m]
};

/// The rays of one half of a pixel's rays (even or odd numbers) that met one cell: the sum of their squared amplitudes,
/// and that sum weighted by the phase factors.
struct HalfWave {
  double light = 0;
  std::complex<double> phasor;
};

/// The wave from one cell to one pixel in one set.
struct PixelWave {
  size_t set;
  uint64_t key;  // key of its random phase
  std::array<HalfWave, 2> halves;
};

/// Complex amplitudes of one pixel, index set·frames + frame: from all its rays, and from either half of them.
struct PixelSums {
  std::vector<std::complex<double>> whole;
  std::array<std::vector<std::complex<double>>, 2> halves;
};

/// Results of the rays so far, and the waves of the current pixel.
struct Found {
  explicit Found(double side) : cells(side) {}

  PathCounts counts;
  int64_t first_hits = 0, light = 0;
  Brightness surfaces;
  std::vector<PixelWave> waves;
  CellWaves cells;
};

/// √light with the phase of a phasor.
std::complex<double> amplitude_of(double light, std::complex<double> phasor) {
  const double size = std::abs(phasor);
  return size > 0 ? std::sqrt(light) / size * phasor : 0.0;
}

/// The panel whose acceptance contains the directions of the rays.
Grid accepting_panel(const Grid& panel, const TraceParams& params) {
  Grid accepting = panel;
  // A panel of an extremely fine pitch accepts light from all sides.
  if (params.directions == Directions::hemisphere) accepting.pitch = std::numeric_limits<double>::min();
  return accepting;
}

/// Adds ray j of a pixel's rays.
void add_sample(const Gathering& g, Vec3 pixel, int64_t j, uint64_t sample, Found& found) {
  const int64_t samples = g.params.pixel_samples;
  CounterRandom random(uint64_t(g.params.seed), 0, sample);
  const double u = random.uniform(), v = random.uniform();
  const Vec2 sines = stratum(j, samples, u, v);
  const auto direction = accepted_direction(2 * sines.x - 1, 2 * sines.y - 1, g.accepting, g.widest);
  if (!direction) return;
  const std::vector<RayWave> waves = find_waves(g.scene, g.params, g.side, {pixel, *direction}, sample, found.counts);
  found.first_hits += !waves.empty();
  const double limit = acceptance_sine(g.widest, g.accepting.pitch), share = 4 * limit * limit / double(samples);
  for (const RayWave& wave : waves)
    for (size_t i = 0; i < g.sets.size(); ++i) {
      const WaveSet& set = g.sets[i];
      if (!is_accepted(*direction, g.accepting, set.cone())) continue;
      const SetLight light = light_of(set, wave.light, wave.leaf.weight);
      if (!(light.radiance > 0)) continue;
      const double squared = squared_amplitude_of(light.radiance, g.params.amplitude) * share;
      const double phase = phase_beyond(wave, 0, set.wavelength, set.line) + light.phase;
      const uint64_t key = key_in(set, g.params.phase, wave.key, sample);
      const bool is_alone = wave.cell.key == WaveCell::alone || key != wave.key || !g.params.one_wave_per_cell;
      const size_t next = found.waves.size();
      // Sets are distinguished by a rotation of the key, the waves of one set by the key itself.
      const size_t number =
          is_alone ? next : found.cells.find_or_add(std::rotl(wave.cell.key, int(i % 64)) ^ i, wave.origin, next);
      if (number == next) found.waves.push_back({i, key, {}});
      HalfWave& half = found.waves[number].halves[size_t(j % 2)];
      half.light += squared;
      half.phasor += squared * cis_cycles(phase / (2 * pi));
      ++found.light;
      found.surfaces.add(squared_amplitude_of(light.radiance, g.params.amplitude));
    }
}

/// Adds up the waves that a pixel's rays have found, and clears them.
void add_waves(const Gathering& g, Found& found, PixelSums& sums) {
  const size_t frames = size_t(g.params.frames);
  const double samples = g.params.pixel_samples;
  const double shares[2] = {std::ceil(samples / 2) / samples, std::floor(samples / 2) / samples};
  for (const PixelWave& wave : found.waves) {
    const std::complex<double> whole =
        amplitude_of(wave.halves[0].light + wave.halves[1].light, wave.halves[0].phasor + wave.halves[1].phasor);
    for (size_t frame = 0; frame < frames; ++frame) {
      const double random =
          wave.key == Sources::no_phase_key ? 0 : random_phase(uint64_t(g.params.seed), uint32_t(frame), wave.key);
      const std::complex<double> turn = cis_cycles(random / (2 * pi));
      sums.whole[wave.set * frames + frame] += whole * turn;
      for (size_t h = 0; h < 2; ++h)
        if (wave.halves[h].light > 0)
          sums.halves[h][wave.set * frames + frame] +=
              amplitude_of(wave.halves[h].light / shares[h], wave.halves[h].phasor) * turn;
    }
  }
  found.waves.clear();
  found.cells.clear();
}

/// The luminous points: U = a·(d₀/r)·exp(i(±kr + φ₀)) inside their boxes, a as acceptance.h says.
void add_points(const Gathering& g, Vec3 pixel, PixelSums& sums) {
  const std::vector<ScenePoint>& points = g.scene.scene.points;
  const size_t frames = size_t(g.params.frames);
  const double seen = std::sqrt(g.scene.share_of_unpolarised());
  for (size_t p = 0; p < points.size(); ++p) {
    const ScenePoint& point = points[p];
    const Vec3 way = point.position - pixel;
    const double depth = std::abs(point.position.z), distance = length(way);
    if (g.scene.accelerator.is_hidden(pixel, point.position)) continue;
    for (size_t i = 0; i < g.sets.size(); ++i) {
      const double radius = box_radius(depth, g.sets[i].cone(), g.panel.pitch);
      if (!g.sets[i].has_points || std::abs(way.x) > radius || std::abs(way.y) > radius) continue;
      const double amplitude =
          point_amplitude(g.panel, g.sets[i].wavelength, g.sets[i].cone(), depth) * point.amplitude * seen;
      const double beyond = point.position.z < 0 ? distance : -distance;  // a wave to a point in front converges
      const double cycles = cycle_fraction(beyond, g.sets[i].wavelength) + point.phase / (2 * pi);
      const uint64_t key = point_key(g.params, g.sets[i], p);
      for (size_t frame = 0; frame < frames; ++frame) {
        const double random =
            key == Sources::no_phase_key ? 0 : random_phase(uint64_t(g.params.seed), uint32_t(frame), key);
        const std::complex<double> wave = amplitude * depth / distance * cis_cycles(cycles + random / (2 * pi));
        for (auto* sum : {&sums.whole, &sums.halves[0], &sums.halves[1]}) (*sum)[i * frames + frame] += wave;
      }
    }
  }
}

/// Powers that separate waves from noise: the mean power of the two half sums, and the power that both share.
struct Agreement {
  double power = 0, shared = 0;

  /// Adds a pixel. The noise of U_A and U_B is independent, so the mean of Re(U_A·U_B*) is |E U_A|².
  void add(std::complex<double> a, std::complex<double> b) {
    power += (std::norm(a) + std::norm(b)) / 2;
    shared += std::real(a * std::conj(b));
  }
};

/// Reports the fraction of the light that is waves and not noise, and warns if it is below one half.
void report(const std::vector<Agreement>& rows, int samples, const Observer& observer) {
  Agreement all;
  for (const Agreement& row : rows) {
    all.power += row.power;
    all.shared += row.shared;
  }
  if (!(all.power > 0)) return;
  // While each cell has few rays, waves grow with their number and noise does not: twice the rays give twice the odds.
  const double of_half = std::clamp(all.shared / all.power, 0.0, 1.0), part = 2 * of_half / (1 + of_half);
  observer.fact("coherent_fraction", Fact(part));
  if (part >= 0.5) return;
  const std::string need =
      part > 0.01 ? fmt::format("{:.0f}", samples * (1 - part) / part) : fmt::format("100 times {}", samples);
  observer.warn(
      fmt::format("{:.0f} % of the light on the panel is noise: the {} rays of a pixel hit other points than those of "
                  "its neighbours; raise pixel_samples to about {}, use a wider grain on flat surfaces, or the "
                  "strategy shared",
                  100 * std::min(1.0, 1 - part), samples, need));
}

/// Adds the fields for one group of wavelengths.
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
      made.back().label = {set.name, uint32_t(frame), set.cone_wavelength};
    }
  std::vector<Found> found(size_t(panel.ny), Found(g.side));
  const uint64_t points = g.scene.scene.points.size();  // the points' numbers come first
  const auto gather_row = [&](int64_t row) {
    PixelSums sums{std::vector<std::complex<double>>(made.size()), {}};
    sums.halves = {sums.whole, sums.whole};
    Found& here = found[size_t(row)];
    for (int column = 0; column < panel.nx; ++column) {
      const Vec3 pixel{panel.x(column), panel.y(double(row)), 0};
      for (auto* sum : {&sums.whole, &sums.halves[0], &sums.halves[1]}) std::fill(sum->begin(), sum->end(), 0.0);
      add_points(g, pixel, sums);
      const uint64_t first =
          points + (uint64_t(row) * uint64_t(panel.nx) + uint64_t(column)) * uint64_t(g.params.pixel_samples);
      for (int64_t j = 0; j < g.params.pixel_samples; ++j) add_sample(g, pixel, j, first + uint64_t(j), here);
      add_waves(g, here, sums);
      for (size_t i = 0; i < made.size(); i += frames) agreement[size_t(row)].add(sums.halves[0][i], sums.halves[1][i]);
      for (size_t i = 0; i < made.size(); ++i) made[i].samples(int(row), column) = std::complex<float>(sums.whole[i]);
    }
    here.cells = CellWaves(g.side);
  };
  parallel_for(0, panel.ny, gather_row, observer);
  for (const Found& row : found) {
    total.counts += row.counts;
    total.first_hits += row.first_hits;
    total.light += row.light;
    total.surfaces += row.surfaces;
  }
  const bool is_whole = !g.params.separate_path_groups && !g.params.separate_lights;
  for (size_t i = 0; i < made.size(); i += frames)
    if (is_whole || power(made[i]) > 0)
      for (size_t frame = 0; frame < frames; ++frame) fields.push_back(std::move(made[i + frame]));
}

}  // namespace

void check_gather(const TraceParams& params) { check_ranges(params); }

std::vector<Field> gather(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                          const TraceParams& asked, const Observer& observer) {
  TraceParams params = asked;
  params.strategy = Strategy::gather;
  params.frames = std::max(1, asked.frames);
  check_scene(scene);
  check_grid(panel);
  require(!wavelengths.empty(), "expected at least one wavelength, got none");
  for (const double wavelength : wavelengths) check_wavelength(wavelength, panel);
  check_gather(params);
  const double side = cell_side(params, panel);
  const bool has_cone = params.directions == Directions::acceptance;
  const Cones cones =
      has_cone ? cones_of(wavelengths, params) : Cones{*std::max_element(wavelengths.begin(), wavelengths.end()), 0};

  std::vector<Field> fields;
  Found found(side);
  bool has_laser = false;
  std::vector<Agreement> agreement(size_t(panel.ny), Agreement{});
  const std::vector<TracedPart> parts = traced_parts(scene, wavelengths, params);
  for (size_t i = 0; i < parts.size(); ++i) {
    const auto& [group, component] = parts[i];
    const PathScene path_scene(scene, lines_of(group), params.path_expressions, path_params(component));
    if (i == 0) warn_of_caustics(path_scene, observer);
    const std::vector<WaveSet> sets = list_sets(path_scene, component, group, cones);
    for (const WaveSet& set : sets) has_laser |= set.has_laser;
    gather_group({path_scene, component.params, panel, sets, accepting_panel(panel, params), cones.of_rays, side},
                 part_of(observer, int(i), int(parts.size())), found, agreement, fields);
  }
  sort_by_wavelength(fields, wavelengths);
  report(found.counts, params.max_depth, observer);
  observer.fact("first_hits", Fact(found.first_hits));
  const int64_t rays = panel.pixels() * params.pixel_samples * int64_t(parts.size());
  Brightness points;
  for (const ScenePoint& point : scene.points) points.add(double(point.amplitude) * point.amplitude);
  warn_of_findings({rays, found.first_hits, found.light == 0, has_laser, points, found.surfaces}, scene, panel,
                   cones.of_rays, params, observer);
  if (has_cone) report(cones, wavelengths, panel, observer);
  if (params.pixel_samples > 1) report(agreement, params.pixel_samples, observer);
  return fields;
}

}  // namespace holotrace
