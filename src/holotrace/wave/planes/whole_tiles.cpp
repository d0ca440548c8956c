#include "holotrace/wave/planes/whole_tiles.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

struct TileRange {
  int first, end;
};

// The tiles within pixels [from, to) along an axis of `size` pixels, of which the last tile may be cut. distance_of(pixel)
// is that of a tile's reference pixel from the wave's origin, and `reach` what it may be.
template <class Distance>
TileRange within(int from, int to, int size, int side, double reach, const Distance& distance_of) {
  TileRange tiles{(from + side - 1) / side, to >= size ? (size + side - 1) / side : to / side};
  const auto is_reached = [&](int tile) { return std::abs(distance_of(tile * side + side / 2)) <= reach; };
  while (tiles.first < tiles.end && !is_reached(tiles.first)) ++tiles.first;
  while (tiles.first < tiles.end && !is_reached(tiles.end - 1)) --tiles.end;
  return tiles;
}

// Calls take(box) for the boxes that are left around whole_tiles: four at most.
template <class Take>
void for_each_rest(const PreparedWave& wave, const PlaneTiles& t, const Take& take_any) {
  const auto take = [&](const PixelBox& box) {
    if (!box.is_empty()) take_any(box);
  };
  const PixelBox tiles = whole_tiles(wave, t), &all = wave.box;
  if (tiles.is_empty()) return take(all);
  const int x0 = t.bounds.x0 + tiles.x0 * t.side, x1 = std::min(t.bounds.x0 + tiles.x1 * t.side, t.bounds.x1);
  const int y0 = t.bounds.y0 + tiles.y0 * t.side, y1 = std::min(t.bounds.y0 + tiles.y1 * t.side, t.bounds.y1);
  take({all.x0, all.x1, all.y0, y0});
  take({all.x0, all.x1, y1, all.y1});
  take({all.x0, x0, y0, y1});
  take({x1, all.x1, y0, y1});
}

}  // namespace

PixelBox whole_tiles(const PreparedWave& wave, const PlaneTiles& t) {
  const PixelBox &box = wave.box, &bounds = t.bounds;
  const double reach = t.tangent * wave.depth;
  const TileRange x = within(box.x0 - bounds.x0, box.x1 - bounds.x0, bounds.x1 - bounds.x0, t.side, reach,
                             [&](int column) { return t.grid.x(bounds.x0 + column) - wave.x; });
  const TileRange y = within(box.y0 - bounds.y0, box.y1 - bounds.y0, bounds.y1 - bounds.y0, t.side, reach,
                             [&](int row) { return t.grid.y(bounds.y0 + row) - wave.y; });
  return {x.first, x.end, y.first, y.end};
}

void append_rest(const std::vector<PreparedWave>& some, const PlaneTiles& tiles, std::vector<PreparedWave>& waves) {
  constexpr size_t at_once = 4096;
  const size_t parts = (some.size() + at_once - 1) / at_once;
  // Boxes are counted first, so that the list is made once, in its place.
  std::vector<size_t> ends(parts + 1, 0);
  const auto for_each_wave = [&](const auto& work) {
    parallel_for(0, int64_t(parts), [&](int64_t part) {
      const size_t first = size_t(part) * at_once, end = std::min(first + at_once, some.size());
      for (size_t i = first; i < end; ++i) work(size_t(part), some[i]);
    });
  };
  for_each_wave([&](size_t part, const PreparedWave& wave) {
    for_each_rest(wave, tiles, [&](const PixelBox&) { ++ends[part + 1]; });
  });
  ends[0] = waves.size();
  for (size_t part = 0; part < parts; ++part) ends[part + 1] += ends[part];
  waves.reserve(ends[parts]);  // exactly: resize alone may take twice as much
  waves.resize(ends[parts]);
  for_each_wave([&](size_t part, const PreparedWave& wave) {
    for_each_rest(wave, tiles, [&](const PixelBox& box) {
      PreparedWave& rest = waves[ends[part]++];
      rest = wave;
      rest.box = box;
    });
  });
}

}  // namespace holotrace
