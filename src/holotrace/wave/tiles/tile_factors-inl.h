// The factors of waves in a tile: one number for each of its columns and rows. Highway compiles them once for every
// instruction set: include this inside a file that foreach_target.h repeats.

#if defined(HOLOTRACE_TILE_FACTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HOLOTRACE_TILE_FACTORS_INL_H
#undef HOLOTRACE_TILE_FACTORS_INL_H
#else
#define HOLOTRACE_TILE_FACTORS_INL_H
#endif

#include <hwy/highway.h>

#include "holotrace/wave/shared/wave_lanes-inl.h"
#include "holotrace/wave/tiles/tile_sum.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {

using Floats = hn::ScalableTag<float>;
using V = hn::Vec<Floats>;
using Words = hn::RebindToUnsigned<Floats>;

constexpr int components = 3;  // a, b and a + b of a factor a + ib
constexpr int batch = 128;     // waves whose factors are stored at once, so that they stay in the caches

// Inputs of the factors of a batch of waves in one tile. The tile's centre lies at (x, y) from a wave's origin, at the
// distance r₀.
struct TileBatch {
  int count = 0;
  bool has_row_edges = false;  // a wave ends between two rows of the tile
  alignas(64) double x[batch], y[batch], depth[batch], start[batch], amplitude[batch];
  // Along either axis, r₀ and x are those of the wave or, if it is astigmatic, of its AxisSphere.
  alignas(64) float twice_x[batch], twice_y[batch], inverse_r0_squared_x[batch], inverse_r0_squared_y[batch],
      r0_over_wavelength_x[batch], r0_over_wavelength_y[batch], phase[batch], scale[batch], greatest_t[batch];
  alignas(64) float first_row[batch], last_row[batch];
  int first_column[batch], last_column[batch];
  const AstigmaticWave* astigmatic[batch];  // none: the wave is spherical
};

// lit: the pixels of the tile that it lights
inline void add_wave(TileBatch& b, const PreparedWave& wave, const PixelBox& lit, Vec3 centre, const PixelBox& box,
                     int rows) {
  const int k = b.count++;
  b.x[k] = centre.x - wave.x;
  b.y[k] = centre.y - wave.y;
  b.depth[k] = wave.depth;
  b.start[k] = wave.start_cycles;
  b.amplitude[k] = wave.amplitude;
  b.first_column[k] = lit.x0 - box.x0;
  b.last_column[k] = lit.x1 - box.x0;
  b.first_row[k] = float(lit.y0 - box.y0);
  b.last_row[k] = float(lit.y1 - box.y0);
  b.astigmatic[k] = wave.astigmatic ? &wave.astigmatic->wave : nullptr;
  if (lit.y0 > box.y0 || lit.y1 < box.y0 + rows) b.has_row_edges = true;
}

// Adds waves of amplitude 0 up to a whole number of vectors, or of pairs of vectors for packed products.
inline void pad(TileBatch& b) {
  for (int k = b.count; k % 32 != 0; ++k) {
    b.x[k] = b.y[k] = b.start[k] = b.amplitude[k] = 0;
    b.depth[k] = 1;
    b.first_column[k] = b.last_column[k] = 0;
    b.first_row[k] = b.last_row[k] = 0;
    b.astigmatic[k] = nullptr;
  }
}

inline int padded(int count) { return (count + 31) / 32 * 32; }

// Replaces what `prepare` has computed for wave k, which is astigmatic.
inline void prepare_astigmatic(TileBatch& b, int k, Vec3 centre, double wavelength, double half_x, double half_y) {
  const auto at = b.astigmatic[k]->at(centre);
  const auto slopes = b.astigmatic[k]->slopes(centre);
  const AxisSphere x(slopes.x, slopes.xx), y(slopes.y, slopes.yy);
  const double cycles = cycle_fraction(at.path, wavelength) + b.start[k];
  const double t_x = half_x * (2 * std::abs(x.x) + half_x) / (x.r0 * x.r0);
  const double t_y = half_y * (2 * std::abs(y.x) + half_y) / (y.r0 * y.r0);
  b.twice_x[k] = float(2 * x.x);
  b.twice_y[k] = float(2 * y.x);
  b.inverse_r0_squared_x[k] = float(1 / (x.r0 * x.r0));
  b.inverse_r0_squared_y[k] = float(1 / (y.r0 * y.r0));
  b.r0_over_wavelength_x[k] = float(x.r0 / wavelength);
  b.r0_over_wavelength_y[k] = float(y.r0 / wavelength);
  b.phase[k] = float(cycles - std::floor(cycles));
  b.scale[k] = float(b.amplitude[k] * at.modulus);
  b.greatest_t[k] = float(std::max(t_x, t_y));
}

// Distances are in double, because r₀ is up to 10⁶ wavelengths. half_x, half_y: tile's centre to edges [m].
inline void prepare(TileBatch& b, Vec3 centre, double wavelength, double half_x, double half_y) {
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
    // The largest |t| along either axis, see growth().
    const auto t_x = hn::Mul(hn::Set(d, half_x), hn::MulAdd(hn::Set(d, 2.0), hn::Abs(x), hn::Set(d, half_x)));
    const auto t_y = hn::Mul(hn::Set(d, half_y), hn::MulAdd(hn::Set(d, 2.0), hn::Abs(y), hn::Set(d, half_y)));
    const auto store = [&](auto v, float* to) { hn::Store(hn::DemoteTo(df, v), df, to + k); };
    store(hn::Add(x, x), b.twice_x);
    store(hn::Add(y, y), b.twice_y);
    const auto r0_over_wavelength = hn::Mul(r0, per_wavelength);
    store(inverse_squared, b.inverse_r0_squared_x);
    store(inverse_squared, b.inverse_r0_squared_y);
    store(r0_over_wavelength, b.r0_over_wavelength_x);
    store(r0_over_wavelength, b.r0_over_wavelength_y);
    store(hn::Sub(cycles, hn::Floor(cycles)), b.phase);
    store(hn::Mul(hn::Mul(hn::Load(d, b.amplitude + k), depth), inverse), b.scale);
    store(hn::Mul(hn::Max(t_x, t_y), inverse_squared), b.greatest_t);
  }
  for (int k = 0; k < b.count; ++k)
    if (b.astigmatic[k]) prepare_astigmatic(b, k, centre, wavelength, half_x, half_y);
}

inline Series series_of(const TileBatch& b, int k) {
  return series_for(b.greatest_t[k],
                    std::max(std::abs(b.r0_over_wavelength_x[k]), std::abs(b.r0_over_wavelength_y[k])));
}

// Positions of a tile's pixels from its centre.
struct Offsets {
  AlignedVector<float> u, v, index;  // [m], [m], pixels from the first; v decreases with the row

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
HWY_INLINE void row_factor(const TileBatch& b, int k, float v, float row, V& re, V& im) {
  const Floats d;
  const V vs = hn::Set(d, v);
  const V t = hn::Mul(hn::Mul(vs, hn::Add(vs, hn::Load(d, b.twice_y + k))), hn::Load(d, b.inverse_r0_squared_y + k));
  V beyond, modulus;
  growth<series>(d, t, beyond, modulus);
  cis_lanes(d, hn::Mul(beyond, hn::Load(d, b.r0_over_wavelength_y + k)), re, im);
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
HWY_INLINE void column_factor(const TileBatch& b, int k, V u, V index, bool has_edges, V& re, V& im) {
  const Floats d;
  const V t = hn::Mul(hn::Mul(u, hn::Add(u, hn::Set(d, b.twice_x[k]))), hn::Set(d, b.inverse_r0_squared_x[k]));
  V beyond, modulus;
  growth<series>(d, t, beyond, modulus);
  cis_lanes(d, hn::MulAdd(beyond, hn::Set(d, b.r0_over_wavelength_x[k]), hn::Set(d, b.phase[k])), re, im);
  modulus = hn::Mul(modulus, hn::Set(d, b.scale[k]));
  if (has_edges) {
    const auto is_lit = hn::And(hn::Ge(index, hn::Set(d, float(b.first_column[k]))),
                                hn::Lt(index, hn::Set(d, float(b.last_column[k]))));
    modulus = hn::IfThenElseZero(is_lit, modulus);
  }
  re = hn::Mul(re, modulus);
  im = hn::Mul(im, modulus);
}

}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
