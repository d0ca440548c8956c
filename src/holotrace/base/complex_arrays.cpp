#include "holotrace/base/complex_arrays.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/base/complex_arrays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR
// (aᵣ + i·aᵢ)·(bᵣ + i·bᵢ) + c for numbers stored as re, im, re, im, …
template <class V>
HWY_INLINE V multiply_add(V a, V b, V c) {
  const V crossed = hn::Mul(hn::DupOdd(a), hn::Reverse2(hn::DFromV<V>(), b));
  const V straight = hn::MulAdd(hn::DupEven(a), b, c);
  return hn::OddEven(hn::Add(straight, crossed), hn::Sub(straight, crossed));
}
#endif

// to = a·b, or to += a·b; with b_is_one, b is one number that multiplies the whole array; conjugates: conj(b) for b.
template <bool adds, bool b_is_one, bool conjugates, class Real>
HWY_INLINE void loop(Real* to, const Real* a, const Real* b, size_t reals) {
  size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  using Tag = hn::ScalableTag<Real>;
  const Tag d;
  const size_t lanes = hn::Lanes(d);
  const hn::Vec<Tag> one = hn::OddEven(hn::Set(d, b[1]), hn::Set(d, b[0]));
  for (; i + lanes <= reals; i += lanes) {
    const auto c = adds ? hn::LoadU(d, to + i) : hn::Zero(d);
    hn::Vec<Tag> factor = b_is_one ? one : hn::LoadU(d, b + i);
    if (conjugates) factor = hn::OddEven(hn::Neg(factor), factor);
    hn::StoreU(multiply_add(hn::LoadU(d, a + i), factor, c), d, to + i);
  }
#endif
  for (; i < reals; i += 2) {
    const Real br = b[b_is_one ? 0 : i], bi = (conjugates ? -1 : 1) * b[b_is_one ? 1 : i + 1];
    const Real re = a[i] * br - a[i + 1] * bi, im = a[i] * bi + a[i + 1] * br;
    to[i] = adds ? to[i] + re : re;
    to[i + 1] = adds ? to[i + 1] + im : im;
  }
}

template <bool adds, bool conjugates, class Real>
void product(Real* to, const Real* a, const Real* b, size_t count) {
  if (count > 0) loop<adds, false, conjugates>(to, a, b, 2 * count);
}

template <bool adds, class Real>
void row_product(Real* to, const Real* a, const Real* factor, size_t rows, size_t width) {
  for (size_t row = 0; row < rows; ++row)
    loop<adds, true, false>(to + 2 * row * width, a + 2 * row * width, factor + 2 * row, 2 * width);
}

void product_f(float* to, const float* a, const float* b, size_t n) { product<false, false>(to, a, b, n); }
void product_d(double* to, const double* a, const double* b, size_t n) { product<false, false>(to, a, b, n); }
void product_add_f(float* to, const float* a, const float* b, size_t n) { product<true, false>(to, a, b, n); }
void product_add_d(double* to, const double* a, const double* b, size_t n) { product<true, false>(to, a, b, n); }
void conjugate_f(float* to, const float* a, const float* b, size_t n) { product<false, true>(to, a, b, n); }
void conjugate_d(double* to, const double* a, const double* b, size_t n) { product<false, true>(to, a, b, n); }
void conjugate_add_f(float* to, const float* a, const float* b, size_t n) { product<true, true>(to, a, b, n); }
void conjugate_add_d(double* to, const double* a, const double* b, size_t n) { product<true, true>(to, a, b, n); }
void rows_f(float* to, const float* a, const float* f, size_t n, size_t w) { row_product<false>(to, a, f, n, w); }
void rows_d(double* to, const double* a, const double* f, size_t n, size_t w) { row_product<false>(to, a, f, n, w); }
void rows_add_f(float* to, const float* a, const float* f, size_t n, size_t w) { row_product<true>(to, a, f, n, w); }
void rows_add_d(double* to, const double* a, const double* f, size_t n, size_t w) { row_product<true>(to, a, f, n, w); }

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {

HWY_EXPORT(product_f);
HWY_EXPORT(product_d);
HWY_EXPORT(product_add_f);
HWY_EXPORT(product_add_d);
HWY_EXPORT(conjugate_f);
HWY_EXPORT(conjugate_d);
HWY_EXPORT(conjugate_add_f);
HWY_EXPORT(conjugate_add_d);
HWY_EXPORT(rows_f);
HWY_EXPORT(rows_d);
HWY_EXPORT(rows_add_f);
HWY_EXPORT(rows_add_d);

template <class Real>
Real* reals(std::complex<Real>* a) {
  return reinterpret_cast<Real*>(a);
}
template <class Real>
const Real* reals(const std::complex<Real>* a) {
  return reinterpret_cast<const Real*>(a);
}

}  // namespace

template <>
void multiply(std::complex<float>* to, const std::complex<float>* a, const std::complex<float>* b, size_t count) {
  HWY_DYNAMIC_DISPATCH(product_f)(reals(to), reals(a), reals(b), count);
}
template <>
void multiply(std::complex<double>* to, const std::complex<double>* a, const std::complex<double>* b, size_t count) {
  HWY_DYNAMIC_DISPATCH(product_d)(reals(to), reals(a), reals(b), count);
}
template <>
void multiply_add(std::complex<float>* to, const std::complex<float>* a, const std::complex<float>* b, size_t count) {
  HWY_DYNAMIC_DISPATCH(product_add_f)(reals(to), reals(a), reals(b), count);
}
template <>
void multiply_add(std::complex<double>* to, const std::complex<double>* a, const std::complex<double>* b,
                  size_t count) {
  HWY_DYNAMIC_DISPATCH(product_add_d)(reals(to), reals(a), reals(b), count);
}
template <>
void multiply_conjugate(std::complex<float>* to, const std::complex<float>* a, const std::complex<float>* b,
                        size_t count) {
  HWY_DYNAMIC_DISPATCH(conjugate_f)(reals(to), reals(a), reals(b), count);
}
template <>
void multiply_conjugate(std::complex<double>* to, const std::complex<double>* a, const std::complex<double>* b,
                        size_t count) {
  HWY_DYNAMIC_DISPATCH(conjugate_d)(reals(to), reals(a), reals(b), count);
}
template <>
void multiply_conjugate_add(std::complex<float>* to, const std::complex<float>* a, const std::complex<float>* b,
                            size_t count) {
  HWY_DYNAMIC_DISPATCH(conjugate_add_f)(reals(to), reals(a), reals(b), count);
}
template <>
void multiply_conjugate_add(std::complex<double>* to, const std::complex<double>* a, const std::complex<double>* b,
                            size_t count) {
  HWY_DYNAMIC_DISPATCH(conjugate_add_d)(reals(to), reals(a), reals(b), count);
}
template <>
void multiply_rows(std::complex<float>* to, const std::complex<float>* a, const std::complex<float>* factor,
                   size_t rows, size_t width) {
  HWY_DYNAMIC_DISPATCH(rows_f)(reals(to), reals(a), reals(factor), rows, width);
}
template <>
void multiply_rows(std::complex<double>* to, const std::complex<double>* a, const std::complex<double>* factor,
                   size_t rows, size_t width) {
  HWY_DYNAMIC_DISPATCH(rows_d)(reals(to), reals(a), reals(factor), rows, width);
}
template <>
void multiply_add_rows(std::complex<float>* to, const std::complex<float>* a, const std::complex<float>* factor,
                       size_t rows, size_t width) {
  HWY_DYNAMIC_DISPATCH(rows_add_f)(reals(to), reals(a), reals(factor), rows, width);
}
template <>
void multiply_add_rows(std::complex<double>* to, const std::complex<double>* a, const std::complex<double>* factor,
                       size_t rows, size_t width) {
  HWY_DYNAMIC_DISPATCH(rows_add_d)(reals(to), reals(a), reals(factor), rows, width);
}

template <class Real>
double energy(const std::complex<Real>* a, size_t count) {
  constexpr size_t lanes = 8;  // independent partial sums, so that no addition waits for the one before
  double sums[lanes] = {};
  const Real* x = reals(a);
  const size_t n = 2 * count, whole = n - n % lanes;
  for (size_t i = 0; i < whole; i += lanes)
    for (size_t l = 0; l < lanes; ++l) sums[l] += double(x[i + l]) * double(x[i + l]);
  for (size_t i = whole; i < n; ++i) sums[0] += double(x[i]) * double(x[i]);
  double sum = 0;
  for (const double s : sums) sum += s;
  return sum;
}

template double energy(const std::complex<float>*, size_t);
template double energy(const std::complex<double>*, size_t);

}  // namespace holotrace

#endif
