#include "holotrace/wave/planes/device_plane_tables.h"

#include <algorithm>
#include <cmath>

namespace holotrace {
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
