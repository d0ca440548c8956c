// Vector arithmetic of waves, shared by the kernels that sum them. Highway compiles it once for every instruction
// set: include it inside a file that foreach_target.h repeats.

#if defined(HOLOTRACE_WAVE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HOLOTRACE_WAVE_LANES_INL_H
#undef HOLOTRACE_WAVE_LANES_INL_H
#else
#define HOLOTRACE_WAVE_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// exp(2πi·c) of `cycles` c, |c| < 2^21, within 2e-7. Half turns are split off as signs; the rest is in ±1/4 of a
/// cycle, where minimax polynomials in c² reach the precision of a float.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void cis_lanes(D d, V cycles, V& re, V& im) {
  const hn::RebindToUnsigned<D> du;
  // Adding 1.5·2²³ rounds to a whole number; its last bit becomes the last bit of the sum.
  const V magic = hn::Set(d, 12582912.0f);
  const V rounded = hn::MulAdd(cycles, hn::Set(d, 2.0f), magic);
  const V halves = hn::Sub(rounded, magic);
  const V c = hn::NegMulAdd(halves, hn::Set(d, 0.5f), cycles);
  const V q = hn::Mul(c, c);
  V s = hn::MulAdd(hn::Set(d, 39.761616f), q, hn::Set(d, -76.581398f));
  s = hn::MulAdd(s, q, hn::Set(d, 81.602486f));
  s = hn::MulAdd(s, q, hn::Set(d, -41.341682f));
  s = hn::Mul(hn::MulAdd(s, q, hn::Set(d, 6.2831855f)), c);
  V k = hn::MulAdd(hn::Set(d, 56.242382f), q, hn::Set(d, -85.240334f));
  k = hn::MulAdd(k, q, hn::Set(d, 64.934593f));
  k = hn::MulAdd(k, q, hn::Set(d, -19.739172f));
  k = hn::MulAdd(k, q, hn::Set(d, 1.0f));
  const V sign = hn::BitCast(d, hn::ShiftLeft<31>(hn::BitCast(du, rounded)));
  re = hn::Xor(k, sign);
  im = hn::Xor(s, sign);
}

/// One axis of a wave. For an offset u from the tile's centre and the source's distance x along that axis,
/// t = u(2x + u)/r₀² gives r = r₀√(1+t). Computed are (r − r₀)/r₀ without cancellation, and r₀/r, by a series of two
/// or three terms where `series_for` allows it.
enum class Series { none, long_series, short_series };

template <Series series, class D, class V = hn::Vec<D>>
HWY_INLINE void growth(D d, V t, V& beyond, V& modulus) {
  const auto set = [&](float x) { return hn::Set(d, x); };
  if (series == Series::short_series) {
    beyond = hn::Mul(t, hn::MulAdd(t, set(-0.125f), set(0.5f)));
    modulus = hn::MulAdd(t, set(-0.5f), set(1.0f));
  } else if (series == Series::long_series) {
    beyond = hn::Mul(t, hn::MulAdd(t, hn::MulAdd(t, set(0.0625f), set(-0.125f)), set(0.5f)));
    modulus = hn::MulAdd(t, hn::MulAdd(t, hn::MulAdd(t, set(-0.3125f), set(0.375f)), set(-0.5f)), set(1.0f));
  } else {
    const V root = hn::Sqrt(hn::Add(set(1.0f), t));
    beyond = hn::Div(t, hn::Add(set(1.0f), root));
    modulus = hn::Div(set(1.0f), root);
  }
}

/// The shortest series that suffices: the terms left out, t³/16 or 5t⁴/128 of r₀/λ cycles and 3t²/8 or 35t⁴/128 of
/// the modulus, stay below 10⁻⁶.
inline Series series_for(float t, float r0_over_wavelength) {
  const float t2 = t * t;
  if (t2 * t * r0_over_wavelength < 1.6e-5f && t2 < 2.6e-6f) return Series::short_series;
  if (t2 * t2 * r0_over_wavelength < 2.5e-5f && t2 * t2 < 3.6e-6f) return Series::long_series;
  return Series::none;
}

/// Calls `work` with the series as a compile-time constant.
template <class Work>
inline void call_with(Series series, const Work& work) {
  if (series == Series::short_series) work(std::integral_constant<Series, Series::short_series>());
  if (series == Series::long_series) work(std::integral_constant<Series, Series::long_series>());
  if (series == Series::none) work(std::integral_constant<Series, Series::none>());
}

}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
