// A tile is a complex matrix product: samples[row][column] += Σⱼ row factorⱼ[row] · column factorⱼ[column].
//
// A complex product (a + ib)(c + id) takes three real ones: ac, bd and (a + b)(c + d); its real part is ac − bd, its
// imaginary part (a + b)(c + d) − ac − bd. As the sum over waves goes through, three real matrix products make the
// tile, a quarter less work than the four of the schoolbook. Waves are taken in batches, whose factors are computed
// into panels that the products stream.

#include "holotrace/wave/tile_sum.h"

#include "holotrace/wave/packed_product.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/wave/tile_sum.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/wave/sum_tiled.h"
#include "holotrace/wave/wave_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace {
namespace HWY_NAMESPACE {
namespace {

using Floats = hn::ScalableTag<float>;
using V = hn::Vec<Floats>;
using Words = hn::RebindToUnsigned<Floats>;

constexpr int planes = 3;          // a, b and a + b of a factor a + ib
constexpr int batch = 128;         // waves whose factors are held at once for products in single precision
constexpr int packed_batch = 256;  // and for packed ones
constexpr int pairs = packed_batch / 2;

// What the factors of a batch's waves in one tile need. The tile's centre lies at (x, y) from a wave's origin, at the
// distance r₀.
struct Batch {
  int count = 0;
  bool has_row_edges = false;  // a wave ends between two rows of the tile
  alignas(64) double x[packed_batch], y[packed_batch], depth[packed_batch], start[packed_batch],
      amplitude[packed_batch];
  alignas(64) float twice_x[packed_batch], twice_y[packed_batch], inverse_r0_squared[packed_batch],
      r0_over_wavelength[packed_batch], phase[packed_batch], scale[packed_batch], greatest_t[packed_batch];
  alignas(64) float first_row[packed_batch], last_row[packed_batch];
  int first_column[packed_batch], last_column[packed_batch];
};

void add_wave(Batch& b, const PreparedWave& wave, double x_centre, double y_centre, const PixelBox& box, int rows) {
  const int k = b.count++;
  b.x[k] = x_centre - wave.x;
  b.y[k] = y_centre - wave.y;
  b.depth[k] = wave.depth;
  b.start[k] = wave.start_cycles;
  b.amplitude[k] = wave.amplitude;
  b.first_column[k] = wave.box.x0 - box.x0;
  b.last_column[k] = wave.box.x1 - box.x0;
  b.first_row[k] = float(wave.box.y0 - box.y0);
  b.last_row[k] = float(wave.box.y1 - box.y0);
  if (wave.box.y0 > box.y0 || wave.box.y1 < box.y0 + rows) b.has_row_edges = true;
}

// Waves of amplitude 0 up to a whole number of vectors, or of pairs of vectors for packed products.
void pad(Batch& b) {
  for (int k = b.count; k % 32 != 0; ++k) {
    b.x[k] = b.y[k] = b.start[k] = b.amplitude[k] = 0;
    b.depth[k] = 1;
    b.first_column[k] = b.last_column[k] = 0;
    b.first_row[k] = b.last_row[k] = 0;
  }
}

int padded(int count) { return (count + 31) / 32 * 32; }

// Distances in double: r₀ is up to 10⁶ waves long. half_x, half_y: from the tile's centre to its edges.
void prepare(Batch& b, double wavelength, double half_x, double half_y) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> df;
  const auto one = hn::Set(d, 1.0), per_wavelength = hn::Set(d, 1 / wavelength);
  for (int k = 0; k < padded(b.count); k += int(hn::Lanes(d))) {
    const auto x = hn::Load(d, b.x + k), y = hn::Load(d, b.y + k), depth = hn::Load(d, b.depth + k);
    const auto rho2 = hn::MulAdd(x, x, hn::Mul(y, y));
    const auto r0 = hn::Sqrt(hn::MulAdd(depth, depth, rho2));
    const auto inverse = hn::Div(one, r0);
    const auto cycles = hn::MulAdd(hn::Div(rho2, hn::Add(r0, depth)), per_wavelength, hn::Load(d, b.start + k));
    const auto inverse_squared = hn::Mul(inverse, inverse);
    // The greatest |t| of either axis, see growth().
    const auto t_x = hn::Mul(hn::Set(d, half_x), hn::MulAdd(hn::Set(d, 2.0), hn::Abs(x), hn::Set(d, half_x)));
    const auto t_y = hn::Mul(hn::Set(d, half_y), hn::MulAdd(hn::Set(d, 2.0), hn::Abs(y), hn::Set(d, half_y)));
    const auto store = [&](auto v, float* to) { hn::Store(hn::DemoteTo(df, v), df, to + k); };
    store(hn::Add(x, x), b.twice_x);
    store(hn::Add(y, y), b.twice_y);
    store(inverse_squared, b.inverse_r0_squared);
    store(hn::Mul(r0, per_wavelength), b.r0_over_wavelength);
    store(hn::Sub(cycles, hn::Floor(cycles)), b.phase);
    store(hn::Mul(hn::Mul(hn::Load(d, b.amplitude + k), depth), inverse), b.scale);
    store(hn::Mul(hn::Max(t_x, t_y), inverse_squared), b.greatest_t);
  }
}

// Pixels of a tile, from its centre.
struct Offsets {
  AlignedVector<float> u, v, index;  // [m], [m], pixels from the first; v falls as the row grows

  Offsets(TileShape tile, double pitch) {
    for (int i = 0; i < std::max(tile.columns, tile.rows); ++i) {
      index.push_back(float(i));
      u.push_back(float((i - (tile.columns - 1) / 2.0) * pitch));
      v.push_back(float(((tile.rows - 1) / 2.0 - i) * pitch));
    }
  }
};

// Factors (r₀/r)·exp(2πi·Δr/λ) of one row, a lane for each wave.
template <Series series>
HWY_INLINE void row_factor(const Batch& b, int k, float v, float row, V& re, V& im) {
  const Floats d;
  const V vs = hn::Set(d, v);
  const V t = hn::Mul(hn::Mul(vs, hn::Add(vs, hn::Load(d, b.twice_y + k))), hn::Load(d, b.inverse_r0_squared + k));
  V beyond, modulus;
  growth<series>(d, t, beyond, modulus);
  cis_lanes(d, hn::Mul(beyond, hn::Load(d, b.r0_over_wavelength + k)), re, im);
  if (b.has_row_edges) {
    const V at = hn::Set(d, row);
    const auto is_lit = hn::And(hn::Ge(at, hn::Load(d, b.first_row + k)), hn::Lt(at, hn::Load(d, b.last_row + k)));
    modulus = hn::IfThenElseZero(is_lit, modulus);
  }
  re = hn::Mul(re, modulus);
  im = hn::Mul(im, modulus);
}

// Factors a·(d₀/r)·exp(2πi(r₀ + Δr)/λ + iφ) of one wave, a lane for each column.
template <Series series>
HWY_INLINE void column_factor(const Batch& b, int k, V u, V index, bool has_edges, V& re, V& im) {
  const Floats d;
  const V t = hn::Mul(hn::Mul(u, hn::Add(u, hn::Set(d, b.twice_x[k]))), hn::Set(d, b.inverse_r0_squared[k]));
  V beyond, modulus;
  growth<series>(d, t, beyond, modulus);
  cis_lanes(d, hn::MulAdd(beyond, hn::Set(d, b.r0_over_wavelength[k]), hn::Set(d, b.phase[k])), re, im);
  modulus = hn::Mul(modulus, hn::Set(d, b.scale[k]));
  if (has_edges) {
    const auto is_lit = hn::And(hn::Ge(index, hn::Set(d, float(b.first_column[k]))),
                                hn::Lt(index, hn::Set(d, float(b.last_column[k]))));
    modulus = hn::IfThenElseZero(is_lit, modulus);
  }
  re = hn::Mul(re, modulus);
  im = hn::Mul(im, modulus);
}

template <Series series>
void row_factors(const Batch& b, const Offsets& offsets, TileShape tile, float* rows) {
  const Floats d;
  const size_t plane = size_t(tile.rows) * batch;
  for (int r = 0; r < tile.rows; ++r)
    for (int k = 0; k < padded(b.count); k += int(hn::Lanes(d))) {
      V re, im;
      row_factor<series>(b, k, offsets.v[size_t(r)], float(r), re, im);
      float* const to = rows + size_t(r) * batch + size_t(k);
      hn::Store(re, d, to);
      hn::Store(im, d, to + plane);
      hn::Store(hn::Add(re, im), d, to + 2 * plane);
    }
}

// Column panels of `vectors` each, as the product's block has.
template <Series series>
void column_factors(const Batch& b, const Offsets& offsets, TileShape tile, int k, int vectors, float* columns) {
  const Floats d;
  const size_t plane = size_t(tile.columns) * batch, n = hn::Lanes(d), panel = size_t(vectors) * n;
  const bool has_edges = b.first_column[k] > 0 || b.last_column[k] < tile.columns;
  const float *u = offsets.u.data(), *index = offsets.index.data();
  for (float* start = columns + size_t(k) * panel; start < columns + plane; start += batch * panel)
    for (float* to = start; to < start + panel; to += n, u += n, index += n) {
      V re, im;
      column_factor<series>(b, k, hn::Load(d, u), hn::Load(d, index), has_edges, re, im);
      hn::Store(re, d, to);
      hn::Store(im, d, to + plane);
      hn::Store(hn::Add(re, im), d, to + 2 * plane);
    }
}

// sums[block_rows × vectors] += Σ over waves of row factor × column factor, of one plane.
template <int block_rows, int vectors>
HWY_INLINE void multiply_block(const float* HWY_RESTRICT columns, const float* HWY_RESTRICT rows, int waves,
                               float* HWY_RESTRICT sums, int stride) {
  const Floats d;
  const size_t n = hn::Lanes(d);
  V sum[block_rows][vectors];
#pragma GCC unroll 8
  for (int r = 0; r < block_rows; ++r)
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) sum[r][v] = hn::Zero(d);
  for (int k = 0; k < waves; ++k) {
    V c[vectors];
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) c[v] = hn::Load(d, columns + size_t(v) * n);
    columns += vectors * n;
#pragma GCC unroll 8
    for (int r = 0; r < block_rows; ++r) {
      const V a = hn::Set(d, rows[r * batch + k]);
#pragma GCC unroll 8
      for (int v = 0; v < vectors; ++v) sum[r][v] = hn::MulAdd(a, c[v], sum[r][v]);
    }
  }
#pragma GCC unroll 8
  for (int r = 0; r < block_rows; ++r)
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) {
      float* const to = sums + size_t(r) * stride + v * n;
      hn::Store(hn::Add(hn::Load(d, to), sum[r][v]), d, to);
    }
}

template <int block_rows, int vectors>
void multiply_batch(TileWorkspace& s, TileShape tile, int waves) {
  const int panel = vectors * int(hn::Lanes(Floats()));
  for (size_t p = 0; p < planes; ++p) {
    const float* const columns = s.columns.data() + p * size_t(tile.columns) * batch;
    const float* const rows = s.rows.data() + p * size_t(tile.rows) * batch;
    float* const sums = s.sums.data() + p * size_t(tile.rows) * size_t(tile.columns);
    for (int c = 0; c < tile.columns; c += panel)
      for (int r = 0; r < tile.rows; r += block_rows)
        multiply_block<block_rows, vectors>(columns + size_t(c) * batch, rows + size_t(r) * batch, waves,
                                            sums + size_t(r) * tile.columns + c, tile.columns);
  }
}

// bf16 is the upper half of a float. Numbers are rounded to it by adding half a unit of its last place.
template <class W>
HWY_INLINE W rounded_bits(W bits) {
  const Words d;
  return hn::And(hn::Add(bits, hn::Set(d, 0x8000u)), hn::Set(d, 0xffff0000u));
}

// A pair of numbers in one word, the first in the low half; then what rounding left of both.
HWY_INLINE void pack(V first, V second, uint32_t* parts, size_t part_step, int part_count) {
  const Floats d;
  const Words dw;
  for (int part = 0; part < part_count; ++part) {
    const auto low = rounded_bits(hn::BitCast(dw, first)), high = rounded_bits(hn::BitCast(dw, second));
    hn::Store(hn::Or(hn::ShiftRight<16>(low), high), dw, parts + size_t(part) * part_step);
    first = hn::Sub(first, hn::BitCast(d, low));
    second = hn::Sub(second, hn::BitCast(d, high));
  }
}

int packed_rows(TileShape tile) { return (tile.rows + 31) / 32 * 32; }

// Words of one part of one plane.
size_t packed_row_words(TileShape tile) { return size_t(packed_rows(tile)) * pairs; }
size_t packed_column_words(TileShape tile) { return size_t(tile.columns) * pairs; }

// The first wave of pair i: pairs are of waves 16 apart, whole vectors of waves or of columns on either side.
constexpr int first_of_pair(int i) { return i / 16 * 32 + i % 16; }

template <Series series>
void packed_row_factors(const Batch& b, const Offsets& offsets, TileShape tile, int parts, uint32_t* rows) {
  const Floats d;
  const size_t part_step = packed_row_words(tile), plane = part_step * size_t(parts);
  for (int r = 0; r < tile.rows; ++r)
    for (int i = 0; i < padded(b.count) / 2; i += int(hn::Lanes(d))) {
      V re[2], im[2];
      for (int half = 0; half < 2; ++half)
        row_factor<series>(b, first_of_pair(i) + 16 * half, offsets.v[size_t(r)], float(r), re[half], im[half]);
      uint32_t* const to = rows + size_t(r) * pairs + size_t(i);
      pack(re[0], re[1], to, part_step, parts);
      pack(im[0], im[1], to + plane, part_step, parts);
      pack(hn::Add(re[0], im[0]), hn::Add(re[1], im[1]), to + 2 * plane, part_step, parts);
    }
}

template <Series series>
void packed_column_factors(const Batch& b, const Offsets& offsets, TileShape tile, int parts, uint32_t* columns) {
  const Floats d;
  const size_t part_step = packed_column_words(tile), plane = part_step * size_t(parts);
  for (int i = 0; i < padded(b.count) / 2; ++i) {
    const int k = first_of_pair(i);
    const bool has_edges = std::max(b.first_column[k], b.first_column[k + 16]) > 0 ||
                           std::min(b.last_column[k], b.last_column[k + 16]) < tile.columns;
    for (int c = 0; c < tile.columns; c += int(hn::Lanes(d))) {
      V re[2], im[2];
      for (int half = 0; half < 2; ++half)
        column_factor<series>(b, k + 16 * half, hn::Load(d, &offsets.u[size_t(c)]),
                              hn::Load(d, &offsets.index[size_t(c)]), has_edges, re[half], im[half]);
      uint32_t* const to = columns + (size_t(c / 16) * pairs + size_t(i)) * 16 + size_t(c % 16);
      pack(re[0], re[1], to, part_step, parts);
      pack(im[0], im[1], to + plane, part_step, parts);
      pack(hn::Add(re[0], im[0]), hn::Add(re[1], im[1]), to + 2 * plane, part_step, parts);
    }
  }
}

// With two parts each, of the four products all but the smallest: the first alone, and each first with a second.
void multiply_packed_batch(TileWorkspace& s, TileShape tile, int waves, int parts) {
  const size_t row_step = packed_row_words(tile), column_step = packed_column_words(tile);
  for (size_t p = 0; p < planes; ++p) {
    const uint32_t* const rows = s.packed_rows.data() + p * row_step * size_t(parts);
    const uint32_t* const columns = s.packed_columns.data() + p * column_step * size_t(parts);
    const PackedProduct product{{{rows, columns}, {rows, columns + column_step}, {rows + row_step, columns}},
                                parts == 1 ? 1 : 3,
                                padded(waves) / 2,
                                pairs,
                                packed_rows(tile),
                                tile.columns,
                                s.sums.data() + p * size_t(packed_rows(tile)) * size_t(tile.columns)};
    multiply_packed(product, packed_unit());
  }
}

// Vectors of columns in a block of the product: with 6 rows, 24 of 32 registers hold sums, or 12 of 16.
int block_vectors(TileShape tile) {
  const int n = int(hn::Lanes(Floats()));
  return HWY_TARGET <= HWY_AVX3 && tile.columns % (4 * n) == 0 ? 4 : 2;
}

// Factors and products in single precision.
void add_single(const Batch& b, const Offsets& offsets, TileShape tile, TileWorkspace& s) {
  const int vectors = block_vectors(tile);
  Series worst = Series::short_series;
  for (int k = 0; k < b.count; ++k) {
    const Series series = series_for(b.greatest_t[k], b.r0_over_wavelength[k]);
    worst = std::min(worst, series);
    call_with(series, [&](auto fixed) { column_factors<fixed()>(b, offsets, tile, k, vectors, s.columns.data()); });
  }
  call_with(worst, [&](auto fixed) { row_factors<fixed()>(b, offsets, tile, s.rows.data()); });
  if (tile.rows % 6 != 0)
    multiply_batch<2, 2>(s, tile, b.count);
  else if (vectors == 4)
    multiply_batch<6, 4>(s, tile, b.count);
  else
    multiply_batch<6, 2>(s, tile, b.count);
}

// Factors in single precision, products packed.
void add_packed(const Batch& b, const Offsets& offsets, TileShape tile, int parts, TileWorkspace& s) {
  Series worst = Series::short_series;
  for (int k = 0; k < b.count; ++k) worst = std::min(worst, series_for(b.greatest_t[k], b.r0_over_wavelength[k]));
  call_with(worst, [&](auto fixed) {
    packed_column_factors<fixed()>(b, offsets, tile, parts, s.packed_columns.data());
    packed_row_factors<fixed()>(b, offsets, tile, parts, s.packed_rows.data());
  });
  multiply_packed_batch(s, tile, b.count, parts);
}

// The tile's rows as its sums are held.
int held_rows(const TilePlan& plan) {
  return plan.products == TileProducts::single ? plan.shape.rows : packed_rows(plan.shape);
}

void prepare_workspace(const TilePlan& plan, TileWorkspace& s) {
  const TileShape tile = plan.shape;
  s.sums.assign(planes * size_t(held_rows(plan)) * size_t(tile.columns), 0.0f);
  if (plan.products == TileProducts::single) {
    s.columns.resize(planes * size_t(tile.columns) * batch);
    s.rows.resize(planes * size_t(tile.rows) * batch);
    return;
  }
  const size_t parts = plan.products == TileProducts::bf16 ? 1 : 2;
  s.packed_columns.resize(planes * parts * packed_column_words(tile));
  s.packed_rows.assign(planes * parts * packed_row_words(tile), 0);  // rows past the tile's stay dark
}

void add_batch(Batch& b, const Offsets& offsets, double wavelength, double pitch, const TilePlan& plan,
               TileWorkspace& s) {
  if (b.count == 0) return;
  pad(b);
  prepare(b, wavelength, plan.shape.columns * pitch / 2, plan.shape.rows * pitch / 2);
  if (plan.products == TileProducts::single)
    add_single(b, offsets, plan.shape, s);
  else
    add_packed(b, offsets, plan.shape, plan.products == TileProducts::bf16 ? 1 : 2, s);
  b.count = 0;
  b.has_row_edges = false;
}

void SumTile(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength, const TilePlan& plan,
             const PixelBox& box, TileWorkspace& s, Array2D<std::complex<float>>& samples) {
  const TileShape tile = plan.shape;
  prepare_workspace(plan, s);
  const Offsets offsets(tile, grid.pitch);
  const double x_centre = grid.x(box.x0 + (tile.columns - 1) / 2.0), y_centre = grid.y(box.y0 + (tile.rows - 1) / 2.0);
  const int most = plan.products == TileProducts::single ? batch : packed_batch;
  Batch b;
  for (const PreparedWave& wave : waves) {
    if (intersect(wave.box, box).is_empty()) continue;
    add_wave(b, wave, x_centre, y_centre, box, tile.rows);
    if (b.count == most) add_batch(b, offsets, wavelength, grid.pitch, plan, s);
  }
  add_batch(b, offsets, wavelength, grid.pitch, plan, s);
  const float* const ac = s.sums.data();
  const float* const bd = ac + s.sums.size() / planes;
  const float* const all = bd + s.sums.size() / planes;
  for (int j = box.y0; j < box.y1; ++j)
    for (int i = box.x0; i < box.x1; ++i) {
      const size_t at = size_t(j - box.y0) * size_t(tile.columns) + size_t(i - box.x0);
      samples(j, i) += std::complex<float>(ac[at] - bd[at], all[at] - ac[at] - bd[at]);
    }
}

std::string TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace holotrace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(SumTile);
HWY_EXPORT(TargetName);

void sum_tile(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength, const TilePlan& plan,
              const PixelBox& box, TileWorkspace& workspace, Array2D<std::complex<float>>& samples) {
  HWY_DYNAMIC_DISPATCH(SumTile)(waves, grid, wavelength, plan, box, workspace, samples);
}

std::string sum_tiled_instruction_set() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace holotrace
#endif
