#include "holotrace/base/fft_stages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/base/fft_stages.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

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

template <FftForm form, class D, class Real = hn::TFromD<D>>
HWY_INLINE Lanes<hn::Vec<D>> load(D d, const Real* from, bool swaps) {
  Lanes<hn::Vec<D>> x;
  if constexpr (form == FftForm::interleaved) {
    hn::LoadInterleaved2(d, from, x.re, x.im);
    if (swaps) std::swap(x.re, x.im);
  } else {
    x = {hn::Load(d, from), hn::Load(d, from + hn::Lanes(d))};
  }
  return x;
}

template <FftForm form, class D, class Real = hn::TFromD<D>>
HWY_INLINE void store(D d, Lanes<hn::Vec<D>> x, Real* to, bool swaps) {
  if constexpr (form == FftForm::interleaved) {
    if (swaps) std::swap(x.re, x.im);
    hn::StoreInterleaved2(x.re, x.im, d, to);
  } else {
    hn::Store(x.re, d, to);
    hn::Store(x.im, d, to + hn::Lanes(d));
  }
}

// A stage of a block of columns.
template <class Real>
struct StageRun {
  const typename FftStages<Real>::Stage& stage;
  const std::complex<Real>* twiddles;
  bool swaps;
  FftColumns<const Real> from;
  FftColumns<Real> to;
};

template <size_t width, int radix, FftForm enters, FftForm leaves, class Real>
void run(const StageRun<Real>& r) {
  const hn::CappedTag<Real, size_t(column_block)> d;
  const size_t lanes = hn::Lanes(d), groups = size_t(r.stage.groups), inner = size_t(r.stage.inner);
  const size_t row_in = 2 * size_t(r.from.stride), row_out = 2 * size_t(r.to.stride);
  const size_t apart = groups * inner * row_in;  // between the samples of one small transform
  for (size_t group = 0; group < groups; ++group) {
    const std::complex<Real>* factors = r.twiddles + r.stage.first_twiddle + group * (radix - 1);
    const Real* in = r.from.data + group * inner * row_in;
    Real* out = r.to.data + group * inner * radix * row_out;
    for (size_t i = 0; i < inner; ++i, in += row_in, out += row_out)
      for (size_t column = 0; column < width; column += lanes) {
        Lanes<hn::Vec<decltype(d)>> x[radix];
        for (size_t k = 0; k < radix; ++k) x[k] = load<enters>(d, in + k * apart + 2 * column, r.swaps);
        transform<radix>(x);
        if (group > 0)
          for (size_t k = 1; k < radix; ++k) x[k] = times(x[k], factors[k - 1]);
        for (size_t k = 0; k < radix; ++k) store<leaves>(d, x[k], out + k * inner * row_out + 2 * column, r.swaps);
      }
  }
}

template <size_t width, int radix, class Real>
void run_in_forms(const StageRun<Real>& r) {
  if (r.from.form == FftForm::interleaved)
    run<width, radix, FftForm::interleaved, FftForm::apart>(r);
  else if (r.to.form == FftForm::interleaved)
    run<width, radix, FftForm::apart, FftForm::interleaved>(r);
  else
    run<width, radix, FftForm::apart, FftForm::apart>(r);
}

template <size_t width, class Real>
void run_stage(const StageRun<Real>& r) {
  switch (r.stage.radix) {
    case 1:
      return run_in_forms<width, 1>(r);
    case 2:
      return run_in_forms<width, 2>(r);
    case 3:
      return run_in_forms<width, 3>(r);
    case 4:
      return run_in_forms<width, 4>(r);
    case 5:
      return run_in_forms<width, 5>(r);
    case 6:
      return run_in_forms<width, 6>(r);
    case 7:
      return run_in_forms<width, 7>(r);
    case 8:
      return run_in_forms<width, 8>(r);
    case 11:
      return run_in_forms<width, 11>(r);
    default:
      return run_in_forms<width, 13>(r);
  }
}

// Lane j of x[i] and lane i of x[j] change places, for as many vectors as lanes: first the lanes in blocks of 128 bits, then
// the blocks.
template <class V>
HWY_INLINE void transpose(V* x) {
#if HWY_TARGET != HWY_SCALAR
  using Real = hn::TFromV<V>;
  const hn::DFromV<V> d;
  constexpr size_t lanes = hn::MaxLanes(hn::DFromV<V>()), in_block = std::min(lanes, 16 / sizeof(Real));
  for (size_t first = 0; first < lanes; first += in_block) {
    V* const y = x + first;
    if constexpr (in_block == 4) {
      const hn::Repartition<double, decltype(d)> pairs;
      const auto a = hn::BitCast(pairs, hn::InterleaveLower(d, y[0], y[1]));
      const auto b = hn::BitCast(pairs, hn::InterleaveUpper(d, y[0], y[1]));
      const auto e = hn::BitCast(pairs, hn::InterleaveLower(d, y[2], y[3]));
      const auto f = hn::BitCast(pairs, hn::InterleaveUpper(d, y[2], y[3]));
      y[0] = hn::BitCast(d, hn::InterleaveLower(pairs, a, e));
      y[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, a, e));
      y[2] = hn::BitCast(d, hn::InterleaveLower(pairs, b, f));
      y[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, b, f));
    } else if constexpr (in_block == 2) {
      const V a = hn::InterleaveLower(d, y[0], y[1]);
      y[1] = hn::InterleaveUpper(d, y[0], y[1]);
      y[0] = a;
    }
  }
  constexpr size_t blocks = lanes / in_block;
  const auto exchange_halves = [&](V& a, V& b) {
    const V lower = hn::ConcatLowerLower(d, b, a);
    b = hn::ConcatUpperUpper(d, b, a);
    a = lower;
  };
  for (size_t i = 0; i < in_block; ++i) {
    V* const y = x + i;
    if constexpr (blocks == 2) {
      exchange_halves(y[0], y[in_block]);
    } else if constexpr (blocks == 4) {
      exchange_halves(y[0], y[2 * in_block]);
      exchange_halves(y[in_block], y[3 * in_block]);
      for (const size_t at : {size_t(0), 2 * in_block}) {
        V &a = y[at], &b = y[at + in_block];
        const V even = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b), a);
        b = hn::OddEvenBlocks(b, hn::SwapAdjacentBlocks(a));
        a = even;
      }
    }
  }
  static_assert(blocks == 1 || blocks == 2 || blocks == 4);
#else
  static_cast<void>(x);  // one lane
#endif
}

// All stages of a block of columns.
template <size_t width, class Real>
void run_stages(const FftStages<Real>& all, bool swaps, const FftColumns<const Real>& from, const FftColumns<Real>& to,
                Real* spare, Real* other) {
  const size_t count = all.stages.size();
  FftColumns<const Real> in = from;
  for (size_t s = 0; s + 1 < count; ++s) {
    const FftColumns<Real> out{(count - 2 - s) % 2 == 0 ? spare : other, width, FftForm::apart};
    run_stage<width, Real>({all.stages[s], all.twiddles.data(), swaps, in, out});
    in = {out.data, width, FftForm::apart};
  }
  run_stage<width, Real>({all.stages[count - 1], all.twiddles.data(), swaps, in, to});
}

// to[c][r] = from[r][c]·factors[r][c] for a block of columns from row `first` on, and as many rows. What is beyond the last
// row is not used.
template <class Real>
void turn_block(const Real* from, size_t rows, size_t first, const Real* re, const Real* im, Real* to) {
  const hn::CappedTag<Real, line_block<Real>> d;
  constexpr size_t lanes = hn::MaxLanes(d);
  for (size_t r = 0; r < line_block<Real>; r += lanes)
    for (size_t c = 0; c < line_block<Real>; c += lanes) {
      hn::Vec<decltype(d)> x[lanes], y[lanes];
      for (size_t i = 0; i < lanes; ++i) {
        const size_t at = std::min(first + r + i, rows - 1) * line_block<Real> + c;
        const auto a = hn::Load(d, from + 2 * at), b = hn::Load(d, from + 2 * at + lanes);
        const auto p = hn::Load(d, re + at), q = hn::Load(d, im + at);
        x[i] = hn::NegMulAdd(b, q, hn::Mul(a, p));
        y[i] = hn::MulAdd(a, q, hn::Mul(b, p));
      }
      transpose(x);
      transpose(y);
      for (size_t i = 0; i < lanes; ++i) {
        Real* const row = to + 2 * ((c + i) * line_block<Real> + r);
        hn::Store(x[i], d, row);
        hn::Store(y[i], d, row + lanes);
      }
    }
}

// Copies the first columns of rows of complex numbers between memory of different widths.
template <class Real>
void copy_rows(const Real* from, size_t from_width, Real* to, size_t to_width, size_t rows, size_t columns) {
  for (size_t r = 0; r < rows; ++r) std::copy_n(from + 2 * r * from_width, 2 * columns, to + 2 * r * to_width);
}

template <class Real>
void line(const FftLine<Real>& t, bool swaps, const Real* input, Real* output, Real* work) {
  const size_t rows = size_t(t.rows), columns = size_t(t.columns), block = line_block<Real>;
  const size_t of_columns = 2 * rows * block;  // numbers of a block of columns
  const size_t spare = 2 * std::max(rows, (columns + block - 1) / block * block) * block;
  Real *const a = work, *const b = work + spare, *const c = b + spare, *const blocks = c + spare;
  for (size_t first = 0, at = 0; first < columns; first += block, at += of_columns) {
    FftColumns<const Real> from{input + 2 * first, t.columns, FftForm::interleaved};
    if (first + block > columns) {
      copy_rows(from.data, columns, a, block, rows, columns - first);
      from = {a, line_block<Real>, FftForm::interleaved};
    }
    run_stages<line_block<Real>, Real>(t.along_columns, swaps, from, {blocks + at, line_block<Real>, FftForm::apart}, b,
                                       c);
  }
  for (size_t first = 0; first < rows; first += block) {
    for (size_t column = 0, at = 0; column < columns; column += block, at += of_columns)
      turn_block(blocks + at, rows, first, t.re.data() + at / 2, t.im.data() + at / 2, a + 2 * column * block);
    const bool is_whole = first + block <= rows;
    const FftColumns<Real> to = is_whole ? FftColumns<Real>{output + 2 * first, t.rows, FftForm::interleaved}
                                         : FftColumns<Real>{a, line_block<Real>, FftForm::interleaved};
    run_stages<line_block<Real>, Real>(t.along_rows, swaps, {a, line_block<Real>, FftForm::apart}, to, b, c);
    if (!is_whole) copy_rows(a, block, output + 2 * first, rows, columns, rows - first);
  }
}

// A complex number of floats is one lane of 64 bits.
void turn_pairs(const double* const* columns, size_t count, double* rows) {
  const hn::CappedTag<double, 8> d;
  constexpr size_t lanes = hn::MaxLanes(d);
  size_t first = 0;
  for (; first + lanes <= count; first += lanes)
    for (size_t c = 0; c < column_block; c += lanes) {
      hn::Vec<decltype(d)> x[lanes];
      for (size_t i = 0; i < lanes; ++i) x[i] = hn::LoadU(d, columns[c + i] + first);
      transpose(x);
      for (size_t i = 0; i < lanes; ++i) hn::StoreU(x[i], d, rows + (first + i) * column_block + c);
    }
  for (; first < count; ++first)
    for (size_t c = 0; c < column_block; ++c) rows[first * column_block + c] = columns[c][first];
}

void columns_f(const FftStages<float>& stages, bool swaps, const float* from, float* to, float* work) {
  run_stages<column_block, float>(stages, swaps, {from, column_block, FftForm::interleaved},
                                  {to, column_block, FftForm::interleaved}, work, to);
}
void columns_d(const FftStages<double>& stages, bool swaps, const double* from, double* to, double* work) {
  run_stages<column_block, double>(stages, swaps, {from, column_block, FftForm::interleaved},
                                   {to, column_block, FftForm::interleaved}, work, to);
}
void line_f(const FftLine<float>& t, bool swaps, const float* from, float* to, float* work) {
  line(t, swaps, from, to, work);
}
void line_d(const FftLine<double>& t, bool swaps, const double* from, double* to, double* work) {
  line(t, swaps, from, to, work);
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {

HWY_EXPORT(columns_f);
HWY_EXPORT(columns_d);
HWY_EXPORT(line_f);
HWY_EXPORT(line_d);
HWY_EXPORT(turn_pairs);

struct RadixCost {
  int radix;
  double cost;
};
// Times of a stage per sample, relative to each other, measured for lengths of 1000 to 4000: about 0.17 ns with AVX-512.
constexpr std::array<RadixCost, 9> radix_costs{
    {{8, 1}, {6, 0.9}, {5, 0.9}, {4, 0.8}, {3, 0.75}, {2, 0.7}, {7, 1.2}, {11, 2}, {13, 2.5}}};

constexpr double copy_cost = 0.6;  // of a stage that only copies, of which a length of one stage has one

// The radices whose stages cost least together; an infinite cost if the length has other factors.
struct Radices {
  double cost = std::numeric_limits<double>::infinity();
  std::vector<int> radices;
};
const Radices& cheapest(int length) {
  thread_local std::map<int, Radices> known;
  const auto [at, is_new] = known.try_emplace(length);
  if (!is_new) return at->second;
  Radices best;
  if (length == 1) best.cost = 0;
  for (const RadixCost& r : radix_costs) {
    if (length % r.radix != 0) continue;
    const Radices& rest = cheapest(length / r.radix);
    if (rest.cost + r.cost >= best.cost) continue;
    best = rest;
    best.cost += r.cost;
    best.radices.push_back(r.radix);
  }
  return known[length] = best;
}

}  // namespace

double fft_stages_cost(int length) {
  const Radices& best = cheapest(length);
  return best.cost + copy_cost * double(2 - std::min<size_t>(2, best.radices.size()));
}

std::complex<double> root_of_unity(int64_t k, int64_t n) {
  const int64_t eighth = 8 * k / n, rest = 8 * k % n;  // an angle of at most π/4 is exact to half an epsilon
  const double angle = pi / 4 * double(eighth % 2 == 0 ? rest : n - rest) / double(n);
  double c = std::cos(angle), s = std::sin(angle);
  if (eighth % 4 == 1 || eighth % 4 == 2) std::swap(c, s);
  if (eighth >= 2 && eighth < 6) c = -c;
  if (eighth < 4) s = -s;
  return {c, s};
}

template <class Real>
FftStages<Real>::FftStages(int length) : length(length) {
  const Radices& best = cheapest(length);
  require(std::isfinite(best.cost), "a transform of {} samples cannot be done in stages", length);
  int left = length, inner = 1;
  for (const int radix : best.radices) {
    const int groups = left / radix;
    stages.push_back({radix, groups, inner, twiddles.size()});
    for (int64_t group = 0; group < groups; ++group)
      for (int64_t k = 1; k < radix; ++k) twiddles.push_back(std::complex<Real>(root_of_unity(group * k % left, left)));
    left = groups;
    inner *= radix;
  }
  while (stages.size() < 2) stages.push_back({1, 1, length, 0});  // each changes the form of one side
}

namespace {

int whole_blocks(int columns, int block) { return (columns + block - 1) / block * block; }

// The rectangle of a line, with blocks of columns, for which the work is least.
struct Rectangle {
  int rows = 1;
  double cost = std::numeric_limits<double>::infinity();  // of the stages per sample
};
Rectangle best_rectangle(int length, int block) {
  Rectangle best;
  double least = std::numeric_limits<double>::infinity();
  for (int rows = 1; rows <= length; ++rows) {
    if (length % rows != 0) continue;
    const int columns = length / rows;
    const double down = fft_stages_cost(rows) * rows * whole_blocks(columns, block);
    const double across = fft_stages_cost(columns) * columns * whole_blocks(rows, block);
    const double cost = (down + across) / length;
    constexpr double worth = 0.01;  // of squares, whose tables are small
    const double weighed = cost * (1 + worth * std::abs(std::log2(double(rows) / columns)));
    if (weighed < least) {
      least = weighed;
      best = {rows, cost};
    }
  }
  return best;
}

}  // namespace

template <class Real>
FftLine<Real>::FftLine(int length)
    : rows(best_rectangle(length, line_block<Real>).rows),
      columns(length / rows),
      along_columns(rows),
      along_rows(columns) {
  for (int first = 0; first < columns; first += line_block<Real>)
    for (int64_t k = 0; k < rows; ++k)
      for (int64_t c = first; c < first + line_block<Real>; ++c) {
        const std::complex<double> factor = root_of_unity(k * c % length, length);
        re.push_back(Real(factor.real()));
        im.push_back(Real(factor.imag()));
      }
}

template <class Real>
size_t FftLine<Real>::work_size() const {
  const auto of_columns = size_t(whole_blocks(columns, line_block<Real>));
  return of_columns * size_t(rows) + 3 * line_block<Real> * std::max(size_t(rows), of_columns);
}

double fft_line_cost(int length) { return best_rectangle(length, line_block<float>).cost; }

template <>
void transform_columns(const FftStages<float>& stages, bool is_backward, const std::complex<float>* input,
                       std::complex<float>* output, std::complex<float>* work) {
  HWY_DYNAMIC_DISPATCH(columns_f)
  (stages, is_backward, reinterpret_cast<const float*>(input), reinterpret_cast<float*>(output),
   reinterpret_cast<float*>(work));
}
template <>
void transform_columns(const FftStages<double>& stages, bool is_backward, const std::complex<double>* input,
                       std::complex<double>* output, std::complex<double>* work) {
  HWY_DYNAMIC_DISPATCH(columns_d)
  (stages, is_backward, reinterpret_cast<const double*>(input), reinterpret_cast<double*>(output),
   reinterpret_cast<double*>(work));
}

template <>
void transform_line(const FftLine<float>& line, bool is_backward, const std::complex<float>* input,
                    std::complex<float>* output, std::complex<float>* work) {
  HWY_DYNAMIC_DISPATCH(line_f)
  (line, is_backward, reinterpret_cast<const float*>(input), reinterpret_cast<float*>(output),
   reinterpret_cast<float*>(work));
}
template <>
void transform_line(const FftLine<double>& line, bool is_backward, const std::complex<double>* input,
                    std::complex<double>* output, std::complex<double>* work) {
  HWY_DYNAMIC_DISPATCH(line_d)
  (line, is_backward, reinterpret_cast<const double*>(input), reinterpret_cast<double*>(output),
   reinterpret_cast<double*>(work));
}

void turn_to_rows(const std::array<const std::complex<float>*, column_block>& columns, int count,
                  std::complex<float>* rows) {
  std::array<const double*, column_block> pairs;
  for (size_t c = 0; c < pairs.size(); ++c) pairs[c] = reinterpret_cast<const double*>(columns[c]);
  HWY_DYNAMIC_DISPATCH(turn_pairs)(pairs.data(), size_t(count), reinterpret_cast<double*>(rows));
}

void turn_to_rows(const std::array<const std::complex<double>*, column_block>& columns, int count,
                  std::complex<double>* rows) {
  for (int i = 0; i < count; ++i)
    for (int c = 0; c < column_block; ++c) rows[i * column_block + c] = columns[size_t(c)][i];
}

template struct FftStages<float>;
template struct FftStages<double>;
template struct FftLine<float>;
template struct FftLine<double>;

}  // namespace holotrace

#endif
