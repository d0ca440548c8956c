#include "holotrace/base/sanitizers.h"
#include "holotrace/wave/planes/plane_plan.h"

#if !HOLOTRACE_THREAD_SANITIZER
#include <tbb/parallel_sort.h>
#endif

#include <algorithm>
#include <cmath>

#include "holotrace/base/threads.h"
#include "holotrace/data/acceptance.h"

namespace holotrace {
namespace {

/// Sorts in ascending order, on all threads; under the thread sanitizer on one thread. The sanitizer cannot follow how
/// oneTBB's library passes parts of the sort to threads, and would report a data race.
template <class Iterator>
void parallel_sort(Iterator first, Iterator last) {
#if HOLOTRACE_THREAD_SANITIZER
  std::sort(first, last);
#else
  tbb::parallel_sort(first, last);
#endif
}

struct Range {
  double least, greatest;
};

// Range of curvatures of a wave's light inside its box: (1 − ρ²/2r²)/λr falls from the axis to the box's corner.
// There, with t the tangent, r = d√(1 + 2t²).
Range curvatures(double per_depth, double wavelength, double tangent) {
  const double t2 = tangent * tangent, s = 1 + 2 * t2;
  return {per_depth * (1 + t2) / (wavelength * s * std::sqrt(s)), per_depth / wavelength};
}

// Boxes end at the tangent of the panel's acceptance; a tile's centre may lie up to half a tile beyond the box.
double reach_tangent(double wavelength, double pitch) { return 1.2 * acceptance_tangent(wavelength, pitch); }

}  // namespace

WaveDepths depths_of(PreparedWaves waves) {
  const auto [nearest, farthest] = std::minmax_element(
      waves.begin(), waves.end(), [](const PreparedWave& a, const PreparedWave& b) { return a.depth < b.depth; });
  return {nearest->depth, farthest->depth};
}

int Slabs::of(double depth) const {
  return step() > 0 ? std::clamp(int((1 / depths.nearest - 1 / depth) / step()), 0, count - 1) : 0;
}

Slab Slabs::slab(int index, double wavelength, double pitch) const {
  const double tangent = reach_tangent(wavelength, pitch), most = 1 / depths.nearest;
  const double greatest = curvatures(most - index * step(), wavelength, tangent).greatest;
  const double least = curvatures(std::max(0.0, most - (index + 1) * step()), wavelength, tangent).least;
  return {0, 0, (greatest + least) / 2, (greatest - least) / 2};
}

WavePacket packet_of_waves(PreparedWaves waves, size_t first, size_t last) {
  const PreparedWave& w = waves[first];
  WavePacket p{first, last, w.box, w.box, w.x, w.x, w.y, w.y, w.depth};
  for (size_t i = first + 1; i < last; ++i) {
    const PreparedWave& wave = waves[i];
    p.lit_by_all = intersect(p.lit_by_all, wave.box);
    p.lit_by_any = {std::min(p.lit_by_any.x0, wave.box.x0), std::max(p.lit_by_any.x1, wave.box.x1),
                    std::min(p.lit_by_any.y0, wave.box.y0), std::max(p.lit_by_any.y1, wave.box.y1)};
    p.x0 = std::min(p.x0, wave.x), p.x1 = std::max(p.x1, wave.x);
    p.y0 = std::min(p.y0, wave.y), p.y1 = std::max(p.y1, wave.y);
    p.nearest = std::min(p.nearest, wave.depth);
  }
  return p;
}

SortedWaves sort_waves(PreparedWaves waves, const PlanesPlan& plan, double wavelength, double pitch) {
  const WaveDepths depths = depths_of(waves);
  const Slabs slabs{depths, plan.slabs};
  // Rows of eight cells of a grid, so that the cells of successive waves stay in the cache.
  const double cell = wavelength * std::sqrt(depths.nearest * depths.farthest) / (plan.transform() * pitch);
  struct Key {
    int slab, row;
    double x;
    uint32_t index;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<Key> keys(waves.size());
  parallel_for(0, int64_t(waves.size()), [&](int64_t i) {
    const PreparedWave& wave = waves[size_t(i)];
    keys[size_t(i)] = {slabs.of(wave.depth), int(std::floor(wave.y / (8 * cell))), wave.x, uint32_t(i)};
  });
  parallel_sort(keys.begin(), keys.end());
  SortedWaves sorted;
  sorted.waves.resize(waves.size());
  parallel_for(0, int64_t(keys.size()), [&](int64_t i) { sorted.waves[size_t(i)] = waves[keys[size_t(i)].index]; });
  for (size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i].slab != keys[i - 1].slab) {
      sorted.slabs.push_back(slabs.slab(keys[i].slab, wavelength, pitch));
      sorted.slabs.back().first = i;
    }
    sorted.slabs.back().last = i + 1;
  }
  for (Slab& slab : sorted.slabs)
    for (size_t first = slab.first; first < slab.last; first += waves_of_packet)
      slab.packets.push_back(packet_of_waves(sorted.waves, first, std::min(first + waves_of_packet, slab.last)));
  return sorted;
}

}  // namespace holotrace
