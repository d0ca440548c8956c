#include "holotrace/trace/trace_samples.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/point_strength.h"
#include "holotrace/trace/waves/ray_waves.h"

namespace holotrace {
namespace {

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

}  // namespace

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

void add_points(const Tracing& t, std::vector<TracedWaves>& sets, Brightness& brightness) {
  const std::vector<ScenePoint>& points = t.scene.scene.points;
  for (size_t i = 0; i < points.size(); ++i) {
    const ScenePoint& point = points[i];
    const auto is_seen = [&](Vec3 place) { return !t.scene.accelerator.is_hidden(place, point.position); };
    std::vector<char> seen;  // index: tile
    for (const PanelTile& tile : t.tiles) seen.push_back(is_seen(tile.centre));
    const bool is_lit = t.tiles.empty() ? is_seen({}) : std::count(seen.begin(), seen.end(), 1) > 0;
    if (!is_lit) continue;
    brightness.add(double(point.amplitude) * point.amplitude);
    for (size_t s = 0; s < sets.size(); ++s) {
      const WaveSet& set = t.sets[s];
      if (!set.has_points) continue;
      const float amplitude =
          float(point_amplitude(t.panel, set.wavelength, set.cone(), std::abs(point.position.z)) * point.amplitude);
      add_wave(t, sets[s], {point.position, amplitude}, point.phase, point_key(t.params, t.sets[s], i), {});
      for (const char is_seen_from : seen) sets[s].tiles.push_back(is_seen_from ? amplitude : 0);
    }
  }
}

}  // namespace holotrace
