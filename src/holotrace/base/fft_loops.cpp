// The vector loops of transforms, compiled for every instruction set.

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "holotrace/base/fft_stages.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/base/fft_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/base/fft_radix-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

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

template <size_t width, class Real, int... radices>
void run_one_of(const StageRun<Real>& r, std::integer_sequence<int, radices...>) {
  ((r.stage.radix == radices ? run_in_forms<width, radices>(r) : void()), ...);
}

template <size_t width, class Real>
void run_stage(const StageRun<Real>& r) {
  run_one_of<width>(r, std::integer_sequence<int, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13>());
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
void line(const FftLine<Real>& t, bool swaps, const std::complex<Real>* from, std::complex<Real>* to,
          std::complex<Real>* spaces) {
  const Real* const input = reinterpret_cast<const Real*>(from);
  Real *const output = reinterpret_cast<Real*>(to), *const work = reinterpret_cast<Real*>(spaces);
  const size_t rows = size_t(t.rows), columns = size_t(t.columns), block = line_block<Real>;
  const size_t of_columns = 2 * rows * block;  // numbers of a block of columns
  const size_t spare = 2 * std::max(rows, size_t(whole_blocks(t.columns, line_block<Real>))) * block;
  Real *const a = work, *const b = work + spare, *const c = b + spare, *const blocks = c + spare;
  for (size_t first = 0, at = 0; first < columns; first += block, at += of_columns) {
    FftColumns<const Real> entering{input + 2 * first, t.columns, FftForm::interleaved};
    if (first + block > columns) {
      copy_rows(entering.data, columns, a, block, rows, columns - first);
      entering = {a, line_block<Real>, FftForm::interleaved};
    }
    run_stages<line_block<Real>, Real>(t.along_columns, swaps, entering,
                                       {blocks + at, line_block<Real>, FftForm::apart}, b, c);
  }
  for (size_t first = 0; first < rows; first += block) {
    for (size_t column = 0, at = 0; column < columns; column += block, at += of_columns)
      turn_block(blocks + at, rows, first, t.re.data() + at / 2, t.im.data() + at / 2, a + 2 * column * block);
    const bool is_whole = first + block <= rows;
    const FftColumns<Real> leaving = is_whole ? FftColumns<Real>{output + 2 * first, t.rows, FftForm::interleaved}
                                              : FftColumns<Real>{a, line_block<Real>, FftForm::interleaved};
    run_stages<line_block<Real>, Real>(t.along_rows, swaps, {a, line_block<Real>, FftForm::apart}, leaving, b, c);
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

template <class Real>
void columns(const FftStages<Real>& stages, bool swaps, const std::complex<Real>* input, std::complex<Real>* output,
             std::complex<Real>* work) {
  Real* const to = reinterpret_cast<Real*>(output);
  run_stages<column_block, Real>(stages, swaps,
                                 {reinterpret_cast<const Real*>(input), column_block, FftForm::interleaved},
                                 {to, column_block, FftForm::interleaved}, reinterpret_cast<Real*>(work), to);
}

// Functions of one type each, as dispatching needs them.
void columns_f(const FftStages<float>& stages, bool swaps, const std::complex<float>* input,
               std::complex<float>* output, std::complex<float>* work) {
  columns(stages, swaps, input, output, work);
}
void columns_d(const FftStages<double>& stages, bool swaps, const std::complex<double>* input,
               std::complex<double>* output, std::complex<double>* work) {
  columns(stages, swaps, input, output, work);
}
void line_f(const FftLine<float>& t, bool swaps, const std::complex<float>* input, std::complex<float>* output,
            std::complex<float>* work) {
  line(t, swaps, input, output, work);
}
void line_d(const FftLine<double>& t, bool swaps, const std::complex<double>* input, std::complex<double>* output,
            std::complex<double>* work) {
  line(t, swaps, input, output, work);
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

}  // namespace

template <>
void transform_columns(const FftStages<float>& stages, bool is_backward, const std::complex<float>* input,
                       std::complex<float>* output, std::complex<float>* work) {
  HWY_DYNAMIC_DISPATCH(columns_f)(stages, is_backward, input, output, work);
}
template <>
void transform_columns(const FftStages<double>& stages, bool is_backward, const std::complex<double>* input,
                       std::complex<double>* output, std::complex<double>* work) {
  HWY_DYNAMIC_DISPATCH(columns_d)(stages, is_backward, input, output, work);
}

template <>
void transform_line(const FftLine<float>& line, bool is_backward, const std::complex<float>* input,
                    std::complex<float>* output, std::complex<float>* work) {
  HWY_DYNAMIC_DISPATCH(line_f)(line, is_backward, input, output, work);
}
template <>
void transform_line(const FftLine<double>& line, bool is_backward, const std::complex<double>* input,
                    std::complex<double>* output, std::complex<double>* work) {
  HWY_DYNAMIC_DISPATCH(line_d)(line, is_backward, input, output, work);
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

}  // namespace holotrace

#endif
