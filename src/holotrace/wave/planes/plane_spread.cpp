// Spreads waves over a tile's grid of frequencies: the hot loops of sum_planes.

#include "holotrace/wave/planes/plane_spread.h"

#include <algorithm>
#include <bit>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/wave/planes/plane_spread.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/wave/planes/plane_batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

// Weights of cells for vector v of a line, each repeated for the `floats` numbers of its cell.
template <int floats, class D>
HWY_INLINE hn::Vec<D> repeat(D d, const float* weights, size_t v) {
  constexpr size_t lanes = hn::MaxLanes(d), cells = lanes / floats;  // of a vector
  if constexpr (cells <= 1) {
    return hn::Set(d, weights[v * lanes / floats]);
#if HWY_TARGET != HWY_SCALAR  // which has no vectors of several cells
  } else if constexpr (lanes == 4) {
    const auto two = hn::LoadU(d, weights + v * cells);
    return hn::InterleaveLower(d, two, two);
  } else {
    alignas(64) int32_t of_lane[lanes];
    for (size_t i = 0; i < lanes; ++i) of_lane[i] = int32_t(v * cells + i / floats);
    const hn::CappedTag<float, GriddingKernel::greatest_width> d8;
    if constexpr (lanes == 8)
      return hn::TableLookupLanes(hn::Load(d, weights), hn::SetTableIndices(d, of_lane));
    else
      return hn::TableLookupLanes(hn::ZeroExtendVector(d, hn::Load(d8, weights)), hn::SetTableIndices(d, of_lane));
#endif
  }
}

// Spreads the waves of a batch over the grids. A cell has `floats` numbers, the complex ones of all nodes, so a line of the
// kernel is one run of vectors: lines times columns of weights, each times the wave's value.
template <int width, int floats>
void spread_batch(const Batch& b, const PlanesTables& t, const KernelTable& table, float* HWY_RESTRICT grids) {
  constexpr int line_floats = width * floats;
  const hn::CappedTag<float, std::min(16, int(std::bit_ceil(unsigned(line_floats))))> d;
  constexpr size_t lanes = hn::MaxLanes(d), vectors = (line_floats + lanes - 1) / lanes;
  const size_t step = size_t(floats) * size_t(t.stride());
  HWY_ALIGN float x_weights[GriddingKernel::greatest_width + 4] = {}, y_weights[GriddingKernel::greatest_width] = {};
  for (int k = 0; k < b.count; ++k) {
    kernel_weights<width>(table, b.fraction[0][k], x_weights);
    kernel_weights<width>(table, b.fraction[1][k], y_weights);
    hn::Vec<decltype(d)> line[vectors];
    for (size_t v = 0; v < vectors; ++v)
      line[v] = hn::Mul(repeat<floats>(d, x_weights, v), hn::Load(d, b.value[k] + v * lanes % floats));
    float* to = grids + size_t(b.first[1][k]) * step + size_t(floats) * size_t(b.first[0][k]);
    for (int r = 0; r < width; ++r, to += step) {
      const auto w = hn::Set(d, y_weights[r]);
      for (size_t v = 0; v < vectors; ++v)
        hn::StoreU(hn::MulAdd(w, line[v], hn::LoadU(d, to + v * lanes)), d, to + v * lanes);
    }
  }
}

void spread_batch(const Batch& b, const PlanesTables& t, const KernelTable& table, float* grids) {
  call_with_width(t.plan.width, [&]<int width>(std::integral_constant<int, width>) {
    switch (t.slots()) {
      case 1:
        return spread_batch<width, 2>(b, t, table, grids);
      case 2:
        return spread_batch<width, 4>(b, t, table, grids);
      case 4:
        return spread_batch<width, 8>(b, t, table, grids);
      default:
        return spread_batch<width, 16>(b, t, table, grids);
    }
  });
}

// Adds entries for the lines [first, last) along a tile's axis, strip by strip.
void add_entries(std::vector<StripEntry>* strips, uint32_t wave, int first, int last, int sign) {
  if (first >= last) return;
  for (int s = first / strip_width; s * strip_width < last; ++s) {
    const int start = s * strip_width;
    strips[s].push_back(
        {wave, int8_t(std::max(first - start, 0)), int8_t(std::min(last - start, strip_width)), int8_t(sign)});
  }
}

// Sorts a wave that lights the lines [first, last) of `size` along one axis and all lines along the other. Returns
// whether it is spread over the whole tile; strips then subtract it from unlit lines. Otherwise strips add it.
bool sort_partly_lit(std::vector<StripEntry>* strips, uint32_t wave, int first, int last, int size, bool may_spread) {
  if (!may_spread || 2 * (last - first) <= size) {
    add_entries(strips, wave, first, last, 1);
    return false;
  }
  add_entries(strips, wave, 0, first, -1);
  add_entries(strips, wave, last, size, -1);
  return true;
}

// Whether the wave is spread over the whole tile. Only waves that reach the reference pixel within the panel's
// acceptance have their frequency on the grid. Others (a few, if a tile extends past the panel) are summed directly.
bool sort(const PreparedWave& wave, uint32_t index, const TilePlace& tile, const PlanesTables& t, PlanesWorkspace& w) {
  const PixelBox& box = tile.box;
  const double x = tile.x - wave.x, y = wave.y - tile.y;
  const PixelBox lit = intersect(wave.box, box);
  const bool all_x = lit.x0 == box.x0 && lit.x1 == box.x1, all_y = lit.y0 == box.y0 && lit.y1 == box.y1;
  const bool x_reaches = std::abs(x) <= t.tangent * wave.depth, y_reaches = std::abs(y) <= t.tangent * wave.depth;
  if (all_x && all_y && x_reaches && y_reaches) return true;
  if (t.plan.has_strips && all_y && y_reaches)
    return sort_partly_lit(w.entries[0], index, lit.x0 - box.x0, lit.x1 - box.x0, box.x1 - box.x0, x_reaches);
  if (t.plan.has_strips && all_x && x_reaches)
    return sort_partly_lit(w.entries[1], index, lit.y0 - box.y0, lit.y1 - box.y0, box.y1 - box.y0, y_reaches);
  w.direct.push_back(wave);
  w.direct.back().box = lit;
  return false;
}

// Whether the packet's waves all light the whole tile, and reach its reference pixel within the panel's acceptance.
bool lights_whole_tile(const WavePacket& p, const TilePlace& tile, const PlanesTables& t) {
  const PixelBox &lit = p.lit_by_all, &box = tile.box;
  const double reach = t.tangent * p.nearest;
  return lit.x0 <= box.x0 && lit.x1 >= box.x1 && lit.y0 <= box.y0 && lit.y1 >= box.y1 && tile.x - p.x0 <= reach &&
         p.x1 - tile.x <= reach && p.y1 - tile.y <= reach && tile.y - p.y0 <= reach;
}

bool SpreadWaves(PreparedWaves waves, const Slab& slab, const PlanesTables& t, const TilePlace& tile, size_t& next,
                 PlanesWorkspace& w) {
  const KernelTable table(t.kernel);
  Batch b;
  bool any = false;
  const auto flush = [&] {
    prepare<false>(b, t, slab);
    spread_batch(b, t, table, w.grids.data());
    b.count = 0;
  };
  while (next < slab.packets.size()) {
    const WavePacket& packet = slab.packets[next++];
    if (intersect(packet.lit_by_any, tile.box).is_empty()) continue;
    const bool all = lights_whole_tile(packet, tile, t);
    for (size_t i = packet.first; i < packet.last; ++i) {
      const PreparedWave& wave = waves[i];
      hwy::Prefetch(&wave + ahead);
      if (!all && (intersect(wave.box, tile.box).is_empty() || !sort(wave, uint32_t(i), tile, t, w))) continue;
      const int k = b.count++;
      b.x[k] = tile.x - wave.x;
      b.y[k] = wave.y - tile.y;  // y axis points down
      b.depth[k] = wave.depth;
      b.start[k] = wave.start_cycles;
      b.amplitude[k] = wave.amplitude;
      if (b.count < batch) continue;
      any = true;
      flush();
    }
    if (!all && w.is_full()) break;
  }
  any = any || b.count > 0;
  flush();
  return any;
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(SpreadWaves);

bool spread_waves(PreparedWaves waves, const Slab& slab, const PlanesTables& tables, const TilePlace& tile,
                  size_t& packet, PlanesWorkspace& workspace) {
  return HWY_DYNAMIC_DISPATCH(SpreadWaves)(waves, slab, tables, tile, packet, workspace);
}

}  // namespace holotrace
#endif
