#include "holotrace/trace/waves/source_phase.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/sources.h"

namespace holotrace {

double cell_side(const TraceParams& params, const Grid& panel) {
  require(std::isfinite(params.grain) && params.grain >= 0,
          "expected a grain of 0 m (the pixel pitch) or more, got {} m", params.grain);
  return params.grain > 0 && params.phase != SourcePhase::constant ? params.grain : panel.pitch;
}

SurfaceCell surface_cell(Vec3 position, double side) {
  // Irrational fractions: those of √2, √3 and √5.
  const double offsets[3] = {0.41421356, 0.73205081, 0.23606798};
  const double coordinates[3] = {position.x, position.y, position.z};
  double centre[3];
  uint64_t key = 0;
  for (int i = 0; i < 3; ++i) {
    const double cell = std::floor(coordinates[i] / side + offsets[i]);
    centre[i] = (cell + 0.5 - offsets[i]) * side;
    key = mix(key + uint64_t(int64_t(cell)) * splitmix_step + 0x632be59bd9b4e019);
  }
  return {key == Sources::no_phase_key ? 0 : key, {centre[0], centre[1], centre[2]}};
}

namespace {

/// The amplitude of the summed power of two waves.
float add_light(float a, float b) { return float(std::sqrt(double(a) * a + double(b) * b)); }

}  // namespace

uint64_t image_key(uint64_t cell, const std::vector<SpecularVertex>& chain) {
  uint64_t key = cell;
  for (const SpecularVertex& vertex : chain) {
    key = (key ^ (key >> 32)) * 0x9e3779b97f4a7c15;  // Fibonacci hashing (Knuth, TAOCP 3, 6.4)
    key += vertex.is_transmission ? 2 : 1;
  }
  return key == WaveCell::alone ? 0 : key;
}

size_t CellWaves::find_or_add(uint64_t key, Vec3 origin, size_t next) {
  const auto [place, is_new] = newest_.emplace(key, uint32_t(entries_.size()));
  const double reach = std::max(8 * side_, 1e-3 * length(origin));
  for (uint32_t i = is_new ? none : place->second; i != none; i = entries_[i].older)
    if (length(entries_[i].origin - origin) <= reach) return entries_[i].number;
  entries_.push_back({origin, next, is_new ? none : place->second});
  place->second = uint32_t(entries_.size() - 1);
  return next;
}

void CellWaves::clear() {
  newest_.clear();
  entries_.clear();
}

void merge_waves(TracedWaves& w, double side, size_t tiles) {
  CellWaves cells(side);
  size_t kept = 0;
  for (size_t i = 0; i < w.waves.size(); ++i) {
    const WaveCell cell = w.cells[i];
    const size_t into = cell.key == WaveCell::alone ? kept : cells.find_or_add(cell.key, cell.image, kept);
    float* const to = w.tiles.data() + into * tiles;
    const float* const from = w.tiles.data() + i * tiles;
    if (into == kept) {
      w.waves[kept] = w.waves[i];
      w.keys[kept] = w.keys[i];
      w.cells[kept] = cell;
      w.second_foci[kept] = w.second_foci[i];
      if (kept < i) std::copy(from, from + tiles, to);
      ++kept;
      continue;
    }
    for (size_t t = 0; t < tiles; ++t) to[t] = add_light(to[t], from[t]);
    const float amplitude = add_light(w.waves[into].amplitude, w.waves[i].amplitude);
    if (cell.off_centre < w.cells[into].off_centre) {
      w.waves[into] = w.waves[i];
      w.cells[into] = cell;
      w.second_foci[into] = w.second_foci[i];
    }
    w.waves[into].amplitude = amplitude;
  }
  w.waves.resize(kept);
  w.keys.resize(kept);
  w.cells.resize(kept);
  w.second_foci.resize(kept);
  w.tiles.resize(kept * tiles);
}

}  // namespace holotrace
