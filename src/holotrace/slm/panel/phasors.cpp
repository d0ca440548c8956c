#include "holotrace/slm/panel/panel_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/slm/panel/phasors.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/base/each_vector-inl.h"
#include "holotrace/wave/shared/wave_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

void phasors_loop(const float* cycles, const float* amplitude, size_t count, float* to) {
  each_vector<float>(count, [&](auto d, size_t i) {
    hn::Vec<decltype(d)> re, im;
    cis_lanes(d, hn::LoadU(d, cycles + i), re, im);
    if (amplitude) {
      const auto a = hn::LoadU(d, amplitude + i);
      re = hn::Mul(re, a);
      im = hn::Mul(im, a);
    }
    hn::StoreInterleaved2(re, im, d, to + 2 * i);
  });
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {
HWY_EXPORT(phasors_loop);
}  // namespace

void phasors(const float* cycles, const float* amplitude, size_t count, std::complex<float>* to) {
  HWY_DYNAMIC_DISPATCH(phasors_loop)(cycles, amplitude, count, reinterpret_cast<float*>(to));
}

}  // namespace holotrace

#endif
