#include "holotrace/slm/panel/panel_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/slm/panel/response_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/base/each_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

// The knot below each drive, as the place of its first number in the table, and the rest above it.
template <class D>
struct BelowDrive {
  hn::Vec<hn::RebindToSigned<D>> place;
  hn::Vec<D> rest;
};

template <class D>
BelowDrive<D> below(D d, const float* drive, size_t knots) {
  const hn::RebindToSigned<D> whole;
  const auto level = hn::LoadU(d, drive), zero = hn::Zero(d);
  const auto knot = hn::ConvertTo(whole, hn::Min(hn::Max(level, zero), hn::Set(d, float(knots - 1))));
  const auto rest = hn::Min(hn::Max(hn::Sub(level, hn::ConvertTo(d, knot)), zero), hn::Set(d, 1.0F));
  return {hn::ShiftLeft<2>(knot), rest};
}

void respond_loop(const float* knots, size_t number, const float* drive, size_t count, float* cycles,
                  float* amplitudes) {
  each_vector<float>(count, [&](auto d, size_t i) {
    const auto [place, rest] = below(d, drive + i, number);
    const auto number_of = [&](int k) { return hn::GatherIndex(d, knots + k, place); };
    if (amplitudes) hn::StoreU(hn::MulAdd(rest, number_of(3), number_of(1)), d, amplitudes + i);
    if (cycles) hn::StoreU(hn::MulAdd(rest, number_of(2), number_of(0)), d, cycles + i);
  });
}

void respond_back_loop(const float* knots, size_t number, const float* drive, size_t count, const float* of_cycles,
                       const float* of_amplitudes, const float* modulus, float factor, float* of_drive) {
  each_vector<float>(count, [&](auto d, size_t i) {
    const auto place = below(d, drive + i, number).place;
    auto sum = hn::Mul(hn::GatherIndex(d, knots + 2, place), hn::LoadU(d, of_cycles + i));
    if (of_amplitudes) {
      auto slope = hn::Mul(hn::Set(d, factor), hn::GatherIndex(d, knots + 3, place));
      if (modulus) slope = hn::Mul(slope, hn::LoadU(d, modulus + i));
      sum = hn::MulAdd(slope, hn::LoadU(d, of_amplitudes + i), sum);
    }
    hn::StoreU(sum, d, of_drive + i);
  });
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {
HWY_EXPORT(respond_loop);
HWY_EXPORT(respond_back_loop);
}  // namespace

void respond(const ResponseKnots& knots, const float* drive, size_t count, float* cycles, float* amplitudes) {
  HWY_DYNAMIC_DISPATCH(respond_loop)(knots.knots->data(), knots.count, drive, count, cycles, amplitudes);
}

void respond_back(const ResponseKnots& knots, const float* drive, size_t count, const float* of_cycles,
                  const float* of_amplitudes, const float* modulus, float factor, float* of_drive) {
  HWY_DYNAMIC_DISPATCH(respond_back_loop)
  (knots.knots->data(), knots.count, drive, count, of_cycles, of_amplitudes, modulus, factor, of_drive);
}

}  // namespace holotrace

#endif
