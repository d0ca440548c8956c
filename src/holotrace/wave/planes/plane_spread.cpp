// Spreads waves over a tile's grid of frequencies: the hot loops of sum_planes.

#include "holotrace/wave/planes/plane_spread.h"

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
constexpr int most_nodes = 16;

// The waves of a batch in one tile. Axis 0 runs along columns, axis 1 down along rows. (x, y) is the tile's reference
// pixel as seen from the wave's origin. Derived values: on each axis the first cell of the kernel and the fraction of a
// cell; the wave's amplitude and phase at the reference pixel; its distance there; and the weights of the
// nodes.
struct Batch {
  int count = 0;
  alignas(64) double x[batch], y[batch], depth[batch], start[batch], amplitude[batch];
  alignas(64) float cell[2][batch], re[batch], im[batch], phase[batch], scale[batch], inverse_r0_squared[batch],
      r0_over_wavelength[batch], twice_x[batch];
  alignas(64) float weights[most_nodes][batch];
};

void pad(Batch& b) {
  for (int k = b.count; k % 16 != 0; ++k) {
    b.x[k] = b.y[k] = b.start[k] = b.amplitude[k] = 0;
    b.depth[k] = 1;
  }
}

// Computes frequencies in cells (less the linear part of the cubic phase) and curvatures as weights of the nodes.
// In a strip (is_strip) the curvature is that along axis 1, and axis 0 is not gridded.
template <bool is_strip>
void prepare(Batch& b, const PlanesTables& t, const Slab& slab) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> df;
  const hn::ScalableTag<float> f;
  pad(b);
  const int count = (b.count + 15) / 16 * 16;
  alignas(64) float tau[batch];
  const double half = t.plan.tile * t.pitch / 2, cells = t.transform * t.pitch / t.wavelength;
  const double cubic = (is_strip ? linear_of_cube : linear_of_cubic) * half * half / 2;
  const auto one = hn::Set(d, 1.0), per_wavelength = hn::Set(d, 1 / t.wavelength);
  for (int k = 0; k < count; k += int(hn::Lanes(d))) {
    const auto x = hn::Load(d, b.x + k), y = hn::Load(d, b.y + k), depth = hn::Load(d, b.depth + k);
    const auto x2 = hn::Mul(x, x), y2 = hn::Mul(y, y), rho2 = hn::Add(x2, y2);
    const auto r0 = hn::Sqrt(hn::MulAdd(depth, depth, rho2));
    const auto inverse = hn::Div(one, r0), inverse2 = hn::Mul(inverse, inverse);
    const auto cycles = hn::MulAdd(hn::Div(rho2, hn::Add(r0, depth)), per_wavelength, hn::Load(d, b.start + k));
    const auto per_cell = hn::Mul(hn::Mul(hn::Set(d, cells), inverse), hn::NegMulAdd(hn::Set(d, cubic), inverse2, one));
    const auto bent = is_strip ? y2 : hn::Mul(hn::Set(d, 0.5), rho2);
    const auto kappa = hn::Mul(hn::Mul(per_wavelength, inverse), hn::NegMulAdd(bent, inverse2, one));
    const auto store = [&](auto v, float* to) { hn::Store(hn::DemoteTo(df, v), df, to + k); };
    store(hn::Mul(x, per_cell), b.cell[0]);
    store(hn::Mul(y, per_cell), b.cell[1]);
    store(hn::Mul(hn::Sub(kappa, hn::Set(d, slab.centre)), hn::Set(d, 1 / slab.half)), tau);
    store(hn::Sub(cycles, hn::Floor(cycles)), b.phase);
    store(hn::Mul(hn::Mul(hn::Load(d, b.amplitude + k), depth), inverse), b.scale);
    if (is_strip) {
      store(hn::Add(x, x), b.twice_x);
      store(inverse2, b.inverse_r0_squared);
      store(hn::Mul(r0, per_wavelength), b.r0_over_wavelength);
    }
  }
  const int nodes = t.plan.nodes;
  for (int k = 0; k < count; k += int(hn::Lanes(f))) {
    const auto at = hn::Load(f, tau + k);
    for (int q = 0; q < nodes; ++q) {  // Lagrange polynomials
      auto product = hn::Set(f, 1 / t.denominators[size_t(q)]);
      for (int m = 0; m < nodes; ++m)
        if (m != q) product = hn::Mul(product, hn::Sub(at, hn::Set(f, float(t.nodes[size_t(m)]))));
      hn::Store(product, f, b.weights[q] + k);
    }
    if (is_strip) continue;
    hn::Vec<decltype(f)> re, im;
    cis_lanes(f, hn::Load(f, b.phase + k), re, im);
    const auto scale = hn::Load(f, b.scale + k);
    hn::Store(hn::Mul(re, scale), f, b.re + k);
    hn::Store(hn::Mul(im, scale), f, b.im + k);
  }
}

// The first cell that a wave is spread over, counted from the grid's first cell.
HWY_INLINE void first_cell(float cell, const PlanesTables& t, int& first, float& fraction) {
  const float start = cell - 0.5f * float(t.plan.width);
  const float up = std::ceil(start);
  fraction = up - start - 0.5f;
  first = int(up) + t.transform / 2 + PlanesTables::margin;
}

// Kernel weights of the cells along one axis, in the layout of the table: each once, or twice for a complex grid.
template <int floats>
HWY_INLINE void kernel_weights(const float* table, float fraction, float* weights) {
  const hn::CappedTag<float, floats> d;
  const auto t = hn::Set(d, fraction);
  for (size_t i = 0; i < floats; i += hn::Lanes(d)) {
    auto w = hn::Load(d, table + size_t(GriddingKernel::degree) * 16 + i);
    for (int k = GriddingKernel::degree - 1; k >= 0; --k) w = hn::MulAdd(w, t, hn::Load(d, table + size_t(k) * 16 + i));
    hn::Store(w, d, weights + i);
  }
}

// Coefficients [power][16], each cell's once or twice.
template <int copies>
void fill_table(const GriddingKernel& kernel, float* table) {
  for (int k = 0; k <= GriddingKernel::degree; ++k)
    for (int i = 0; i < 16; ++i) {
      const int cell = i / copies;
      table[k * 16 + i] = cell < GriddingKernel::greatest_width ? kernel.coefficients(k)[cell] : 0.0f;
    }
}

// Spreads a wave; `floats` is the number of floats in a line of a complex kernel of up to 4 or 8 cells.
template <int floats>
HWY_INLINE void spread(const Batch& b, int k, const PlanesTables& t, const float* x_table, const float* y_table, int x,
                       int y, float x_fraction, float y_fraction, float* HWY_RESTRICT grids) {
  const hn::CappedTag<float, floats> d;
  constexpr size_t lanes = hn::MaxLanes(d), vectors = floats / lanes;
  HWY_ALIGN float x_weights[floats], y_weights[floats] = {}, amplitude[floats];
  kernel_weights<floats>(x_table, x_fraction, x_weights);
  kernel_weights<floats / 2>(y_table, y_fraction, y_weights);
  for (int i = 0; i < floats; i += 2) amplitude[i] = b.re[k], amplitude[i + 1] = b.im[k];
  hn::Vec<decltype(d)> line[vectors];
  for (size_t v = 0; v < vectors; ++v)
    line[v] = hn::Mul(hn::Load(d, x_weights + v * lanes), hn::Load(d, amplitude + v * lanes));
  const size_t step = 2 * size_t(t.stride());
  float* start = grids + size_t(y) * step + 2 * size_t(x);
  for (int q = 0; q < t.plan.nodes; ++q, start += size_t(t.cells) * step) {
    const auto weight = hn::Set(d, b.weights[q][k]);
    hn::Vec<decltype(d)> of_plane[vectors];
    for (size_t v = 0; v < vectors; ++v) of_plane[v] = hn::Mul(line[v], weight);
    float* to = start;
    for (int r = 0; r < t.plan.width; ++r, to += step) {
      const auto w = hn::Set(d, y_weights[r]);
      for (size_t v = 0; v < vectors; ++v)
        hn::StoreU(hn::MulAdd(w, of_plane[v], hn::LoadU(d, to + v * lanes)), d, to + v * lanes);
    }
  }
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

template <int floats>
void spread_batch(Batch& b, const Slab& slab, const PlanesTables& t, const float* x_table, const float* y_table,
                  float* grids) {
  prepare<false>(b, t, slab);
  for (int k = 0; k < b.count; ++k) {
    int x, y;
    float x_fraction, y_fraction;
    first_cell(b.cell[0][k], t, x, x_fraction);
    first_cell(b.cell[1][k], t, y, y_fraction);
    spread<floats>(b, k, t, x_table, y_table, x, y, x_fraction, y_fraction, grids);
  }
  b.count = 0;
}

bool SpreadWaves(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& t, const TilePlace& tile,
                 PlanesWorkspace& w) {
  HWY_ALIGN float x_table[(GriddingKernel::degree + 1) * 16], y_table[(GriddingKernel::degree + 1) * 16];
  fill_table<2>(t.kernel, x_table);
  fill_table<1>(t.kernel, y_table);
  Batch b;
  bool any = false;
  const auto flush = [&] {
    if (t.plan.width <= 4)
      spread_batch<8>(b, slab, t, x_table, y_table, w.grids.data());
    else
      spread_batch<16>(b, slab, t, x_table, y_table, w.grids.data());
  };
  for (size_t i = slab.first; i < slab.last; ++i) {
    const PreparedWave& wave = waves[i];
    hwy::Prefetch(&wave + 24);  // fetches boxes ahead of their use
    if (intersect(wave.box, tile.box).is_empty()) continue;
    if (!sort(wave, uint32_t(i), tile, t, w)) continue;
    any = true;
    const int k = b.count++;
    b.x[k] = tile.x - wave.x;
    b.y[k] = wave.y - tile.y;  // y axis points down
    b.depth[k] = wave.depth;
    b.start[k] = wave.start_cycles;
    b.amplitude[k] = wave.amplitude;
    if (b.count == batch) flush();
  }
  flush();
  return any;
}

void SpreadStrip(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& t, const TilePlace& tile,
                 const Strip& strip, PlanesWorkspace& w) {
  const auto [is_across_rows, index] = strip;
  const std::vector<StripEntry>& entries = w.entries[is_across_rows ? 1 : 0][index];
  const hn::CappedTag<float, strip_width> d;
  constexpr size_t lanes = hn::MaxLanes(d), vectors = strip_width / lanes;
  HWY_ALIGN float table[(GriddingKernel::degree + 1) * 16], weights[16], offsets[16], lines[16];
  fill_table<1>(t.kernel, table);
  for (int i = 0; i < strip_width; ++i) offsets[i] = float((i - strip_width / 2) * t.pitch), lines[i] = float(i);
  const double to_strip = (index * strip_width + strip_width / 2 - t.plan.tile / 2) * t.pitch;
  const size_t step = 2 * strip_width, node = size_t(t.cells) * step;
  Batch b;
  for (size_t at = 0; at < entries.size(); at += batch) {
    b.count = int(std::min<size_t>(batch, entries.size() - at));
    for (int k = 0; k < b.count; ++k) {
      const StripEntry& entry = entries[at + size_t(k)];
      const PreparedWave& wave = waves[entry.wave];
      const double x = tile.x - wave.x, y = wave.y - tile.y;
      b.x[k] = (is_across_rows ? y : x) + to_strip;
      b.y[k] = is_across_rows ? x : y;
      b.depth[k] = wave.depth;
      b.start[k] = wave.start_cycles;
      b.amplitude[k] = wave.amplitude * entry.sign;
    }
    prepare<true>(b, t, slab);
    for (int k = 0; k < b.count; ++k) {
      const StripEntry& entry = entries[at + size_t(k)];
      int first;
      float fraction;
      first_cell(b.cell[1][k], t, first, fraction);
      kernel_weights<8>(table, fraction, weights);
      hn::Vec<decltype(d)> re[vectors], im[vectors];
      for (size_t v = 0; v < vectors; ++v) {
        const auto u = hn::Load(d, offsets + v * lanes), line = hn::Load(d, lines + v * lanes);
        const auto growing =
            hn::Mul(hn::Mul(u, hn::Add(u, hn::Set(d, b.twice_x[k]))), hn::Set(d, b.inverse_r0_squared[k]));
        hn::Vec<decltype(d)> beyond, modulus;
        growth<Series::long_series>(d, growing, beyond, modulus);
        cis_lanes(d, hn::MulAdd(beyond, hn::Set(d, b.r0_over_wavelength[k]), hn::Set(d, b.phase[k])), re[v], im[v]);
        const auto is_lit =
            hn::And(hn::Ge(line, hn::Set(d, float(entry.first))), hn::Lt(line, hn::Set(d, float(entry.last))));
        modulus = hn::IfThenElseZero(is_lit, hn::Mul(modulus, hn::Set(d, b.scale[k])));
        re[v] = hn::Mul(re[v], modulus);
        im[v] = hn::Mul(im[v], modulus);
      }
      float* const start = w.strip.data() + size_t(first) * step;
      for (int q = 0; q < t.plan.nodes; ++q)
        for (int r = 0; r < t.plan.width; ++r) {
          const auto weight = hn::Set(d, weights[r] * b.weights[q][k]);
          float* const to = start + size_t(q) * node + size_t(r) * step;
          for (size_t v = 0; v < vectors; ++v) {
            float* const to_re = to + v * lanes;
            float* const to_im = to_re + strip_width;
            hn::Store(hn::MulAdd(weight, re[v], hn::Load(d, to_re)), d, to_re);
            hn::Store(hn::MulAdd(weight, im[v], hn::Load(d, to_im)), d, to_im);
          }
        }
    }
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
                  const TilePlace& tile, PlanesWorkspace& workspace) {
  return HWY_DYNAMIC_DISPATCH(SpreadWaves)(waves, slab, tables, tile, workspace);
}

void spread_strip(const std::vector<PreparedWave>& waves, const Slab& slab, const PlanesTables& tables,
                  const TilePlace& tile, const Strip& strip, PlanesWorkspace& workspace) {
  HWY_DYNAMIC_DISPATCH(SpreadStrip)(waves, slab, tables, tile, strip, workspace);
}

}  // namespace holotrace
#endif
