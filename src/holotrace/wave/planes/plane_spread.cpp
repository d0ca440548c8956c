// Spreads waves over a tile's grid of frequencies: the hot loops of sum_planes.

#include "holotrace/wave/planes/plane_spread.h"

#include <algorithm>
#include <bit>
#include <type_traits>

#include "holotrace/wave/planes/plane_correction_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/wave/planes/plane_spread.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/wave/shared/wave_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace {
namespace HWY_NAMESPACE {
namespace {

constexpr int batch = 64;
constexpr int ahead = 24;  // waves are fetched that much before they are used
constexpr int most_nodes = 8, most_floats = 2 * most_nodes;

// The waves of a batch in one tile. Axis 0 runs along columns, axis 1 down along rows. (x, y) is the tile's reference
// pixel as seen from the wave's origin. Derived values: on each axis the first cell of the kernel and the fraction of a
// cell; the wave's amplitude and phase at the reference pixel; its distance there; and the weights of the
// nodes. `value` is the wave's value times those weights, as a cell has them, repeated to fill a vector.
struct Batch {
  int count = 0;
  alignas(64) double x[batch], y[batch], depth[batch], start[batch], amplitude[batch];
  alignas(64) int32_t first[2][batch];
  alignas(64) float fraction[2][batch], phase[batch], scale[batch], inverse_r0_squared[batch],
      r0_over_wavelength[batch], twice_x[batch];
  alignas(64) float weights[most_nodes][batch];
  alignas(64) float value[batch][most_floats];
};

void pad(Batch& b) {
  for (int k = b.count; k % 16 != 0; ++k) {
    b.x[k] = b.y[k] = b.start[k] = b.amplitude[k] = 0;
    b.depth[k] = 1;
  }
}

// b.value of the waves from k on, as many as a vector has lanes.
void store_values(Batch& b, const PlanesTables& t, int k) {
  const hn::ScalableTag<float> f;
  constexpr size_t lanes = hn::MaxLanes(f);
  const int slots = t.slots(), floats = 2 * slots;
  hn::Vec<decltype(f)> re, im;
  cis_lanes(f, hn::Load(f, b.phase + k), re, im);
  const auto scale = hn::Load(f, b.scale + k);
  re = hn::Mul(re, scale);
  im = hn::Mul(im, scale);
  HWY_ALIGN float together[4 * lanes];
  const auto weight = [&](int q) { return q < t.plan.nodes ? hn::Load(f, b.weights[q] + k) : hn::Zero(f); };
  const auto copy = [&]<int count>(std::integral_constant<int, count>, int to) {
    for (size_t i = 0; i < hn::Lanes(f); ++i)
      for (int at = to; at < most_floats; at += floats)
        std::copy_n(together + i * count, count, b.value[size_t(k) + i] + at);
  };
  if (slots == 1) {
    hn::StoreInterleaved2(hn::Mul(re, weight(0)), hn::Mul(im, weight(0)), f, together);
    return copy(std::integral_constant<int, 2>(), 0);
  }
  for (int q = 0; q < slots; q += 2) {
    const auto a = weight(q), c = weight(q + 1);
    hn::StoreInterleaved4(hn::Mul(re, a), hn::Mul(im, a), hn::Mul(re, c), hn::Mul(im, c), f, together);
    copy(std::integral_constant<int, 4>(), 2 * q);
  }
}

// Computes frequencies in cells (less the linear part of the cubic phase) and curvatures as weights of the nodes.
// In a strip (is_strip) the curvature is that along axis 1, and axis 0 is not gridded. Distances and phases need doubles;
// the rest is a number of cells or a share of one, for which floats do.
template <bool is_strip>
void prepare(Batch& b, const PlanesTables& t, const Slab& slab) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> df;
  const hn::ScalableTag<float> f;
  const hn::RebindToSigned<decltype(f)> whole;
  pad(b);
  const int count = (b.count + 15) / 16 * 16, nodes = t.plan.nodes;
  alignas(64) float x_of[batch], y_of[batch], depth_of[batch], r0_of[batch];
  const auto per_wavelength = hn::Set(d, 1 / t.wavelength);
  for (int k = 0; k < count; k += int(hn::Lanes(d))) {
    const auto x = hn::Load(d, b.x + k), y = hn::Load(d, b.y + k), depth = hn::Load(d, b.depth + k);
    const auto rho2 = hn::MulAdd(y, y, hn::Mul(x, x)), r0 = hn::Sqrt(hn::MulAdd(depth, depth, rho2));
    const auto beyond = hn::Div(rho2, hn::Add(r0, depth));  // r₀ − depth, also where these are nearly equal
    const auto cycles = hn::MulAdd(beyond, per_wavelength, hn::Load(d, b.start + k));
    const auto store = [&](auto v, float* to) { hn::Store(hn::DemoteTo(df, v), df, to + k); };
    store(x, x_of);
    store(y, y_of);
    store(depth, depth_of);
    store(r0, r0_of);
    store(hn::Load(d, b.amplitude + k), b.scale);
    store(hn::Sub(cycles, hn::Floor(cycles)), b.phase);
  }
  const double half = t.plan.tile * t.pitch / 2;
  const auto set = [&](double value) { return hn::Set(f, float(value)); };
  const auto one = set(1), cells = set(t.transform * t.pitch / t.wavelength),
             cubic = set((is_strip ? linear_of_cube : linear_of_cubic) * half * half / 2),
             per_length = set(1 / (t.wavelength * slab.half)), centre = set(slab.centre / slab.half),
             half_width = set(0.5 * t.plan.width), half_cell = set(0.5);
  const auto middle = hn::Set(whole, t.transform / 2 + PlanesTables::margin);
  for (int k = 0; k < count; k += int(hn::Lanes(f))) {
    const auto x = hn::Load(f, x_of + k), y = hn::Load(f, y_of + k), r0 = hn::Load(f, r0_of + k);
    const auto inverse = hn::Div(one, r0), inverse2 = hn::Mul(inverse, inverse), y2 = hn::Mul(y, y);
    const auto scale = hn::Mul(hn::Mul(hn::Load(f, b.scale + k), hn::Load(f, depth_of + k)), inverse);
    hn::Store(scale, f, b.scale + k);
    const auto per_cell = hn::Mul(hn::Mul(cells, inverse), hn::NegMulAdd(cubic, inverse2, one));
    for (int axis = is_strip ? 1 : 0; axis < 2; ++axis) {
      const auto start = hn::MulSub(axis == 0 ? x : y, per_cell, half_width), up = hn::Ceil(start);
      hn::Store(hn::Sub(hn::Sub(up, start), half_cell), f, b.fraction[axis] + k);
      hn::Store(hn::Add(hn::ConvertTo(whole, up), middle), whole, b.first[axis] + k);
    }
    const auto bent = is_strip ? y2 : hn::Mul(half_cell, hn::MulAdd(x, x, y2));
    const auto curvature = hn::Mul(hn::NegMulAdd(bent, inverse2, one), inverse);
    const auto tau = hn::MulSub(per_length, curvature, centre);
    for (int q = 0; q < nodes; ++q) {  // Lagrange polynomials
      auto product = hn::Set(f, 1 / t.denominators[size_t(q)]);
      for (int m = 0; m < nodes; ++m)
        if (m != q) product = hn::Mul(product, hn::Sub(tau, hn::Set(f, float(t.nodes[size_t(m)]))));
      hn::Store(product, f, b.weights[q] + k);
    }
    if (is_strip) {
      hn::Store(hn::Add(x, x), f, b.twice_x + k);
      hn::Store(inverse2, f, b.inverse_r0_squared + k);
      hn::Store(hn::Mul(r0, set(1 / t.wavelength)), f, b.r0_over_wavelength + k);
    } else {
      store_values(b, t, k);
    }
  }
}

// The polynomials of the kernel, [power][cell], aligned.
struct KernelTable {
  alignas(64) float coefficients[(GriddingKernel::degree + 1) * GriddingKernel::greatest_width];

  explicit KernelTable(const GriddingKernel& kernel) {
    std::copy_n(kernel.coefficients(0), std::size(coefficients), coefficients);
  }
};

// Kernel weights of the cells along one axis.
template <int width>
HWY_INLINE void kernel_weights(const KernelTable& table, float fraction, float* weights) {
  constexpr int cells = GriddingKernel::greatest_width, degree = GriddingKernel::degree_of(width);
  const hn::CappedTag<float, cells> d;
  const auto t = hn::Set(d, fraction);
  for (size_t i = 0; i < size_t(width); i += hn::Lanes(d)) {
    const float* const from = table.coefficients + i;
    auto w = hn::Load(d, from + degree * cells);
    for (int k = degree - 1; k >= 0; --k) w = hn::MulAdd(w, t, hn::Load(d, from + k * cells));
    hn::Store(w, d, weights + i);
  }
}

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

// Calls `work` with the width of the kernel, 4 or more, as a compile-time constant: narrower kernels have weights of 0.
template <class Work>
void call_with_width(int width, const Work& work) {
  switch (width) {
    case 5:
      return work(std::integral_constant<int, 5>());
    case 6:
      return work(std::integral_constant<int, 6>());
    case 7:
      return work(std::integral_constant<int, 7>());
    case 8:
      return work(std::integral_constant<int, 8>());
    default:
      return work(std::integral_constant<int, 4>());
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

bool SpreadWaves(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& t, const TilePlace& tile,
                 size_t& next, PlanesWorkspace& w) {
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

// Prepares the entries of a strip: w.of_strip, and their order by the first cell that they are spread over.
void prepare_strip(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& t,
                   const TilePlace& tile, const Strip& strip, PlanesWorkspace& w) {
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

void SpreadStrip(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& t, const TilePlace& tile,
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
}  // namespace HWY_NAMESPACE
}  // namespace holotrace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(SpreadWaves);
HWY_EXPORT(SpreadStrip);

bool spread_waves(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& tables,
                  const TilePlace& tile, size_t& packet, PlanesWorkspace& workspace) {
  return HWY_DYNAMIC_DISPATCH(SpreadWaves)(waves, slab, tables, tile, packet, workspace);
}

void spread_strip(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& tables,
                  const TilePlace& tile, const Strip& strip, PlanesWorkspace& workspace) {
  HWY_DYNAMIC_DISPATCH(SpreadStrip)(waves, slab, tables, tile, strip, workspace);
}

}  // namespace holotrace
#endif
