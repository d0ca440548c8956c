#include "holotrace/base/column_fft.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/base/column_fft.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t columns = column_block, row = 2 * columns;  // row: numbers of a sample of all columns

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
  } else if constexpr (radix == 5) {
    // cos and sin of 72° and 144°
    const V c1 = hn::Set(d, Real(0.30901699437494742410)), c2 = hn::Set(d, Real(-0.80901699437494742410));
    const V s1 = hn::Set(d, Real(0.95105651629515357212)), s2 = hn::Set(d, Real(0.58778525229247312917));
    const Lanes<V> a = x[1] + x[4], b = x[2] + x[3], p = x[1] - x[4], q = x[2] - x[3];
    const Lanes<V> near = add_times(add_times(x[0], c1, a), c2, b), far = add_times(add_times(x[0], c2, a), c1, b);
    const Lanes<V> near_odd = add_times(times(s1, p), s2, q), far_odd = add_times(times(s2, p), hn::Neg(s1), q);
    x[0] = x[0] + a + b;
    x[1] = minus_i(near, near_odd);
    x[2] = minus_i(far, far_odd);
    x[3] = plus_i(far, far_odd);
    x[4] = plus_i(near, near_odd);
  } else if constexpr (radix == 6) {
    // 2 × 3 by the Chinese remainder theorem (Good 1958): no twiddle factors
    transform_3(x[0], x[2], x[4]);
    transform_3(x[3], x[5], x[1]);
    transform_2(x[0], x[3]);
    transform_2(x[2], x[5]);  // 4 and 1
    transform_2(x[4], x[1]);  // 2 and 5
    std::swap(x[2], x[4]);
    std::swap(x[1], x[5]);
  } else {
    static_assert(radix == 8);
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
  }
}

// How a stage finds its samples, and how it leaves them: between stages, a row is the real parts and the imaginary parts of
// a group of lanes, then those of the next.
enum class Form { interleaved, apart };

// The real and the imaginary parts change places for a backward transform, which is a forward one between two swaps.
template <Form form, class D, class Real = hn::TFromD<D>>
HWY_INLINE Lanes<hn::Vec<D>> load(D d, const Real* from, bool swaps) {
  Lanes<hn::Vec<D>> x;
  if constexpr (form == Form::interleaved) {
    hn::LoadInterleaved2(d, from, x.re, x.im);
    if (swaps) std::swap(x.re, x.im);
  } else {
    x = {hn::Load(d, from), hn::Load(d, from + hn::Lanes(d))};
  }
  return x;
}

template <Form form, class D, class Real = hn::TFromD<D>>
HWY_INLINE void store(D d, Lanes<hn::Vec<D>> x, Real* to, bool swaps) {
  if constexpr (form == Form::interleaved) {
    if (swaps) std::swap(x.re, x.im);
    hn::StoreInterleaved2(x.re, x.im, d, to);
  } else {
    hn::Store(x.re, d, to);
    hn::Store(x.im, d, to + hn::Lanes(d));
  }
}

template <int radix, Form enters, Form leaves, class Real>
void run(const typename ColumnFft<Real>::Stage& stage, const std::complex<Real>* twiddles, bool swaps, const Real* from,
         Real* to) {
  const hn::CappedTag<Real, columns> d;
  const size_t lanes = hn::Lanes(d), groups = size_t(stage.groups), inner = size_t(stage.inner);
  const size_t apart = groups * inner * row;  // between the samples of one small transform
  for (size_t lane = 0; lane < columns; lane += lanes)
    for (size_t group = 0; group < groups; ++group) {
      const std::complex<Real>* factors = twiddles + stage.first_twiddle + group * (radix - 1);
      const Real* in = from + group * inner * row + 2 * lane;
      Real* out = to + group * inner * radix * row + 2 * lane;
      for (size_t i = 0; i < inner; ++i, in += row, out += row) {
        Lanes<hn::Vec<decltype(d)>> x[radix];
        for (size_t k = 0; k < radix; ++k) x[k] = load<enters>(d, in + k * apart, swaps);
        transform<radix>(x);
        if (group > 0)
          for (size_t k = 1; k < radix; ++k) x[k] = times(x[k], factors[k - 1]);
        for (size_t k = 0; k < radix; ++k) store<leaves>(d, x[k], out + k * inner * row, swaps);
      }
    }
}

template <int radix, class Real>
void run_in_forms(const typename ColumnFft<Real>::Stage& stage, const std::complex<Real>* twiddles, bool is_first,
                  bool is_last, bool swaps, const Real* from, Real* to) {
  if (is_first)
    run<radix, Form::interleaved, Form::apart>(stage, twiddles, swaps, from, to);
  else if (is_last)
    run<radix, Form::apart, Form::interleaved>(stage, twiddles, swaps, from, to);
  else
    run<radix, Form::apart, Form::apart>(stage, twiddles, swaps, from, to);
}

template <class Real>
void run_stages(const std::vector<typename ColumnFft<Real>::Stage>& stages, const std::complex<Real>* twiddles,
                bool swaps, const Real* input, Real* output, Real* work) {
  const Real* from = input;
  for (size_t s = 0; s < stages.size(); ++s) {
    const bool is_first = s == 0, is_last = s + 1 == stages.size();
    Real* to = (stages.size() - 1 - s) % 2 == 0 ? output : work;
    const auto go = [&]<int radix>(std::integral_constant<int, radix>) {
      run_in_forms<radix>(stages[s], twiddles, is_first, is_last, swaps, from, to);
    };
    switch (stages[s].radix) {
      case 2:
        go(std::integral_constant<int, 2>());
        break;
      case 3:
        go(std::integral_constant<int, 3>());
        break;
      case 4:
        go(std::integral_constant<int, 4>());
        break;
      case 5:
        go(std::integral_constant<int, 5>());
        break;
      case 6:
        go(std::integral_constant<int, 6>());
        break;
      default:
        go(std::integral_constant<int, 8>());
    }
    from = to;
  }
}

void stages_f(const std::vector<ColumnFft<float>::Stage>& stages, const std::complex<float>* twiddles, bool swaps,
              const float* input, float* output, float* work) {
  run_stages<float>(stages, twiddles, swaps, input, output, work);
}
void stages_d(const std::vector<ColumnFft<double>::Stage>& stages, const std::complex<double>* twiddles, bool swaps,
              const double* input, double* output, double* work) {
  run_stages<double>(stages, twiddles, swaps, input, output, work);
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {

HWY_EXPORT(stages_f);
HWY_EXPORT(stages_d);

void dispatch(const std::vector<ColumnFft<float>::Stage>& stages, const std::complex<float>* twiddles, bool swaps,
              const float* input, float* output, float* work) {
  HWY_DYNAMIC_DISPATCH(stages_f)(stages, twiddles, swaps, input, output, work);
}
void dispatch(const std::vector<ColumnFft<double>::Stage>& stages, const std::complex<double>* twiddles, bool swaps,
              const double* input, double* output, double* work) {
  HWY_DYNAMIC_DISPATCH(stages_d)(stages, twiddles, swaps, input, output, work);
}

struct RadixCost {
  int radix;
  double cost;
};
// Times of a stage per sample, relative to each other, measured for lengths of 1000 to 4000.
constexpr std::array<RadixCost, 6> radix_costs{{{8, 1}, {6, 0.9}, {5, 0.9}, {4, 0.8}, {3, 0.75}, {2, 0.7}}};

// The radices whose stages cost least together; none if the length has other factors.
struct Radices {
  double cost = std::numeric_limits<double>::infinity();
  std::vector<int> radices;
};
const Radices& cheapest(int length, std::map<int, Radices>& known) {
  const auto [at, is_new] = known.try_emplace(length);
  if (!is_new) return at->second;
  Radices best;
  if (length == 1) best.cost = 0;
  for (const RadixCost& r : radix_costs) {
    if (length % r.radix != 0) continue;
    const Radices& rest = cheapest(length / r.radix, known);
    if (rest.cost + r.cost >= best.cost) continue;
    best = rest;
    best.cost += r.cost;
    best.radices.push_back(r.radix);
  }
  return known[length] = best;
}

}  // namespace

template <class Real>
ColumnFft<Real>::ColumnFft(int length) : length_(length) {
  require(length >= 1, "expected a transform of at least 1 sample, got {}", length);
  std::map<int, Radices> known;
  int left = length, inner = 1;
  for (const int radix : cheapest(length, known).radices) {
    const int groups = left / radix;
    stages_.push_back({radix, groups, inner, twiddles_.size()});
    for (int group = 0; group < groups; ++group)
      for (int k = 1; k < radix; ++k) twiddles_.push_back(std::complex<Real>(cis_cycles(-double(group) * k / left)));
    left = groups;
    inner *= radix;
  }
  if (left == 1 && stages_.size() > 1) return;
  stages_.clear();
  const FftLayout layout{column_block, column_block, 1, 1, length};  // columns become contiguous
  forward_.emplace(length, layout, FftDirection::forward);
  backward_.emplace(length, layout, FftDirection::backward);
}

template <class Real>
void ColumnFft<Real>::operator()(FftDirection direction, const std::complex<Real>* input, std::complex<Real>* output,
                                 std::complex<Real>* work) const {
  const bool is_forward = direction == FftDirection::forward;
  if (!stages_.empty())
    return dispatch(stages_, twiddles_.data(), !is_forward, reinterpret_cast<const Real*>(input),
                    reinterpret_cast<Real*>(output), reinterpret_cast<Real*>(work));
  (is_forward ? *forward_ : *backward_)(input, work);
  std::array<const std::complex<Real>*, column_block> columns;
  for (size_t c = 0; c < columns.size(); ++c) columns[c] = work + c * size_t(length_);
  turn_to_rows(columns, length_, output);
}

template class ColumnFft<float>;
template class ColumnFft<double>;

}  // namespace holotrace

#endif
