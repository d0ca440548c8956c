#include "holotrace/slm/panel/panel_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/slm/panel/blur_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/base/each_vector-inl.h"
#include "holotrace/base/units.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

void blur(const float* from, const float* factors, size_t taps, size_t count, bool adds, float* to) {
  each_vector<float>(count, [&](auto d, size_t i) {
    auto sum = adds ? hn::LoadU(d, to + i) : hn::Zero(d);
    for (size_t k = 0; k < taps; ++k) sum = hn::MulAdd(hn::Set(d, factors[k]), hn::LoadU(d, from + i + k), sum);
    hn::StoreU(sum, d, to + i);
  });
}

void lines_sum(const float* const* lines, const float* factors, size_t number, size_t count, float* to) {
  each_vector<float>(count, [&](auto d, size_t i) {
    auto sum = hn::Mul(hn::Set(d, factors[0]), hn::LoadU(d, lines[0] + i));
    for (size_t r = 1; r < number; ++r) sum = hn::MulAdd(hn::Set(d, factors[r]), hn::LoadU(d, lines[r] + i), sum);
    hn::StoreU(sum, d, to + i);
  });
}

void turned_back(const float* q, const float* u, const float* amplitude, size_t count, float* of_cycles,
                 float* of_amplitudes) {
  each_vector<float>(count, [&](auto d, size_t i) {
    hn::Vec<decltype(d)> qr, qi, ur, ui;
    hn::LoadInterleaved2(d, q + 2 * i, qr, qi);
    hn::LoadInterleaved2(d, u + 2 * i, ur, ui);
    auto factor = hn::Set(d, float(2 * pi));
    if (amplitude) factor = hn::Mul(factor, hn::LoadU(d, amplitude + i));
    hn::StoreU(hn::Mul(factor, hn::MulSub(qi, ur, hn::Mul(qr, ui))), d, of_cycles + i);
    if (of_amplitudes) hn::StoreU(hn::MulAdd(qr, ur, hn::Mul(qi, ui)), d, of_amplitudes + i);
  });
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {
HWY_EXPORT(blur);
HWY_EXPORT(lines_sum);
HWY_EXPORT(turned_back);
}  // namespace

void blur_line(const float* from, const float* factors, size_t taps, size_t count, bool adds, float* to) {
  HWY_DYNAMIC_DISPATCH(blur)(from, factors, taps, count, adds, to);
}

void sum_lines(const float* const* lines, const float* factors, size_t number, size_t count, float* to) {
  HWY_DYNAMIC_DISPATCH(lines_sum)(lines, factors, number, count, to);
}

void turn_back(const std::complex<float>* q, const std::complex<float>* u, const float* amplitude, size_t count,
               float* of_cycles, float* of_amplitudes) {
  HWY_DYNAMIC_DISPATCH(turned_back)
  (reinterpret_cast<const float*>(q), reinterpret_cast<const float*>(u), amplitude, count, of_cycles, of_amplitudes);
}

}  // namespace holotrace

#endif
