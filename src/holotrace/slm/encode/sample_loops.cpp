#include "holotrace/slm/encode/sample_loops.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/slm/encode/sample_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/base/each_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

void moments(const float* u, size_t count, ModulusMoments* out) {
  // Pairs of a real and an imaginary part are half a vector of floats: as many doubles are a whole one.
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> parts;
  const size_t lanes = hn::Lanes(d);
  auto largest = hn::Zero(d), sum = hn::Zero(d), square = hn::Zero(d);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    hn::Vec<decltype(parts)> re, im;
    hn::LoadInterleaved2(parts, u + 2 * i, re, im);
    const auto x = hn::PromoteTo(d, re), y = hn::PromoteTo(d, im);
    const auto norm = hn::MulAdd(x, x, hn::Mul(y, y)), modulus = hn::Sqrt(norm);
    largest = hn::Max(largest, modulus);
    sum = hn::Add(sum, modulus);
    square = hn::Add(square, norm);
  }
  ModulusMoments result{hn::GetLane(hn::MaxOfLanes(d, largest)), hn::GetLane(hn::SumOfLanes(d, sum)),
                        hn::GetLane(hn::SumOfLanes(d, square))};
  for (; i < count; ++i) {
    const double x = u[2 * i], y = u[2 * i + 1], norm = x * x + y * y, modulus = std::sqrt(norm);
    result.largest = std::max(result.largest, modulus);
    result.sum += modulus;
    result.square += norm;
  }
  *out = result;
}

// atan2(y, x)/2π in [0, 1]. The smaller over the larger of |x| and |y| is in [0, 1], where t·P(t²) is the arc tangent in
// turns within 3e-8 (P fitted by least squares with weights that even out the error).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V turns_of(D d, V x, V y) {
  const auto set = [&](float value) { return hn::Set(d, value); };
  const V width = hn::Abs(x), height = hn::Abs(y), larger = hn::Max(width, height);
  const auto is_dark = hn::Eq(larger, hn::Zero(d));
  const V t = hn::Div(hn::Min(width, height), hn::IfThenElse(is_dark, set(1), larger)), q = hn::Mul(t, t);
  V p = set(-0.000645219814f);
  for (const float c :
       {0.00347928377f, -0.00889825821f, 0.0153456833f, -0.0221361313f, 0.0317459181f, -0.0530461185f, 0.159154832f})
    p = hn::MulAdd(p, q, set(c));
  V turns = hn::Mul(p, t);
  turns = hn::IfThenElse(hn::Gt(height, width), hn::Sub(set(0.25f), turns), turns);
  turns = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(set(0.5f), turns), turns);
  return hn::IfThenElse(hn::Lt(y, hn::Zero(d)), hn::Sub(set(1), turns), turns);
}

void phases(const float* u, float sign, size_t count, float* turns) {
  each_vector<float>(count, [&](auto d, size_t i) {
    hn::Vec<decltype(d)> re, im;
    hn::LoadInterleaved2(d, u + 2 * i, re, im);
    hn::StoreU(turns_of(d, re, hn::Mul(im, hn::Set(d, sign))), d, turns + i);
  });
}

void phasor_pairs(const float* u, float first, size_t count, float* to) {
  each_vector<float>(count, [&](auto d, size_t i) {
    hn::Vec<decltype(d)> re, im;
    hn::LoadInterleaved2(d, u + 2 * i, re, im);
    const auto one = hn::Set(d, 1.0f), norm = hn::MulAdd(re, re, hn::Mul(im, im)), modulus = hn::Sqrt(norm);
    const auto is_dark = hn::Eq(modulus, hn::Zero(d));
    const auto inverse = hn::Div(one, hn::IfThenElse(is_dark, one, modulus));
    const auto x = hn::IfThenElse(is_dark, one, hn::Mul(re, inverse)), y = hn::Mul(im, inverse);
    const auto a = hn::Min(modulus, one), aside = hn::Sqrt(hn::Max(hn::NegMulAdd(a, a, one), hn::Zero(d)));
    // A vector holds an even number of samples, and single samples follow them.
    const auto place = hn::Iota(d, float(i % 2));
    const auto odd = hn::Sub(place, hn::Mul(hn::Set(d, 2.0f), hn::Floor(hn::Mul(place, hn::Set(d, 0.5f)))));
    const auto turned = hn::Mul(aside, hn::Mul(hn::Set(d, first), hn::NegMulAdd(hn::Set(d, 2.0f), odd, one)));
    hn::StoreInterleaved2(hn::NegMulAdd(y, turned, hn::Mul(x, a)), hn::MulAdd(x, turned, hn::Mul(y, a)), d, to + 2 * i);
  });
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {
HWY_EXPORT(moments);
HWY_EXPORT(phases);
HWY_EXPORT(phasor_pairs);
const float* reals(const std::complex<float>* a) { return reinterpret_cast<const float*>(a); }
}  // namespace

ModulusMoments modulus_moments(const std::complex<float>* u, size_t count) {
  ModulusMoments result;
  HWY_DYNAMIC_DISPATCH(moments)(reals(u), count, &result);
  return result;
}

void phases_of(const std::complex<float>* u, float sign, size_t count, float* turns) {
  HWY_DYNAMIC_DISPATCH(phases)(reals(u), sign, count, turns);
}

void double_phase_phasors(const std::complex<float>* u, float first, size_t count, std::complex<float>* to) {
  HWY_DYNAMIC_DISPATCH(phasor_pairs)(reals(u), first, count, reinterpret_cast<float*>(to));
}

}  // namespace holotrace

#endif
