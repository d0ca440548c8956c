// Spreads the waves of a strip, whose lines are exact across it.

#include <algorithm>
#include <type_traits>

#include "holotrace/wave/planes/plane_spread.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/wave/planes/strip_spread.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/wave/planes/plane_batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

// Prepares the entries of a strip: w.of_strip, and their order by the first cell that they are spread over.
void prepare_strip(PreparedWaves waves, const Slab& slab, const PlanesTables& t, const TilePlace& tile,
                   const Strip& strip, PlanesWorkspace& w) {
  const std::vector<StripEntry>& entries = w.entries[strip.is_across_rows ? 1 : 0][strip.index];
  const double to_strip = (strip.index * strip_width + strip_width / 2 - t.plan.tile / 2) * t.pitch;
  Batch b;
  w.of_strip.reserve(most_entries);  // at once: growth alone may take twice as much
  w.of_strip.resize(entries.size());
  w.ends.assign(size_t(t.cells) + 1, 0);
  for (size_t at = 0; at < entries.size(); at += batch) {
    b.count = int(std::min<size_t>(batch, entries.size() - at));
    for (int k = 0; k < b.count; ++k) {
      const StripEntry& entry = entries[at + size_t(k)];
      const PreparedWave& wave = waves[entry.wave];
      hwy::Prefetch(&waves[entries[std::min(at + size_t(k) + ahead, entries.size() - 1)].wave]);
      const double x = tile.x - wave.x, y = wave.y - tile.y;
      b.x[k] = (strip.is_across_rows ? y : x) + to_strip;
      b.y[k] = strip.is_across_rows ? x : y;
      b.depth[k] = wave.depth;
      b.start[k] = wave.start_cycles;
      b.amplitude[k] = wave.amplitude * entry.sign;
    }
    prepare<true>(b, t, slab);
    for (int k = 0; k < b.count; ++k) {
      StripWave& wave = w.of_strip[at + size_t(k)];
      const StripEntry& entry = entries[at + size_t(k)];
      wave = {b.first[1][k],           b.fraction[1][k],        b.phase[k],  b.scale[k], b.twice_x[k],
              b.inverse_r0_squared[k], b.r0_over_wavelength[k], entry.first, entry.last, {}};
      for (int q = 0; q < t.plan.nodes; ++q) wave.weights[q] = b.weights[q][k];
      ++w.ends[size_t(wave.cell) + 1];
    }
  }
  for (size_t cell = 0; cell < size_t(t.cells); ++cell) w.ends[cell + 1] += w.ends[cell];
  w.order.reserve(most_entries);
  w.order.resize(entries.size());
  for (size_t i = 0; i < entries.size(); ++i) w.order[w.ends[size_t(w.of_strip[i].cell)]++] = uint32_t(i);
}

constexpr int strip_batch = 32;

// sums[row][2·strip_width] += Σ weights[wave][row]·lines[wave][2·strip_width], for `rows` of all rows.
template <int rows>
HWY_INLINE void add_lines(int count, const float* HWY_RESTRICT weights, size_t all_rows,
                          const float* HWY_RESTRICT lines, float* HWY_RESTRICT sums) {
  const hn::CappedTag<float, strip_width> d;
  constexpr size_t lanes = hn::MaxLanes(d), vectors = 2 * strip_width / lanes;
  hn::Vec<decltype(d)> sum[rows][vectors];
  for (size_t r = 0; r < rows; ++r)
    for (size_t v = 0; v < vectors; ++v) sum[r][v] = hn::Load(d, sums + r * 2 * strip_width + v * lanes);
  for (int k = 0; k < count; ++k, weights += all_rows, lines += 2 * strip_width)
    for (size_t r = 0; r < rows; ++r) {
      const auto weight = hn::Set(d, weights[r]);
      for (size_t v = 0; v < vectors; ++v) sum[r][v] = hn::MulAdd(weight, hn::Load(d, lines + v * lanes), sum[r][v]);
    }
  for (size_t r = 0; r < rows; ++r)
    for (size_t v = 0; v < vectors; ++v) hn::Store(sum[r][v], d, sums + r * 2 * strip_width + v * lanes);
}

// Waves that are spread over the same cells make a matrix product: weights of cells and nodes times lines of the strip.
template <int width>
void spread_over_cell(const uint32_t* order, int count, const PlanesTables& t, const KernelTable& table,
                      PlanesWorkspace& w, float* sums) {
  const hn::CappedTag<float, strip_width> d;
  constexpr size_t lanes = hn::MaxLanes(d);
  const hn::CappedTag<float, most_nodes> d8;
  const int nodes = t.plan.nodes, rows = width * nodes;
  const float pitch = float(t.pitch);
  HWY_ALIGN float lines[strip_batch][2 * strip_width], weights[strip_batch * width * most_nodes + most_nodes],
      of_cells[GriddingKernel::greatest_width];
  for (int k = 0; k < count; ++k) {
    const StripWave& wave = w.of_strip[order[k]];
    hwy::Prefetch(&w.of_strip[order[std::min(k + ahead / 2, count - 1)]]);
    kernel_weights<width>(table, wave.fraction, of_cells);
    // Each line writes most_nodes numbers, of which the next overwrites those beyond its nodes.
    for (int r = 0; r < width; ++r)
      for (size_t q = 0; q < most_nodes; q += hn::Lanes(d8))
        hn::StoreU(hn::Mul(hn::Set(d8, of_cells[r]), hn::LoadU(d8, wave.weights + q)), d8,
                   weights + k * rows + r * nodes + int(q));
    for (size_t v = 0; v < strip_width; v += lanes) {
      if (wave.last <= int(v) || wave.first >= int(v + lanes)) {
        hn::Store(hn::Zero(d), d, lines[k] + v);
        hn::Store(hn::Zero(d), d, lines[k] + strip_width + v);
        continue;
      }
      const auto line = hn::Add(hn::Iota(d, 0.0f), hn::Set(d, float(v)));
      const auto u = hn::Mul(hn::Sub(line, hn::Set(d, float(strip_width / 2))), hn::Set(d, pitch));
      const auto growing =
          hn::Mul(hn::Mul(u, hn::Add(u, hn::Set(d, wave.twice_x))), hn::Set(d, wave.inverse_r0_squared));
      hn::Vec<decltype(d)> beyond, modulus, re, im;
      growth<Series::long_series>(d, growing, beyond, modulus);
      cis_lanes(d, hn::MulAdd(beyond, hn::Set(d, wave.r0_over_wavelength), hn::Set(d, wave.phase)), re, im);
      const auto is_lit =
          hn::And(hn::Ge(line, hn::Set(d, float(wave.first))), hn::Lt(line, hn::Set(d, float(wave.last))));
      modulus = hn::IfThenElseZero(is_lit, hn::Mul(modulus, hn::Set(d, wave.scale)));
      hn::Store(hn::Mul(re, modulus), d, lines[k] + v);
      hn::Store(hn::Mul(im, modulus), d, lines[k] + strip_width + v);
    }
  }
  constexpr int at_once = 3;
  int row = 0;
  const auto add = [&]<int some>(std::integral_constant<int, some>) {
    add_lines<some>(count, weights + row, size_t(rows), lines[0], sums + size_t(row) * 2 * strip_width);
    row += some;
  };
  while (row + at_once <= rows) add(std::integral_constant<int, at_once>());
  while (row < rows) add(std::integral_constant<int, 1>());
}

void SpreadStrip(PreparedWaves waves, const Slab& slab, const PlanesTables& t, const TilePlace& tile,
                 const Strip& strip, PlanesWorkspace& w) {
  prepare_strip(waves, slab, t, tile, strip, w);
  const KernelTable table(t.kernel);
  const size_t step = 2 * strip_width * size_t(t.plan.nodes);
  size_t first = 0;
  for (size_t cell = 0; cell < size_t(t.cells); ++cell)
    for (const size_t end = w.ends[cell]; first < end;) {
      const int count = int(std::min<size_t>(strip_batch, end - first));
      call_with_width(t.plan.width, [&]<int width>(std::integral_constant<int, width>) {
        spread_over_cell<width>(w.order.data() + first, count, t, table, w, w.strip.data() + cell * step);
      });
      first += size_t(count);
    }
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(SpreadStrip);

void spread_strip(PreparedWaves waves, const Slab& slab, const PlanesTables& tables, const TilePlace& tile,
                  const Strip& strip, PlanesWorkspace& workspace) {
  HWY_DYNAMIC_DISPATCH(SpreadStrip)(waves, slab, tables, tile, strip, workspace);
}

}  // namespace holotrace
#endif
