#include "holotrace/slm/encode/iterate/processor_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/slm/encode/iterate/processor_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/base/each_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

using Tag = hn::ScalableTag<float>;

// Sums in vector lanes; the remaining samples are added last.
struct Sum {
  hn::Vec<Tag> lanes;
  double rest;

  HWY_INLINE Sum() : lanes(hn::Zero(Tag())), rest(0) {}  // explicit, so that it is compiled for the instruction set too

  HWY_INLINE void add(Tag, hn::Vec<Tag> v) { lanes = hn::Add(lanes, v); }
  template <class D, hwy::EnableIf<(hn::MaxLanes(D()) < hn::MaxLanes(Tag()))>* = nullptr>
  HWY_INLINE void add(D, hn::Vec<D> v) {
    rest += double(hn::GetLane(v));
  }
  double total() const { return double(hn::GetLane(hn::SumOfLanes(Tag(), lanes))) + rest; }
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE void store_unit(D d, V re, V im, float* u, size_t i) {
  const V square = hn::MulAdd(re, re, hn::Mul(im, im));
  const auto is_dark = hn::Eq(square, hn::Zero(d));
  const V inverse = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::IfThenElse(is_dark, hn::Set(d, 1.0f), square)));
  re = hn::IfThenElse(is_dark, hn::Set(d, 1.0f), hn::Mul(re, inverse));
  hn::StoreInterleaved2(re, hn::Mul(im, inverse), d, u + 2 * i);
}

void unit_modulus(float* u, size_t count) {
  each_vector<float>(count, [&](auto d, size_t i) {
    hn::Vec<decltype(d)> re, im;
    hn::LoadInterleaved2(d, u + 2 * i, re, im);
    store_unit(d, re, im, u, i);
  });
}

void add_unit_modulus(float* u, const float* g, size_t count) {
  each_vector<float>(count, [&](auto d, size_t i) {
    hn::Vec<decltype(d)> re, im, gr, gi;
    hn::LoadInterleaved2(d, u + 2 * i, re, im);
    hn::LoadInterleaved2(d, g + 2 * i, gr, gi);
    store_unit(d, hn::Add(re, gr), hn::Add(im, gi), u, i);
  });
}

void add_square(const float* v, float factor, float* power, size_t count) {
  each_vector<float>(count, [&](auto d, size_t i) {
    hn::Vec<decltype(d)> re, im;
    hn::LoadInterleaved2(d, v + 2 * i, re, im);
    const auto norm = hn::MulAdd(re, re, hn::Mul(im, im));
    hn::StoreU(hn::MulAdd(hn::Set(d, factor), norm, hn::LoadU(d, power + i)), d, power + i);
  });
}

void sums(const float* power, const float* amplitude, const float* weight, size_t count, ModulusSums* out) {
  Sum cross, square;
  each_vector<float>(count, [&](auto d, size_t i) {
    const auto light = hn::LoadU(d, power + i);
    const auto w = weight ? hn::LoadU(d, weight + i) : hn::Set(d, 1.0f);
    cross.add(d, hn::Mul(hn::Mul(w, hn::LoadU(d, amplitude + i)), hn::Sqrt(light)));
    square.add(d, hn::Mul(w, light));
  });
  *out = {cross.total(), square.total()};
}

void residual(float* power, const float* amplitude, const float* weight, float scale, size_t count, double* out) {
  Sum error;
  each_vector<float>(count, [&](auto d, size_t i) {
    const auto modulus = hn::Sqrt(hn::LoadU(d, power + i));
    const auto w = weight ? hn::LoadU(d, weight + i) : hn::Set(d, 1.0f);
    const auto lack = hn::Sub(hn::Mul(hn::Set(d, scale), hn::LoadU(d, amplitude + i)), modulus);
    error.add(d, hn::Mul(w, hn::Mul(lack, lack)));
    const auto is_dark = hn::Eq(modulus, hn::Zero(d));
    const auto factor = hn::Div(hn::Mul(w, lack), hn::IfThenElse(is_dark, hn::Set(d, 1.0f), modulus));
    hn::StoreU(hn::IfThenElse(is_dark, hn::Zero(d), factor), d, power + i);
  });
  *out = error.total();
}

void real_product(const float* factor, float* v, size_t count) {
  each_vector<float>(count, [&](auto d, size_t i) {
    hn::Vec<decltype(d)> re, im;
    hn::LoadInterleaved2(d, v + 2 * i, re, im);
    const auto f = hn::LoadU(d, factor + i);
    hn::StoreInterleaved2(hn::Mul(f, re), hn::Mul(f, im), d, v + 2 * i);
  });
}

void phase_gradient(const float* g, const float* u, float factor, float* to, size_t count) {
  each_vector<float>(count, [&](auto d, size_t i) {
    hn::Vec<decltype(d)> gr, gi, ur, ui;
    hn::LoadInterleaved2(d, g + 2 * i, gr, gi);
    hn::LoadInterleaved2(d, u + 2 * i, ur, ui);
    const auto turn = hn::MulSub(gi, ur, hn::Mul(gr, ui));
    hn::StoreU(hn::MulAdd(hn::Set(d, factor), turn, hn::LoadU(d, to + i)), d, to + i);
  });
}

void adam(const AdamStep& p, const float* g, float* m, float* v, float* x, size_t count) {
  each_vector<float>(count, [&](auto d, size_t i) {
    const auto slope = hn::LoadU(d, g + i);
    const auto mean = hn::MulAdd(hn::Set(d, p.beta1), hn::LoadU(d, m + i), hn::Mul(hn::Set(d, 1 - p.beta1), slope));
    const auto square =
        hn::MulAdd(hn::Set(d, p.beta2), hn::LoadU(d, v + i), hn::Mul(hn::Set(d, 1 - p.beta2), hn::Mul(slope, slope)));
    hn::StoreU(mean, d, m + i);
    hn::StoreU(square, d, v + i);
    const auto off = hn::Div(mean, hn::Add(hn::Sqrt(square), hn::Set(d, p.epsilon)));
    hn::StoreU(hn::NegMulAdd(hn::Set(d, p.step), off, hn::LoadU(d, x + i)), d, x + i);
  });
}

void settle(float turn, float levels, float hardness, float* drive, float* rounded, size_t count) {
  each_vector<float>(count, [&](auto d, size_t i) {
    auto x = hn::LoadU(d, drive + i);
    const auto zero = hn::Zero(d), last = hn::Set(d, levels - 1);
    const auto toward = [&](auto from, auto to) { return hn::MulAdd(hn::Set(d, hardness), hn::Sub(to, from), from); };
    if (turn > 0) {
      const auto whole = hn::Set(d, turn);
      x = hn::NegMulAdd(whole, hn::Floor(hn::Div(x, whole)), x);
      const auto level = hn::Round(x);
      hn::StoreU(hardness < 1 ? toward(x, level) : hn::IfThenElse(hn::Gt(level, last), zero, level), d, rounded + i);
    } else {
      x = hn::Min(hn::Max(x, zero), last);
      hn::StoreU(hardness < 1 ? toward(x, hn::Round(x)) : hn::Round(x), d, rounded + i);
    }
    hn::StoreU(x, d, drive + i);
  });
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace holotrace {
namespace {

HWY_EXPORT(unit_modulus);
HWY_EXPORT(add_unit_modulus);
HWY_EXPORT(add_square);
HWY_EXPORT(sums);
HWY_EXPORT(residual);
HWY_EXPORT(real_product);
HWY_EXPORT(phase_gradient);
HWY_EXPORT(adam);
HWY_EXPORT(settle);

float* reals(std::complex<float>* a) { return reinterpret_cast<float*>(a); }
const float* reals(const std::complex<float>* a) { return reinterpret_cast<const float*>(a); }

}  // namespace

void make_unit_modulus(std::complex<float>* u, size_t count) { HWY_DYNAMIC_DISPATCH(unit_modulus)(reals(u), count); }

void add_and_make_unit_modulus(std::complex<float>* u, const std::complex<float>* d, size_t count) {
  HWY_DYNAMIC_DISPATCH(add_unit_modulus)(reals(u), reals(d), count);
}

void add_power(const std::complex<float>* v, float factor, float* power, size_t count) {
  HWY_DYNAMIC_DISPATCH(add_square)(reals(v), factor, power, count);
}

ModulusSums modulus_sums(const float* power, const float* amplitude, const float* weight, size_t count) {
  ModulusSums out;
  HWY_DYNAMIC_DISPATCH(sums)(power, amplitude, weight, count, &out);
  return out;
}

double take_residual(float* power, const float* amplitude, const float* weight, float scale, size_t count) {
  double error = 0;
  HWY_DYNAMIC_DISPATCH(residual)(power, amplitude, weight, scale, count, &error);
  return error;
}

void multiply_by_real(const float* factor, std::complex<float>* v, size_t count) {
  HWY_DYNAMIC_DISPATCH(real_product)(factor, reals(v), count);
}

void add_phase_gradient(const std::complex<float>* g, const std::complex<float>* u, float factor, float* d,
                        size_t count) {
  HWY_DYNAMIC_DISPATCH(phase_gradient)(reals(g), reals(u), factor, d, count);
}

void adam_step(const AdamStep& step, const float* d, float* m, float* v, float* x, size_t count) {
  HWY_DYNAMIC_DISPATCH(adam)(step, d, m, v, x, count);
}

void settle_drive(float turn, float levels, float hardness, float* drive, float* rounded, size_t count) {
  HWY_DYNAMIC_DISPATCH(settle)(turn, levels, hardness, drive, rounded, count);
}

}  // namespace holotrace

#endif
