// Transforms of 1 to 13 numbers in registers, for every lane at once: include it inside a file that foreach_target.h repeats.

#if defined(HOLOTRACE_FFT_RADIX_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HOLOTRACE_FFT_RADIX_INL_H
#undef HOLOTRACE_FFT_RADIX_INL_H
#else
#define HOLOTRACE_FFT_RADIX_INL_H
#endif

#include <hwy/highway.h>

#include <complex>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A complex number of each lane.
template <class V>
struct Lanes {
  V re, im;
};

template <class V>
HWY_INLINE Lanes<V> operator+(Lanes<V> a, Lanes<V> b) {
  return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)};
}
template <class V>
HWY_INLINE Lanes<V> operator-(Lanes<V> a, Lanes<V> b) {
  return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)};
}
// a − i·b and a + i·b
template <class V>
HWY_INLINE Lanes<V> minus_i(Lanes<V> a, Lanes<V> b) {
  return {hn::Add(a.re, b.im), hn::Sub(a.im, b.re)};
}
template <class V>
HWY_INLINE Lanes<V> plus_i(Lanes<V> a, Lanes<V> b) {
  return {hn::Sub(a.re, b.im), hn::Add(a.im, b.re)};
}
// a + f·b for a real number f
template <class V>
HWY_INLINE Lanes<V> add_times(Lanes<V> a, V f, Lanes<V> b) {
  return {hn::MulAdd(f, b.re, a.re), hn::MulAdd(f, b.im, a.im)};
}
template <class V>
HWY_INLINE Lanes<V> times(V f, Lanes<V> a) {
  return {hn::Mul(f, a.re), hn::Mul(f, a.im)};
}
template <class V, class Real>
HWY_INLINE Lanes<V> times(Lanes<V> a, const std::complex<Real>& factor) {
  const hn::DFromV<V> d;
  const V re = hn::Set(d, factor.real()), im = hn::Set(d, factor.imag());
  return {hn::NegMulAdd(a.im, im, hn::Mul(a.re, re)), hn::MulAdd(a.re, im, hn::Mul(a.im, re))};
}

// Forward transforms of 2 to 8 numbers in registers, in place, in natural order.
template <class V>
HWY_INLINE void transform_2(Lanes<V>& a, Lanes<V>& b) {
  const Lanes<V> sum = a + b;
  b = a - b;
  a = sum;
}

template <class V>
HWY_INLINE void transform_3(Lanes<V>& a, Lanes<V>& b, Lanes<V>& c) {
  using Real = hn::TFromV<V>;
  const hn::DFromV<V> d;
  const Lanes<V> sum = b + c, difference = times(hn::Set(d, Real(0.86602540378443864676)), b - c);
  const Lanes<V> middle = add_times(a, hn::Set(d, Real(-0.5)), sum);
  a = a + sum;
  b = minus_i(middle, difference);
  c = plus_i(middle, difference);
}

template <class V>
HWY_INLINE void transform_4(Lanes<V>& a, Lanes<V>& b, Lanes<V>& c, Lanes<V>& e) {
  const Lanes<V> s = a + c, t = a - c, u = b + e, v = b - e;
  a = s + u;
  b = minus_i(t, v);
  c = s - u;
  e = plus_i(t, v);
}

// cos and sin of 2π·j/radix, j = 1 … (radix − 1)/2
template <int radix>
struct Roots;
template <>
struct Roots<5> {
  static constexpr double cosine[] = {0.30901699437494742410, -0.80901699437494742410};
  static constexpr double sine[] = {0.95105651629515357212, 0.58778525229247312917};
};
template <>
struct Roots<7> {
  static constexpr double cosine[] = {0.62348980185873353053, -0.22252093395631440429, -0.90096886790241912624};
  static constexpr double sine[] = {0.78183148246802980871, 0.97492791218182360702, 0.43388373911755812048};
};
template <>
struct Roots<11> {
  static constexpr double cosine[] = {0.84125353283118116886, 0.41541501300188642553, -0.14231483827328514044,
                                      -0.65486073394528506406, -0.95949297361449738989};
  static constexpr double sine[] = {0.54064081745559758211, 0.90963199535451837141, 0.98982144188093273238,
                                    0.75574957435425828377, 0.28173255684142969771};
};
template <>
struct Roots<13> {
  static constexpr double cosine[] = {0.88545602565320989590,  0.56806474673115580251,  0.12053668025532305335,
                                      -0.35460488704253562597, -0.74851074817110109863, -0.97094181742605202716};
  static constexpr double sine[] = {0.46472317204376854566, 0.82298386589365639458, 0.99270887409805399280,
                                    0.93501624268541482344, 0.66312265824079520238, 0.23931566428755776715};
};

// An odd prime number of samples: the sums and the differences of x[k] and x[radix − k] have real factors.
template <int radix, class V>
HWY_INLINE void transform_odd(Lanes<V>* x) {
  using Real = hn::TFromV<V>;
  const hn::DFromV<V> d;
  constexpr int half = (radix - 1) / 2;
  Lanes<V> sum[half], difference[half];
  for (int k = 0; k < half; ++k) {
    sum[k] = x[k + 1] + x[radix - 1 - k];
    difference[k] = x[k + 1] - x[radix - 1 - k];
  }
  Lanes<V> all = x[0];
  for (int k = 0; k < half; ++k) all = all + sum[k];
  for (int j = 1; j <= half; ++j) {
    Lanes<V> even = x[0], odd = times(hn::Set(d, Real(Roots<radix>::sine[j - 1])), difference[0]);
    for (int k = 1; k <= half; ++k) {
      const int at = j * k % radix, place = (at <= half ? at : radix - at) - 1;
      even = add_times(even, hn::Set(d, Real(Roots<radix>::cosine[place])), sum[k - 1]);
      const double sine = at <= half ? Roots<radix>::sine[place] : -Roots<radix>::sine[place];
      if (k > 1) odd = add_times(odd, hn::Set(d, Real(sine)), difference[k - 1]);
    }
    x[j] = minus_i(even, odd);
    x[radix - j] = plus_i(even, odd);
  }
  x[0] = all;
}

template <int radix, class V>
HWY_INLINE void transform(Lanes<V>* x) {
  using Real = hn::TFromV<V>;
  const hn::DFromV<V> d;
  if constexpr (radix == 2) {
    transform_2(x[0], x[1]);
  } else if constexpr (radix == 3) {
    transform_3(x[0], x[1], x[2]);
  } else if constexpr (radix == 4) {
    transform_4(x[0], x[1], x[2], x[3]);
  } else if constexpr (radix == 6) {
    // 2 × 3 by the Chinese remainder theorem (Good 1958): no twiddle factors
    transform_3(x[0], x[2], x[4]);
    transform_3(x[3], x[5], x[1]);
    transform_2(x[0], x[3]);
    transform_2(x[2], x[5]);  // 4 and 1
    transform_2(x[4], x[1]);  // 2 and 5
    std::swap(x[2], x[4]);
    std::swap(x[1], x[5]);
  } else if constexpr (radix == 8) {
    transform_4(x[0], x[2], x[4], x[6]);
    transform_4(x[1], x[3], x[5], x[7]);
    const V root = hn::Set(d, Real(0.70710678118654752440)), minus_root = hn::Neg(root);
    const Lanes<V> a = x[1], b = minus_i(x[3], x[3]), c = x[5], e = plus_i(x[7], x[7]);
    const Lanes<V> p = x[0], q = x[2], r = x[4], s = x[6];
    x[0] = p + a;
    x[4] = p - a;
    x[1] = add_times(q, root, b);
    x[5] = add_times(q, minus_root, b);
    x[2] = minus_i(r, c);
    x[6] = plus_i(r, c);
    x[3] = add_times(s, minus_root, e);
    x[7] = add_times(s, root, e);
  } else if constexpr (radix > 1) {
    transform_odd<radix>(x);
  }
}

}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
