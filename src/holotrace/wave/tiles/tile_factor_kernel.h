#pragma once

// The factors of waves in a tile, in the common language of C++ and OpenCL C: tile_sum.cl is compiled together with this
// file. Lengths are in wavelengths. Inside a tile centred at (x, y) from a wave's origin, r₀ = √(x² + y² + d²):
//
//     wave(u, v) ≈ column(u) · row(v)
//     column(u)  = a·(d/r₀)·(r₀/r) · exp(2πi·(r₀ − d + start) + 2πi·Δr(u)),   r₀ + Δr(u) = r = √(r₀² + u(2x + u))
//     row(v)     =          (r₀/r) · exp(2πi·Δr(v))
//
// r₀ is up to 10⁸ wavelengths. Many devices have slow doubles or none, so the path r₀ − d is computed in pairs of floats.
// That is done once for each wave and tile, so it costs little.

#ifdef __OPENCL_VERSION__
#pragma OPENCL FP_CONTRACT OFF
#define HOLOTRACE_KERNEL_FUNCTION
float inverse_square_root(float x) { return rsqrt(x); }
float flip_if_odd(float value, float number) { return as_float(as_uint(value) ^ (as_uint(number) << 31)); }
#ifdef FP_FAST_FMAF
#define MULTIPLY_ADD fma
#else
#define MULTIPLY_ADD mad
#endif
#else
#include <bit>
#include <cmath>
#include <cstdint>
#define HOLOTRACE_KERNEL_FUNCTION inline
namespace holotrace::tile_factor_kernel {
using std::floor;
using std::fma;
using std::sqrt;
inline float inverse_square_root(float x) { return 1 / sqrt(x); }
inline float flip_if_odd(float value, float number) {  // the sign, if the last bit of the other number is 1
  return std::bit_cast<float>(std::bit_cast<uint32_t>(value) ^ (std::bit_cast<uint32_t>(number) << 31));
}
#endif

/// The sum of two floats, high + low: 48 bits of a number (Dekker, 1971).
typedef struct {
  float high, low;
} FloatPair;

/// A wave as a device reads it.
typedef struct {
  FloatPair x, y, depth;  // origin, d [wavelengths]
  float start;            // phase at the distance d [cycles]
  float amplitude;
  int x0, x1, y0, y1;  // pixels that it lights
} DeviceWave;

/// A wave as seen from a tile's centre.
typedef struct {
  float twice_x, twice_y;    // 2x, 2y [wavelengths]
  float inverse_r0_squared;  // 1/r₀²
  float r0;                  // [wavelengths]
  float phase;               // r₀ − d + start [cycles], in [0, 1]
  float scale;               // a·d/r₀
} TileWave;

typedef struct {
  float re, im;
} TileFactor;

// --- arithmetic of pairs: the error of each operation is below 2⁻⁴⁴ of its result (Knuth; Dekker; Shewchuk, 1997) ------

HOLOTRACE_KERNEL_FUNCTION FloatPair quick_sum(float a, float b) {  // |a| ≥ |b|
  FloatPair s;
  s.high = a + b;
  s.low = b - (s.high - a);
  return s;
}

HOLOTRACE_KERNEL_FUNCTION FloatPair pair_plus(FloatPair a, FloatPair b) {
  const float s = a.high + b.high, part = s - a.high;
  const float rest = (a.high - (s - part)) + (b.high - part);
  return quick_sum(s, rest + (a.low + b.low));
}

HOLOTRACE_KERNEL_FUNCTION FloatPair pair_minus(FloatPair a, FloatPair b) {
  b.high = -b.high;
  b.low = -b.low;
  return pair_plus(a, b);
}

HOLOTRACE_KERNEL_FUNCTION FloatPair pair_times(FloatPair a, FloatPair b) {
  const float p = a.high * b.high;
  return quick_sum(p, fma(a.high, b.high, -p) + fma(a.high, b.low, a.low * b.high));
}

HOLOTRACE_KERNEL_FUNCTION FloatPair pair_over(FloatPair a, FloatPair b) {
  FloatPair q;
  q.high = a.high / b.high;
  q.low = 0;
  return quick_sum(q.high, pair_minus(a, pair_times(q, b)).high / b.high);
}

HOLOTRACE_KERNEL_FUNCTION FloatPair pair_root(FloatPair a) {  // a > 0
  FloatPair root;
  root.high = sqrt(a.high);
  root.low = 0;
  return quick_sum(root.high, pair_minus(a, pair_times(root, root)).high / (2 * root.high));
}

// --- the factors --------------------------------------------------------------------------------------------------------

/// @param x, y  the tile's centre [wavelengths]
HOLOTRACE_KERNEL_FUNCTION TileWave wave_from_tile(DeviceWave wave, FloatPair x, FloatPair y) {
  x = pair_minus(x, wave.x);
  y = pair_minus(y, wave.y);
  const FloatPair rho2 = pair_plus(pair_times(x, x), pair_times(y, y));
  const FloatPair r0 = pair_root(pair_plus(rho2, pair_times(wave.depth, wave.depth)));
  const FloatPair beyond = pair_over(rho2, pair_plus(r0, wave.depth));  // r₀ − d without cancellation
  const float cycles = (beyond.high - floor(beyond.high)) + (beyond.low - floor(beyond.low)) + wave.start;
  TileWave t;
  t.twice_x = 2 * x.high;
  t.twice_y = 2 * y.high;
  t.inverse_r0_squared = 1 / (r0.high * r0.high);
  t.r0 = r0.high;
  t.phase = cycles - floor(cycles);
  t.scale = wave.amplitude * wave.depth.high / r0.high;
  return t;
}

/// modulus · exp(2πi·c) of `cycles` c, |c| < 2^21, within 2e-7, by the polynomials of wave_lanes-inl.h.
HOLOTRACE_KERNEL_FUNCTION TileFactor cis_times(float cycles, float modulus) {
  const float magic = 12582912.0f;  // 1.5·2²³: adding it rounds to a whole number of half turns, as the last bits
  const float rounded = fma(2.0f, cycles, magic), c = fma(-0.5f, rounded - magic, cycles), q = c * c;
  float s = fma(39.761616f, q, -76.581398f);
  s = fma(s, q, 81.602486f);
  s = fma(s, q, -41.341682f);
  s = fma(s, q, 6.2831855f) * c;
  float k = fma(56.242382f, q, -85.240334f);
  k = fma(k, q, 64.934593f);
  k = fma(k, q, -19.739172f);
  k = fma(k, q, 1.0f);
  const float signed_modulus = flip_if_odd(modulus, rounded);
  TileFactor f;
  f.re = k * signed_modulus;
  f.im = s * signed_modulus;
  return f;
}

/// (r₀/r)·scale·exp(2πi(Δr + phase)) at the offset `u` from the tile's centre along an axis on which the wave's origin
/// lies x = twice_x/2 away.
HOLOTRACE_KERNEL_FUNCTION TileFactor tile_factor(TileWave t, float u, float twice_x, float phase, float scale) {
  const float growth = u * (u + twice_x) * t.inverse_r0_squared, square = 1 + growth;  // (r/r₀)²
  const float inverse_root = inverse_square_root(square), root = square * inverse_root;
  const float beyond = growth / (1 + root);  // (r − r₀)/r₀ without cancellation
  return cis_times(fma(beyond, t.r0, phase), scale * inverse_root);
}

HOLOTRACE_KERNEL_FUNCTION TileFactor column_factor(TileWave t, float u) {
  return tile_factor(t, u, t.twice_x, t.phase, t.scale);
}

HOLOTRACE_KERNEL_FUNCTION TileFactor row_factor(TileWave t, float v) { return tile_factor(t, v, t.twice_y, 0, 1); }

#ifndef __OPENCL_VERSION__
}  // namespace holotrace::tile_factor_kernel
#endif
