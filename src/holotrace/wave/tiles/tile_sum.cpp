// A tile is a complex matrix product: samples[row][column] += Σⱼ row factorⱼ[row] · column factorⱼ[column].
//
// A complex product (a + ib)(c + id) takes three real ones: ac, bd and (a + b)(c + d); its real part is ac − bd, its
// imaginary part (a + b)(c + d) − ac − bd. The sum over waves can be done first, so three real matrix products give the
// tile, a quarter less work than four. Waves are taken in batches, whose factors are computed
// into panels that the products read in order.

#include "holotrace/wave/tiles/tile_sum.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "holotrace/base/threads.h"
#include "holotrace/wave/tiles/packed_product.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/wave/tiles/tile_sum.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/wave/tiles/tile_factors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

constexpr int pairs = batch / 2;

template <Series series>
void row_factors(const TileBatch& b, const Offsets& offsets, TileShape tile, float* rows) {
  const Floats d;
  const size_t component = size_t(tile.rows) * batch;
  for (int r = 0; r < tile.rows; ++r)
    for (int k = 0; k < padded(b.count); k += int(hn::Lanes(d))) {
      V re, im;
      row_factor<series>(b, k, offsets.v[size_t(r)], float(r), re, im);
      float* const to = rows + size_t(r) * batch + size_t(k);
      hn::Store(re, d, to);
      hn::Store(im, d, to + component);
      hn::Store(hn::Add(re, im), d, to + 2 * component);
    }
}

// Writes panels of `vectors` columns each, in the layout of the product's block.
template <Series series>
void column_factors(const TileBatch& b, const Offsets& offsets, TileShape tile, int k, int vectors, float* columns) {
  const Floats d;
  const size_t component = size_t(tile.columns) * batch, n = hn::Lanes(d), panel = size_t(vectors) * n;
  const bool has_edges = b.first_column[k] > 0 || b.last_column[k] < tile.columns;
  const float *u = offsets.u.data(), *index = offsets.index.data();
  for (float* start = columns + size_t(k) * panel; start < columns + component; start += batch * panel)
    for (float* to = start; to < start + panel; to += n, u += n, index += n) {
      V re, im;
      column_factor<series>(b, k, hn::Load(d, u), hn::Load(d, index), has_edges, re, im);
      hn::Store(re, d, to);
      hn::Store(im, d, to + component);
      hn::Store(hn::Add(re, im), d, to + 2 * component);
    }
}

// sums[block_rows × vectors] += Σ over waves of row factor × column factor, for one component.
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
  for (size_t p = 0; p < components; ++p) {
    const float* const columns = s.columns.data() + p * size_t(tile.columns) * batch;
    const float* const rows = s.rows.data() + p * size_t(tile.rows) * batch;
    float* const sums = s.sums.data() + p * size_t(tile.rows) * size_t(tile.columns);
    for (int c = 0; c < tile.columns; c += panel)
      for (int r = 0; r < tile.rows; r += block_rows)
        multiply_block<block_rows, vectors>(columns + size_t(c) * batch, rows + size_t(r) * batch, waves,
                                            sums + size_t(r) * tile.columns + c, tile.columns);
  }
}

// A bf16 number is the upper half of a float. Rounds to it by adding half a unit of its last place.
template <class W>
HWY_INLINE W rounded_bits(W bits) {
  const Words d;
  return hn::And(hn::Add(bits, hn::Set(d, 0x8000u)), hn::Set(d, 0xffff0000u));
}

// Packs a pair of numbers into one word, the first in the low half; then the rounding rest of both, as further parts.
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

// Words of one part of one component.
size_t packed_row_words(TileShape tile) { return size_t(packed_rows(tile)) * pairs; }
size_t packed_column_words(TileShape tile) { return size_t(tile.columns) * pairs; }

// The first wave of pair i. The two waves of a pair are 16 apart, so that whole vectors of waves or columns are packed.
constexpr int first_of_pair(int i) { return i / 16 * 32 + i % 16; }

template <Series series>
void packed_row_factors(const TileBatch& b, const Offsets& offsets, TileShape tile, int parts, uint32_t* rows) {
  const Floats d;
  const size_t part_step = packed_row_words(tile), component = part_step * size_t(parts);
  for (int r = 0; r < tile.rows; ++r)
    for (int i = 0; i < padded(b.count) / 2; i += int(hn::Lanes(d))) {
      V re[2], im[2];
      for (int half = 0; half < 2; ++half)
        row_factor<series>(b, first_of_pair(i) + 16 * half, offsets.v[size_t(r)], float(r), re[half], im[half]);
      uint32_t* const to = rows + size_t(r) * pairs + size_t(i);
      pack(re[0], re[1], to, part_step, parts);
      pack(im[0], im[1], to + component, part_step, parts);
      pack(hn::Add(re[0], im[0]), hn::Add(re[1], im[1]), to + 2 * component, part_step, parts);
    }
}

template <Series series>
void packed_column_factors(const TileBatch& b, const Offsets& offsets, TileShape tile, int parts, uint32_t* columns) {
  const Floats d;
  const size_t part_step = packed_column_words(tile), component = part_step * size_t(parts);
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
      pack(im[0], im[1], to + component, part_step, parts);
      pack(hn::Add(re[0], im[0]), hn::Add(re[1], im[1]), to + 2 * component, part_step, parts);
    }
  }
}

// With two parts each, three of the four products: first × first, and each first × the other's second.
void multiply_pairs(TileWorkspace& s, TileShape tile, int waves, int parts) {
  const size_t row_step = packed_row_words(tile), column_step = packed_column_words(tile);
  for (size_t p = 0; p < components; ++p) {
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

// Vectors of columns in a block of the product; with 6 rows, 24 of 32 (or 12 of 16) registers hold sums.
int block_vectors(TileShape tile) {
  return HWY_TARGET <= HWY_AVX3 && tile.columns % (4 * int(hn::Lanes(Floats()))) == 0 ? 4 : 2;
}

// Factors and products in single precision.
void add_single(const TileBatch& b, const Offsets& offsets, TileShape tile, TileWorkspace& s) {
  const int vectors = block_vectors(tile);
  Series worst = Series::short_series;
  for (int k = 0; k < b.count; ++k) {
    const Series series = series_of(b, k);
    worst = std::min(worst, series);
    call_with(series, [&](auto fixed) { column_factors<fixed()>(b, offsets, tile, k, vectors, s.columns.data()); });
  }
  call_with(worst, [&](auto fixed) { row_factors<fixed()>(b, offsets, tile, s.rows.data()); });
  if (tile.rows == 1)
    multiply_batch<1, 2>(s, tile, b.count);
  else if (tile.rows % 6 != 0)
    multiply_batch<2, 2>(s, tile, b.count);
  else if (vectors == 4)
    multiply_batch<6, 4>(s, tile, b.count);
  else
    multiply_batch<6, 2>(s, tile, b.count);
}

// Factors in single precision, packed products.
void add_packed(const TileBatch& b, const Offsets& offsets, TileShape tile, int parts, TileWorkspace& s) {
  Series worst = Series::short_series;
  for (int k = 0; k < b.count; ++k) worst = std::min(worst, series_of(b, k));
  call_with(worst, [&](auto fixed) {
    packed_column_factors<fixed()>(b, offsets, tile, parts, s.packed_columns.data());
    packed_row_factors<fixed()>(b, offsets, tile, parts, s.packed_rows.data());
  });
  multiply_pairs(s, tile, b.count, parts);
}

// Number of rows in the tile's sums, with padding.
int held_rows(const TilePlan& plan) {
  return plan.products == TileProducts::single ? plan.shape.rows : packed_rows(plan.shape);
}

void prepare_workspace(const TilePlan& plan, TileWorkspace& s) {
  const TileShape tile = plan.shape;
  s.sums.assign(components * size_t(held_rows(plan)) * size_t(tile.columns), 0.0f);
  if (plan.products == TileProducts::single) {
    s.columns.resize(components * size_t(tile.columns) * batch);
    s.rows.resize(components * size_t(tile.rows) * batch);
    return;
  }
  const size_t parts = plan.products == TileProducts::bf16 ? 1 : 2;
  s.packed_columns.resize(components * parts * packed_column_words(tile));
  s.packed_rows.assign(components * parts * packed_row_words(tile), 0);  // rows past the tile's stay 0
}

void add_batch(TileBatch& b, const Offsets& offsets, Vec3 centre, double wavelength, double pitch, const TilePlan& plan,
               TileWorkspace& s) {
  if (b.count == 0) return;
  pad(b);
  prepare(b, centre, wavelength, plan.shape.columns * pitch / 2, plan.shape.rows * pitch / 2);
  if (plan.products == TileProducts::single)
    add_single(b, offsets, plan.shape, s);
  else
    add_packed(b, offsets, plan.shape, plan.products == TileProducts::bf16 ? 1 : 2, s);
  b.count = 0;
  b.has_row_edges = false;
}

void SumTile(WaveList waves, const LitGrid& panel, const TilePlan& plan, const PixelBox& box, TileWorkspace& s,
             Array2D<std::complex<float>>& samples) {
  const auto& [grid, wavelength] = panel;
  const TileShape tile = plan.shape;
  prepare_workspace(plan, s);
  const Offsets offsets(tile, grid.pitch);
  const Vec3 centre{grid.x(box.x0 + (tile.columns - 1) / 2.0), grid.y(box.y0 + (tile.rows - 1) / 2.0), 0};
  TileBatch b;
  const auto add = [&](const PreparedWave& wave, const PixelBox& lit) {
    add_wave(b, wave, lit, centre, box, tile.rows);
    if (b.count == batch) add_batch(b, offsets, centre, wavelength, grid.pitch, plan, s);
  };
  for (const PreparedWave* const listed : waves) {
    const PreparedWave& wave = *listed;
    const PixelBox in_tile = intersect(wave.box, box);
    if (in_tile.is_empty()) continue;
    if (!wave.astigmatic) {
      add(wave, wave.box);
      continue;
    }
    // Rows with the same lit columns are one wave.
    for (int row = in_tile.y0; row < in_tile.y1;) {
      const auto columns = lit_columns(wave, grid, row);
      const auto within = [&](std::pair<int, int> c) {
        return std::pair{std::max(c.first, box.x0), std::min(c.second, box.x1)};
      };
      const auto [from, to] = within(columns);
      int end = row + 1;
      while (end < in_tile.y1 && within(lit_columns(wave, grid, end)) == std::pair{from, to}) ++end;
      if (from < to) add(wave, {from, to, row, end});
      row = end;
    }
  }
  add_batch(b, offsets, centre, wavelength, grid.pitch, plan, s);
  const float* const ac = s.sums.data();
  const float* const bd = ac + s.sums.size() / components;
  const float* const all = bd + s.sums.size() / components;
  for (int j = box.y0; j < box.y1; ++j)
    for (int i = box.x0; i < box.x1; ++i) {
      const size_t at = size_t(j - box.y0) * size_t(tile.columns) + size_t(i - box.x0);
      samples(j, i) += std::complex<float>(ac[at] - bd[at], all[at] - ac[at] - bd[at]);
    }
}

std::string TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(SumTile);
HWY_EXPORT(TargetName);

void sum_tile(WaveList waves, const LitGrid& panel, const TilePlan& plan, const PixelBox& box, TileWorkspace& workspace,
              Array2D<std::complex<float>>& samples) {
  HWY_DYNAMIC_DISPATCH(SumTile)(waves, panel, plan, box, workspace, samples);
}

void list_waves(PreparedWaves waves, const PixelBox& box, std::vector<const PreparedWave*>& list) {
  list.clear();
  for (const PreparedWave& wave : waves)
    if (!intersect(wave.box, box).is_empty()) list.push_back(&wave);
}

void sum_tiles(PreparedWaves waves, const LitGrid& panel, const TilePlan& plan, const PixelBox& bounds,
               Array2D<std::complex<float>>& samples, const Observer& observer) {
  const TileShape tile = plan.shape;
  constexpr size_t most_listed = 4096;  // waves that stay in the cache from tile to tile
  for_each_tile<TileWorkspace>(
      bounds, group_of_tiles(tile),
      [&](const PixelBox& group, TileWorkspace& workspace) {
        std::vector<const PreparedWave*>& listed = workspace.waves;
        const auto add_listed = [&] {
          for (int y = group.y0; y < group.y1; y += tile.rows)
            for (int x = group.x0; x < group.x1; x += tile.columns) {
              const PixelBox box{x, std::min(x + tile.columns, group.x1), y, std::min(y + tile.rows, group.y1)};
              sum_tile(listed, panel, plan, box, workspace, samples);
            }
          listed.clear();
        };
        for (const PreparedWave& wave : waves) {
          if (intersect(wave.box, group).is_empty()) continue;
          listed.push_back(&wave);
          if (listed.size() == most_listed) add_listed();
        }
        add_listed();
      },
      observer);
}

std::string tile_sum_instruction_set() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace holotrace
#endif
