#include "holotrace/wave/propagate/transfer_row.h"

#include <cmath>

#include "holotrace/base/units.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/wave/propagate/transfer_row.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/base/each_vector-inl.h"
#include "holotrace/wave/shared/wave_lanes-inl.h"
#include "hwy/contrib/math/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

void transfer_loop(const TransferRow& row, const double* v2, size_t count, float* to) {
  each_vector<double>(count, [&](auto d, size_t i) {
    const hn::Rebind<float, decltype(d)> df;
    const auto k = hn::Set(d, row.k), q = hn::Add(hn::Set(d, row.u2), hn::LoadU(d, v2 + i));
    const auto beside = hn::Div(hn::Mul(hn::Set(d, row.z), q), hn::Add(k, hn::Sqrt(hn::Sub(hn::Mul(k, k), q))));
    const auto cycles = hn::Sub(hn::Set(d, row.start), beside);
    hn::Vec<decltype(df)> re, im;
    cis_lanes(df, hn::DemoteTo(df, hn::Sub(cycles, hn::Round(cycles))), re, im);
    hn::StoreInterleaved2(re, im, df, to + 2 * i);
  });
}

void kernel_loop(const KernelRow& row, const double* x, size_t count, double* to) {
  const double depth = std::abs(row.z), sign = row.z < 0 ? -1 : 1;
  each_vector<double>(count, [&](auto d, size_t i) {
    const auto set = [&](double value) { return hn::Set(d, value); };
    const auto u = hn::LoadU(d, x + i), rho2 = hn::MulAdd(u, u, set(row.y * row.y));
    const auto root = hn::Sqrt(hn::Add(rho2, set(depth * depth)));
    const auto beyond = hn::Div(rho2, hn::Add(root, set(depth))), r = hn::Add(beyond, set(depth));
    const auto cycles = hn::MulAdd(beyond, set(1 / row.wavelength), set(row.start));
    const auto angle = hn::Mul(hn::Sub(cycles, hn::Round(cycles)), set(2 * pi));
    const auto c = hn::Cos(d, angle), s = hn::Sin(d, angle), inverse = hn::Div(set(1), r),
               k = set(2 * pi / row.wavelength);
    const auto modulus = hn::Mul(set(row.scale * depth / (2 * pi)), hn::Mul(inverse, inverse));
    const auto re = hn::MulAdd(c, inverse, hn::Mul(k, s)), im = hn::MulSub(s, inverse, hn::Mul(k, c));
    hn::StoreInterleaved2(hn::Mul(modulus, re), hn::Mul(hn::Mul(modulus, set(sign)), im), d, to + 2 * i);
  });
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {
HWY_EXPORT(transfer_loop);
HWY_EXPORT(kernel_loop);
}  // namespace

void transfer_row(const TransferRow& row, const double* v2, size_t count, std::complex<float>* to) {
  HWY_DYNAMIC_DISPATCH(transfer_loop)(row, v2, count, reinterpret_cast<float*>(to));
}

void rayleigh_sommerfeld_row(const KernelRow& row, const double* x, size_t count, std::complex<double>* to) {
  HWY_DYNAMIC_DISPATCH(kernel_loop)(row, x, count, reinterpret_cast<double*>(to));
}

}  // namespace holotrace

#endif
