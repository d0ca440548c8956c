// Vector arithmetic of waves, shared by the kernels that sum them. Highway compiles it once for every instruction
// set: include it inside a file that foreach_target.h repeats.

#if defined(HOLOTRACE_WAVE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HOLOTRACE_WAVE_LANES_INL_H
#undef HOLOTRACE_WAVE_LANES_INL_H
#else
#define HOLOTRACE_WAVE_LANES_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace holotrace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// exp(2πi·c) of `cycles` c, |c| < 2^21, within 2e-7: half turns are split off as signs, the rest is in ±1/4 of a
/// cycle, where least-maximum polynomials in c² hold a float's precision.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void cis_lanes(D d, V cycles, V& re, V& im) {
  const hn::RebindToUnsigned<D> du;
  // Adding 1.5·2²³ rounds to whole numbers, whose last bit ends up as the last bit of the sum.
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

}  // namespace HWY_NAMESPACE
}  // namespace holotrace
HWY_AFTER_NAMESPACE();

#endif
