#include "holotrace/wave/propagate/transfer_row.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/wave/propagate/transfer_row.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/base/each_vector-inl.h"
#include "holotrace/wave/shared/wave_lanes-inl.h"

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

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {
HWY_EXPORT(transfer_loop);
}  // namespace

void transfer_row(const TransferRow& row, const double* v2, size_t count, std::complex<float>* to) {
  HWY_DYNAMIC_DISPATCH(transfer_loop)(row, v2, count, reinterpret_cast<float*>(to));
}

}  // namespace holotrace

#endif
