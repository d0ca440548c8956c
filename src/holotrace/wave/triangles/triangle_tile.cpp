// A tile's sum is a complex matrix product, as in tile_sum.cpp: samples[row][column] += Σⱼ row factorⱼ[row]·column
// factorⱼ[column], where each part of a triangle makes up to four terms j.

#include "holotrace/wave/triangles/triangle_part.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/wave/triangles/triangle_tile.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "holotrace/wave/shared/wave_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

using Floats = hn::ScalableTag<float>;
using V = hn::Vec<Floats>;

#if HWY_TARGET <= HWY_AVX3
constexpr int block_rows = 4;
#else
constexpr int block_rows = 2;
#endif
constexpr int block_vectors = 2;
constexpr int batch = 64;  // number of terms whose factors are held at once
constexpr int nodes = envelope_nodes;

// A vector of floats with the operators that the formulas of triangle_moments.h need.
struct Lanes {
  V v;
  friend HWY_INLINE Lanes operator+(Lanes a, Lanes b) { return {hn::Add(a.v, b.v)}; }
  friend HWY_INLINE Lanes operator-(Lanes a, Lanes b) { return {hn::Sub(a.v, b.v)}; }
  friend HWY_INLINE Lanes operator*(Lanes a, Lanes b) { return {hn::Mul(a.v, b.v)}; }
  friend HWY_INLINE Lanes operator/(Lanes a, Lanes b) { return {hn::Div(a.v, b.v)}; }
  friend HWY_INLINE Lanes operator-(Lanes a) { return {hn::Neg(a.v)}; }
};
HWY_INLINE Lanes real(Lanes, double value) { return {hn::Set(Floats(), float(value))}; }
HWY_INLINE void cis_of(Lanes angle, Lanes& re, Lanes& im) {
  cis_lanes(Floats(), hn::Mul(angle.v, hn::Set(Floats(), 0.15915494309189535f)), re.v, im.v);
}
HWY_INLINE Lanes small_or(Lanes h2, Lanes small, Lanes large) {
  return {hn::IfThenElse(hn::Lt(h2.v, hn::Set(Floats(), 0.5f)), small.v, large.v)};
}

#include "holotrace/wave/triangles/triangle_moments_formulas.h"

// The envelope at the 16 Chebyshev nodes, [row][column].
HWY_INLINE void envelope(const PartInTile& p, MomentMethod method, const float* node_x, const float* node_y, float* re,
                         float* im) {
  const Floats d;
  const auto set = [&](double x) { return Lanes{hn::Set(d, float(x))}; };
  const Lanes a[3] = {set(p.amplitude[0]), set(p.amplitude[1]), set(p.amplitude[2])};
  const Phasor<Lanes> b[3] = {{set(p.bulge[0].re), set(p.bulge[0].im)},
                              {set(p.bulge[1].re), set(p.bulge[1].im)},
                              {set(p.bulge[2].re), set(p.bulge[2].im)}};
  for (size_t n = 0; n < nodes * nodes; n += hn::Lanes(d)) {
    Lanes t[3];
    for (int j = 0; j < 3; ++j)
      t[j] = {hn::MulAdd(
          hn::Load(d, node_x + n), hn::Set(d, float(p.slope_x[j])),
          hn::MulAdd(hn::Load(d, node_y + n), hn::Set(d, float(p.slope_y[j])), hn::Set(d, float(p.phase[j]))))};
    TriangleMoments<Lanes> m;
    if (method == MomentMethod::short_series)
      m = moments_by_series<13>(t[0], t[1], t[2]);
    else if (method == MomentMethod::quotients)
      m = moments_by_quotients(t[0], t[1], t[2]);
    else
      m = moments_by_series<20>(t[0], t[1], t[2]);
    const Phasor<Lanes> e = combine(m, a, b);
    hn::Store(e.re.v, d, re + n);
    hn::Store(e.im.v, d, im + n);
  }
}

// Converts values at the Chebyshev nodes to coefficients, along rows, then columns.
void to_coefficients(const float* at, float* c) {
  constexpr float f[nodes][nodes] = {
      {0.25f, 0.25f, 0.25f, 0.25f},
      {0.46193976625564337f, 0.19134171618254489f, -0.19134171618254489f, -0.46193976625564337f},
      {0.35355339059327376f, -0.35355339059327376f, -0.35355339059327376f, 0.35355339059327376f},
      {0.19134171618254489f, -0.46193976625564337f, 0.46193976625564337f, -0.19134171618254489f}};
  float half[nodes][nodes];
  for (int m = 0; m < nodes; ++m)
    for (int k = 0; k < nodes; ++k) {
      half[m][k] = 0;
      for (int n = 0; n < nodes; ++n) half[m][k] += f[k][n] * at[m * nodes + n];
    }
  for (int l = 0; l < nodes; ++l)
    for (int k = 0; k < nodes; ++k) {
      float sum = 0;
      for (int m = 0; m < nodes; ++m) sum += f[l][m] * half[m][k];
      c[l * nodes + k] = sum;
    }
}

struct Workspace {
  AlignedVector<float> u, v, index, wave_re, wave_im, row_re, row_im, columns, rows, re, im;
  HWY_ALIGN float node_x[nodes * nodes], node_y[nodes * nodes];
  float inverse_half_x, inverse_half_y;
  int held = 0;

  Workspace(TileShape tile, double pitch)
      : wave_re(size_t(tile.columns)),
        wave_im(wave_re),
        row_re(size_t(std::max(tile.rows, HWY_MAX_BYTES / 4))),
        row_im(row_re),
        columns(size_t(tile.columns) * 2 * batch),
        rows(size_t(tile.rows) * 2 * batch),
        re(size_t(tile.columns) * size_t(tile.rows)),
        im(re) {
    for (int i = 0; i < std::max({tile.columns, tile.rows, HWY_MAX_BYTES / 4}); ++i) {
      index.push_back(float(i));
      u.push_back(float((i - (tile.columns - 1) / 2.0) * pitch));
      v.push_back(float(((tile.rows - 1) / 2.0 - i) * pitch));
    }
    const double half_x = tile.columns * pitch / 2, half_y = tile.rows * pitch / 2;
    for (int n = 0; n < nodes * nodes; ++n) {
      node_x[n] = float(envelope_node[n % nodes] * half_x);
      node_y[n] = float(envelope_node[n / nodes] * half_y);
    }
    inverse_half_x = float(1 / half_x);
    inverse_half_y = float(1 / half_y);
  }
};

struct WaveInTile {
  float inverse_r0_squared, r0_over_wavelength;
};

// One axis of the split, as in tile_sum.cpp: scale·(r₀/r)·exp(2πi(start + Δr/λ)), zero outside [first, last).
HWY_INLINE void factor(V u, V index, float twice_x, const WaveInTile& w, float start, float scale, float first,
                       float last, V& re, V& im) {
  const Floats d;
  const V one = hn::Set(d, 1.0f);
  const V t = hn::Mul(hn::Mul(u, hn::Add(u, hn::Set(d, twice_x))), hn::Set(d, w.inverse_r0_squared));
  const V root = hn::Sqrt(hn::Add(one, t));
  const V beyond = hn::Div(t, hn::Add(one, root));
  cis_lanes(d, hn::MulAdd(beyond, hn::Set(d, w.r0_over_wavelength), hn::Set(d, start)), re, im);
  const auto is_lit = hn::And(hn::Ge(index, hn::Set(d, first)), hn::Lt(index, hn::Set(d, last)));
  const V modulus = hn::IfThenElseZero(is_lit, hn::Div(hn::Set(d, scale), root));
  re = hn::Mul(re, modulus);
  im = hn::Mul(im, modulus);
}

// Adds the term of row l of the Chebyshev coefficients.
void add_term(Workspace& s, TileShape tile, int l, const float* c_re, const float* c_im) {
  const Floats d;
  const int n = int(hn::Lanes(d)), panel = block_vectors * n, k = s.held;
  V p_re[nodes], p_im[nodes];  // from Chebyshev coefficients to powers: T₂ = 2x² − 1, T₃ = 4x³ − 3x
  const auto powers = [&](const float* c, V* p) {
    p[0] = hn::Set(d, c[0] - c[2]);
    p[1] = hn::Set(d, c[1] - 3 * c[3]);
    p[2] = hn::Set(d, 2 * c[2]);
    p[3] = hn::Set(d, 4 * c[3]);
  };
  powers(c_re, p_re);
  powers(c_im, p_im);
  for (int c = 0; c < tile.columns; c += n) {
    const V x = hn::Mul(hn::Load(d, &s.u[size_t(c)]), hn::Set(d, s.inverse_half_x));
    const V a = hn::MulAdd(hn::MulAdd(hn::MulAdd(p_re[3], x, p_re[2]), x, p_re[1]), x, p_re[0]);
    const V b = hn::MulAdd(hn::MulAdd(hn::MulAdd(p_im[3], x, p_im[2]), x, p_im[1]), x, p_im[0]);
    const V w_re = hn::Load(d, &s.wave_re[size_t(c)]), w_im = hn::Load(d, &s.wave_im[size_t(c)]);
    float* const to =
        s.columns.data() + (size_t(c / panel) * batch + size_t(k)) * 2 * size_t(panel) + size_t(c % panel);
    hn::Store(hn::NegMulAdd(w_im, b, hn::Mul(w_re, a)), d, to);
    hn::Store(hn::MulAdd(w_im, a, hn::Mul(w_re, b)), d, to + panel);
  }
  for (int r = 0; r < tile.rows; ++r) {
    const float y = s.v[size_t(r)] * s.inverse_half_y;
    const float t = l == 0 ? 1 : l == 1 ? y : l == 2 ? 2 * y * y - 1 : (4 * y * y - 3) * y;
    float* const to =
        s.rows.data() + (size_t(r / block_rows) * batch + size_t(k)) * 2 * block_rows + size_t(r % block_rows);
    to[0] = s.row_re[size_t(r)] * t;
    to[block_rows] = s.row_im[size_t(r)] * t;
  }
  ++s.held;
}

// sums[rows × 2 vectors] += Σ over terms of row factor × column factor.
HWY_INLINE void multiply_block(const float* HWY_RESTRICT columns, const float* HWY_RESTRICT rows, int terms,
                               float* HWY_RESTRICT re_out, float* HWY_RESTRICT im_out, int stride) {
  const Floats d;
  const size_t n = hn::Lanes(d);
  V re[block_rows][block_vectors], im[block_rows][block_vectors];
#pragma GCC unroll 8
  for (int r = 0; r < block_rows; ++r)
#pragma GCC unroll 2
    for (int v = 0; v < block_vectors; ++v) re[r][v] = im[r][v] = hn::Zero(d);
  for (int k = 0; k < terms; ++k) {
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
      float* const to_re = re_out + size_t(r) * size_t(stride) + size_t(v) * n;
      float* const to_im = im_out + size_t(r) * size_t(stride) + size_t(v) * n;
      hn::Store(hn::Add(hn::Load(d, to_re), re[r][v]), d, to_re);
      hn::Store(hn::Add(hn::Load(d, to_im), im[r][v]), d, to_im);
    }
}

void multiply_held(Workspace& s, TileShape tile) {
  const int panel = block_vectors * int(hn::Lanes(Floats()));
  for (int c = 0; c < tile.columns; c += panel)
    for (int r = 0; r < tile.rows; r += block_rows)
      multiply_block(s.columns.data() + size_t(c) * 2 * batch, s.rows.data() + size_t(r) * 2 * batch, s.held,
                     s.re.data() + size_t(r) * size_t(tile.columns) + c,
                     s.im.data() + size_t(r) * size_t(tile.columns) + c, tile.columns);
  s.held = 0;
}

// The factors of the centroid's wave; the column holds its start and 1/r.
struct Centroid {
  double x, y, r0;  // the tile's middle as seen from it [m]
};
void wave_factors(Workspace& s, TileShape tile, const TrianglePart& part, const Centroid& centroid, double wavelength,
                  const PixelBox& box) {
  const auto [x, y, r0] = centroid;
  const Floats d;
  const int n = int(hn::Lanes(d));
  const double cycles = part.start_cycles + (x * x + y * y) / (r0 + part.depth) / wavelength;
  const float start = float(cycles - std::floor(cycles));
  const WaveInTile w{float(1 / (r0 * r0)), float(r0 / wavelength)};
  const PixelBox& lit = part.box;
  for (int c = 0; c < tile.columns; c += n) {
    V re, im;
    factor(hn::Load(d, &s.u[size_t(c)]), hn::Load(d, &s.index[size_t(c)]), float(2 * x), w, start, 1,
           float(lit.x0 - box.x0), float(lit.x1 - box.x0), re, im);
    hn::Store(re, d, &s.wave_re[size_t(c)]);
    hn::Store(im, d, &s.wave_im[size_t(c)]);
  }
  for (int r = 0; r < tile.rows; r += n) {
    V re, im;
    factor(hn::Load(d, &s.v[size_t(r)]), hn::Load(d, &s.index[size_t(r)]), float(2 * y), w, 0, 1,
           float(lit.y0 - box.y0), float(lit.y1 - box.y0), re, im);
    hn::Store(re, d, &s.row_re[size_t(r)]);
    hn::Store(im, d, &s.row_im[size_t(r)]);
  }
}

void SumTriangleTile(const std::vector<TrianglePart>& parts, const LitGrid& panel, TileShape tile, const PixelBox& box,
                     double faint, Array2D<std::complex<float>>& samples) {
  const auto& [grid, wavelength] = panel;
  Workspace s(tile, grid.pitch);
  const double x_centre = grid.x(box.x0 + (tile.columns - 1) / 2.0), y_centre = grid.y(box.y0 + (tile.rows - 1) / 2.0);
  const double half_x = tile.columns * grid.pitch / 2, half_y = tile.rows * grid.pitch / 2;
  const float least = float(faint * faint);
  for (const TrianglePart& part : parts) {
    const PixelBox& lit = part.box;
    if (lit.x0 >= box.x1 || lit.x1 <= box.x0 || lit.y0 >= box.y1 || lit.y1 <= box.y0) continue;
    PartInTile p = part_in_tile(part, x_centre, y_centre, half_x, half_y, wavelength);
    const double x = x_centre - part.centroid.x, y = y_centre - part.centroid.y;
    const double r0 = std::sqrt(x * x + y * y + part.depth * part.depth);
    for (int j = 0; j < 3; ++j) {
      p.amplitude[j] /= r0;
      p.bulge[j] = p.bulge[j] * (1 / r0);
    }
    HWY_ALIGN float re[nodes * nodes], im[nodes * nodes], c_re[nodes * nodes], c_im[nodes * nodes];
    envelope(p, moment_method(p), s.node_x, s.node_y, re, im);
    to_coefficients(re, c_re);
    to_coefficients(im, c_im);
    bool has_factors = false;
    for (int l = 0; l < nodes; ++l) {
      float squares = 0;
      for (int k = 0; k < nodes; ++k)
        squares += c_re[l * nodes + k] * c_re[l * nodes + k] + c_im[l * nodes + k] * c_im[l * nodes + k];
      if (squares <= least) continue;
      if (!has_factors) wave_factors(s, tile, part, {x, y, r0}, wavelength, box);
      has_factors = true;
      add_term(s, tile, l, c_re + l * nodes, c_im + l * nodes);
    }
    if (s.held > batch - nodes) multiply_held(s, tile);
  }
  multiply_held(s, tile);
  for (int j = box.y0; j < box.y1; ++j)
    for (int i = box.x0; i < box.x1; ++i) {
      const size_t at = size_t(j - box.y0) * size_t(tile.columns) + size_t(i - box.x0);
      samples(j, i) = {s.re[at], s.im[at]};
    }
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(SumTriangleTile);

void sum_triangle_tile(const std::vector<TrianglePart>& parts, const LitGrid& panel, TileShape tile,
                       const PixelBox& box, double faint, Array2D<std::complex<float>>& samples) {
  HWY_DYNAMIC_DISPATCH(SumTriangleTile)(parts, panel, tile, box, faint, samples);
}

}  // namespace holotrace
#endif
