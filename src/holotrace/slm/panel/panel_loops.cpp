#include "holotrace/slm/panel/panel_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/slm/panel/panel_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/base/each_vector-inl.h"
#include "holotrace/base/units.h"
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
HWY_EXPORT(phasors_loop);
HWY_EXPORT(respond_loop);
HWY_EXPORT(respond_back_loop);
HWY_EXPORT(blur);
HWY_EXPORT(lines_sum);
HWY_EXPORT(turned_back);
}  // namespace

void phasors(const float* cycles, const float* amplitude, size_t count, std::complex<float>* to) {
  HWY_DYNAMIC_DISPATCH(phasors_loop)(cycles, amplitude, count, reinterpret_cast<float*>(to));
}

void respond(const ResponseKnots& knots, const float* drive, size_t count, float* cycles, float* amplitudes) {
  HWY_DYNAMIC_DISPATCH(respond_loop)(knots.knots->data(), knots.count, drive, count, cycles, amplitudes);
}

void respond_back(const ResponseKnots& knots, const float* drive, size_t count, const float* of_cycles,
                  const float* of_amplitudes, const float* modulus, float factor, float* of_drive) {
  HWY_DYNAMIC_DISPATCH(respond_back_loop)
  (knots.knots->data(), knots.count, drive, count, of_cycles, of_amplitudes, modulus, factor, of_drive);
}

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
