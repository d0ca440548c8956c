// A tile is a complex matrix product: samples[row][column] += Σⱼ row factorⱼ[row] · column factorⱼ[column].
// Waves are taken in batches; a batch's factors are computed into panels that the inner loop streams.

#include "holotrace/wave/tile_sum.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/wave/tile_sum.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/wave/sum_tiled.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using V = hn::Vec<Floats>;

// A block of the product that stays in registers: rows × (2 vectors), real and imaginary.
#if HWY_TARGET <= HWY_AVX3
constexpr int block_rows = 4;  // 16 of 32 registers hold sums
#else
constexpr int block_rows = 2;  // 8 of 16
#endif
constexpr int block_vectors = 2;
constexpr int batch = 64;  // waves whose factors are held at once: a column panel then fits the first cache

// exp(2πi·c) of `cycles` c, |c| < 2^22, within 2e-7: a quarter turn is split off, the rest is in ±1/8 of a
// cycle, where the polynomials (Cephes sinf, cosf) hold a float's precision.
HWY_INLINE void cis(V cycles, V& re, V& im) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const V quarters = hn::Round(hn::Mul(cycles, hn::Set(d, 4.0f)));
  const V angle = hn::Mul(hn::NegMulAdd(quarters, hn::Set(d, 0.25f), cycles), hn::Set(d, 6.283185307179586f));
  const V a2 = hn::Mul(angle, angle);
  V s = hn::MulAdd(hn::Set(d, -1.9515295891e-4f), a2, hn::Set(d, 8.3321608736e-3f));
  s = hn::MulAdd(s, a2, hn::Set(d, -1.6666654611e-1f));
  s = hn::MulAdd(hn::Mul(s, a2), angle, angle);
  V c = hn::MulAdd(hn::Set(d, 2.443315711809948e-5f), a2, hn::Set(d, -1.388731625493765e-3f));
  c = hn::MulAdd(c, a2, hn::Set(d, 4.166664568298827e-2f));
  c = hn::MulAdd(hn::Mul(c, a2), a2, hn::NegMulAdd(hn::Set(d, 0.5f), a2, hn::Set(d, 1.0f)));
  // Turn by quarters: q = 0: (c, s), 1: (−s, c), 2: (−c, −s), 3: (s, −c).
  const auto q = hn::ConvertTo(di, quarters);
  const auto is_odd = hn::RebindMask(d, hn::TestBit(q, hn::Set(di, 1)));
  const auto sign = [&](auto bits) { return hn::BitCast(d, hn::ShiftLeft<30>(hn::And(bits, hn::Set(di, 2)))); };
  re = hn::Xor(hn::IfThenElse(is_odd, s, c), sign(hn::Add(q, hn::Set(di, 1))));
  im = hn::Xor(hn::IfThenElse(is_odd, c, s), sign(q));
}

// What the factors of one wave in one tile need: the tile's centre lies at (x, y) from the source,
// at the distance r0.
struct WaveInTile {
  float inverse_r0_squared, r0_over_wavelength;
};

// One axis of the split. For an offset u from the tile's centre and the source's distance x along
// that axis, t = u(2x + u)/r₀² gives r = r₀√(1+t), so
//     Δr = r − r₀ = r₀·t/(1 + √(1+t))   without cancellation,   and   r₀/r = 1/√(1+t).
// Factor = scale·(r₀/r)·exp(2πi(start + Δr/λ)), zero outside [first, last).
HWY_INLINE void factor(V u, V index, float twice_x, const WaveInTile& w, float start, float scale, float first,
                       float last, V& re, V& im) {
  const Floats d;
  const V one = hn::Set(d, 1.0f);
  const V t = hn::Mul(hn::Mul(u, hn::Add(u, hn::Set(d, twice_x))), hn::Set(d, w.inverse_r0_squared));
  const V root = hn::Sqrt(hn::Add(one, t));
  const V beyond = hn::Div(t, hn::Add(one, root));
  cis(hn::MulAdd(beyond, hn::Set(d, w.r0_over_wavelength), hn::Set(d, start)), re, im);
  const auto is_lit = hn::And(hn::Ge(index, hn::Set(d, first)), hn::Lt(index, hn::Set(d, last)));
  const V modulus = hn::IfThenElseZero(is_lit, hn::Div(hn::Set(d, scale), root));
  re = hn::Mul(re, modulus);
  im = hn::Mul(im, modulus);
}

// sums[rows × 2 vectors] += Σ over waves of row factor × column factor.
HWY_INLINE void multiply_block(const float* HWY_RESTRICT columns, const float* HWY_RESTRICT rows, int waves,
                               float* HWY_RESTRICT re_out, float* HWY_RESTRICT im_out, int stride) {
  const Floats d;
  const size_t n = hn::Lanes(d);
  V re[block_rows][block_vectors], im[block_rows][block_vectors];
#pragma GCC unroll 8
  for (int r = 0; r < block_rows; ++r)
#pragma GCC unroll 2
    for (int v = 0; v < block_vectors; ++v) re[r][v] = im[r][v] = hn::Zero(d);
  for (int k = 0; k < waves; ++k) {
    const V c_re[2] = {hn::Load(d, columns), hn::Load(d, columns + n)};
    const V c_im[2] = {hn::Load(d, columns + 2 * n), hn::Load(d, columns + 3 * n)};
    columns += 4 * n;
#pragma GCC unroll 8
    for (int r = 0; r < block_rows; ++r) {
      const V r_re = hn::Set(d, rows[r]), r_im = hn::Set(d, rows[block_rows + r]);
#pragma GCC unroll 2
      for (int v = 0; v < block_vectors; ++v) {
        re[r][v] = hn::MulAdd(r_re, c_re[v], re[r][v]);
        im[r][v] = hn::MulAdd(r_re, c_im[v], im[r][v]);
        re[r][v] = hn::NegMulAdd(r_im, c_im[v], re[r][v]);
        im[r][v] = hn::MulAdd(r_im, c_re[v], im[r][v]);
      }
    }
    rows += 2 * block_rows;
  }
#pragma GCC unroll 8
  for (int r = 0; r < block_rows; ++r)
#pragma GCC unroll 2
    for (int v = 0; v < block_vectors; ++v) {
      float* const to_re = re_out + size_t(r) * stride + v * n;
      float* const to_im = im_out + size_t(r) * stride + v * n;
      hn::Store(hn::Add(hn::Load(d, to_re), re[r][v]), d, to_re);
      hn::Store(hn::Add(hn::Load(d, to_im), im[r][v]), d, to_im);
    }
}

// Panels of factors of one batch, laid out as multiply_block reads them, and the tile's sums.
struct Workspace {
  AlignedVector<float> columns, rows, re, im, u, v, index;

  Workspace(TileShape tile, double pitch) {
    const size_t width = size_t(tile.columns), height = size_t(tile.rows);
    columns.resize(2 * width * batch);
    rows.resize(2 * height * batch);
    re.resize(width * height);
    im.resize(width * height);
    // Offsets from the tile's centre; y falls as the row grows. Padded to whole vectors.
    const size_t longest = std::max(width, height) + 64;
    for (size_t i = 0; i < longest; ++i) {
      index.push_back(float(i));
      u.push_back(float((double(i) - (tile.columns - 1) / 2.0) * pitch));
      v.push_back(float(((tile.rows - 1) / 2.0 - double(i)) * pitch));
    }
  }
};

void column_factors(const Workspace& s, TileShape tile, int k, float twice_x, const WaveInTile& w, float start,
                    float scale, float first, float last, float* columns) {
  const Floats d;
  const int n = int(hn::Lanes(d)), panel = block_vectors * n;
  for (int c = 0; c < tile.columns; c += n) {
    V re, im;
    factor(hn::Load(d, &s.u[size_t(c)]), hn::Load(d, &s.index[size_t(c)]), twice_x, w, start, scale, first, last, re,
           im);
    float* const to = columns + (size_t(c / panel) * batch + size_t(k)) * 2 * size_t(panel) + size_t(c % panel);
    hn::Store(re, d, to);
    hn::Store(im, d, to + panel);
  }
}

void row_factors(const Workspace& s, TileShape tile, int k, float twice_y, const WaveInTile& w, float first, float last,
                 float* rows) {
  const Floats d;
  const int n = int(hn::Lanes(d));
  HWY_ALIGN float re_lanes[HWY_MAX_BYTES / sizeof(float)], im_lanes[HWY_MAX_BYTES / sizeof(float)];
  for (int r = 0; r < tile.rows; r += n) {
    V re, im;
    factor(hn::Load(d, &s.v[size_t(r)]), hn::Load(d, &s.index[size_t(r)]), twice_y, w, 0, 1, first, last, re, im);
    hn::Store(re, d, re_lanes);
    hn::Store(im, d, im_lanes);
    for (int l = 0; l < n && r + l < tile.rows; ++l) {
      const int row = r + l;
      float* const to =
          rows + (size_t(row / block_rows) * batch + size_t(k)) * 2 * block_rows + size_t(row % block_rows);
      to[0] = re_lanes[l];
      to[block_rows] = im_lanes[l];
    }
  }
}

void multiply_batch(Workspace& s, TileShape tile, int waves) {
  const int panel = block_vectors * int(hn::Lanes(Floats()));
  for (int c = 0; c < tile.columns; c += panel)
    for (int r = 0; r < tile.rows; r += block_rows)
      multiply_block(s.columns.data() + size_t(c) * 2 * batch, s.rows.data() + size_t(r) * 2 * batch, waves,
                     s.re.data() + size_t(r) * tile.columns + c, s.im.data() + size_t(r) * tile.columns + c,
                     tile.columns);
}

void SumTile(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength, TileShape tile,
             const PixelBox& box, Array2D<std::complex<float>>& samples) {
  Workspace s(tile, grid.pitch);
  const double x_centre = grid.x(box.x0 + (tile.columns - 1) / 2.0), y_centre = grid.y(box.y0 + (tile.rows - 1) / 2.0);
  int held = 0;
  for (const PreparedWave& wave : waves) {
    const PixelBox& lit = wave.box;
    if (lit.x0 >= box.x1 || lit.x1 <= box.x0 || lit.y0 >= box.y1 || lit.y1 <= box.y0) continue;
    const double x = x_centre - wave.x, y = y_centre - wave.y, rho2 = x * x + y * y;
    const double r0 = std::sqrt(rho2 + wave.depth * wave.depth);
    const double cycles = wave.start_cycles + rho2 / (r0 + wave.depth) / wavelength;
    const WaveInTile w{float(1 / (r0 * r0)), float(r0 / wavelength)};
    column_factors(s, tile, held, float(2 * x), w, float(cycles - std::floor(cycles)),
                   float(wave.amplitude * wave.depth / r0), float(lit.x0 - box.x0), float(lit.x1 - box.x0),
                   s.columns.data());
    row_factors(s, tile, held, float(2 * y), w, float(lit.y0 - box.y0), float(lit.y1 - box.y0), s.rows.data());
    if (++held == batch) {
      multiply_batch(s, tile, held);
      held = 0;
    }
  }
  multiply_batch(s, tile, held);
  for (int j = box.y0; j < box.y1; ++j)
    for (int i = box.x0; i < box.x1; ++i) {
      const size_t at = size_t(j - box.y0) * size_t(tile.columns) + size_t(i - box.x0);
      samples(j, i) = {s.re[at], s.im[at]};
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

void sum_tile(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength, TileShape tile,
              const PixelBox& box, Array2D<std::complex<float>>& samples) {
  HWY_DYNAMIC_DISPATCH(SumTile)(waves, grid, wavelength, tile, box, samples);
}

std::string sum_tiled_instruction_set() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace holotrace
#endif
