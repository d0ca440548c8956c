#include <algorithm>
#include <cmath>

#include "holotrace/base/threads.h"
#include "holotrace/wave/planes/device_planes.h"

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

void append_rest(PreparedWaves some, const PlaneTiles& tiles, std::vector<PreparedWave>& waves) {
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

namespace {

// h²·c of a tile [m²], see linear_of_cubic.
double linear_part(const PlanesTables& t) {
  const double half = t.plan.tile * t.pitch / 2;
  return linear_of_cubic * half * half;
}

double curvature(const Slab& slab, const PlanesTables& t, int node) {
  return slab.centre + slab.half * t.nodes[size_t(node)];
}

template <class Place>
std::vector<FloatPair> references(int tiles, int side, double wavelength, const Place& place) {
  std::vector<FloatPair> places;
  for (int i = 0; i < tiles; ++i) places.push_back(float_pair(place(i * side + side / 2) / wavelength));
  return places;
}

}  // namespace

DeviceWave device_plane_wave(const PreparedWave& wave, double wavelength, const PlaneTiles& tiles) {
  DeviceWave w = device_wave(wave, wavelength, {});
  const PixelBox box = whole_tiles(wave, tiles);
  w.x0 = box.x0, w.x1 = box.x1, w.y0 = box.y0, w.y1 = box.y1;
  return w;
}

PlanePacket packet_of(const std::vector<DeviceWave>& waves, size_t first, size_t end) {
  const auto range = [&](auto place) {
    const auto [least, greatest] =
        std::minmax_element(waves.begin() + ptrdiff_t(first), waves.begin() + ptrdiff_t(end),
                            [&](const DeviceWave& a, const DeviceWave& b) { return place(a) < place(b); });
    return std::pair(place(*least), place(*greatest));
  };
  const auto [x0, x1] = range([](const DeviceWave& w) { return w.x.high; });
  const auto [y0, y1] = range([](const DeviceWave& w) { return w.y.high; });
  const auto [depth0, depth1] = range([](const DeviceWave& w) { return w.depth.high; });
  PlanePacket packet{x0, x1, y0, y1, depth0, depth1, int32_t(first), int32_t(end), 0, 0, 0, 0};
  bool is_lit = false;
  for (size_t i = first; i < end; ++i) {
    const DeviceWave& w = waves[i];
    if (w.x0 >= w.x1 || w.y0 >= w.y1) continue;
    packet.tiles_x0 = is_lit ? std::min(packet.tiles_x0, w.x0) : w.x0;
    packet.tiles_y0 = is_lit ? std::min(packet.tiles_y0, w.y0) : w.y0;
    packet.tiles_x1 = std::max(packet.tiles_x1, w.x1);
    packet.tiles_y1 = std::max(packet.tiles_y1, w.y1);
    is_lit = true;
  }
  return packet;
}

PlaneSlab slab_on_device(const Slab& slab, const PlanesTables& t) {
  const double square = t.wavelength * t.wavelength;
  PlaneSlab s{};
  s.cells = float(t.transform * t.pitch / t.wavelength);
  s.cubic = float(linear_part(t) / 2 / square);
  s.centre = float(slab.centre * square);
  s.per_half = float(1 / (slab.half * square));
  for (size_t q = 0; q < t.nodes.size(); ++q) {
    s.nodes[q] = float(t.nodes[q]);
    s.per_denominator[q] = 1 / t.denominators[q];
  }
  return s;
}

std::vector<std::complex<float>> frequency_factors(const PlanesTables& t) {
  const auto cells = size_t(t.cells);
  std::vector<std::complex<float>> factors(3 * cells);
  for (int c = 0; c < t.cells; ++c) {
    const double f = (c - PlanesTables::margin - t.transform / 2) / (t.transform * t.pitch);
    factors[size_t(c)] = float(f);
    factors[size_t(c) + cells] = float(f * f);
    factors[size_t(c) + 2 * cells] = float(-f * f);
  }
  return factors;
}

std::vector<std::complex<float>> all_chirps(const std::vector<Slab>& slabs, const PlanesTables& t) {
  std::vector<std::complex<float>> values;
  for (const Slab& slab : slabs)
    for (int q = 0; q < t.plan.nodes; ++q) {
      const std::vector<std::complex<float>> of_node = plane_chirp(t, curvature(slab, t, q));
      values.insert(values.end(), of_node.begin(), of_node.end());
    }
  return values;
}

std::vector<Correction<float>> all_corrections(const std::vector<Slab>& slabs, const PlanesTables& t) {
  std::vector<Correction<float>> values;
  for (const Slab& slab : slabs)
    for (int q = 0; q < t.plan.nodes; ++q)  // 1/r₀ ≈ λκ
      values.push_back(correction_for<float>(t.wavelength, t.wavelength * curvature(slab, t, q), linear_part(t)));
  return values;
}

std::vector<std::complex<float>> all_moments(const PlanesTables& t) {
  std::vector<std::complex<float>> moments;
  for (size_t i = 0; i < t.first.size(); ++i) moments.emplace_back(t.first[i], t.second[i]);
  return moments;
}

std::vector<float> all_coefficients(const PlanesTables& t) {
  std::vector<float> values;
  for (int power = 0; power <= GriddingKernel::degree; ++power)
    values.insert(values.end(), t.kernel.coefficients(power),
                  t.kernel.coefficients(power) + GriddingKernel::greatest_width);
  return values;
}

std::vector<FloatPair> column_references(const PlaneTiles& t, double wavelength) {
  return references(t.across(), t.side, wavelength, [&](int i) { return t.grid.x(t.bounds.x0 + i); });
}

std::vector<FloatPair> row_references(const PlaneTiles& t, double wavelength) {
  return references(t.down(), t.side, wavelength, [&](int j) { return t.grid.y(t.bounds.y0 + j); });
}

}  // namespace holotrace
