#include "holotrace/estimate/machine/ceilings.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/estimate/machine/multiply_add_peak.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/estimate/machine/timing.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Number of multiply-adds in `steps` steps; `start` and the sum keep the compiler from removing them.
double MultiplyAdds(int steps, float start, float& sum) {
  constexpr int chains = 12;  // two units with a latency of 4 or 5 need 10; with two factors they fit 16 registers
  const hn::ScalableTag<float> d;
  const auto a = hn::Set(d, 1 - start), b = hn::Set(d, start);
  hn::Vec<decltype(d)> sums[chains];
#pragma GCC unroll 16
  for (int c = 0; c < chains; ++c) sums[c] = hn::Set(d, start * float(c));
  for (int s = 0; s < steps; ++s)
#pragma GCC unroll 16
    for (int c = 0; c < chains; ++c) sums[c] = hn::MulAdd(sums[c], a, b);
  auto total = sums[0];
#pragma GCC unroll 16
  for (int c = 1; c < chains; ++c) total = hn::Add(total, sums[c]);
  sum = hn::GetLane(hn::SumOfLanes(d, total));
  return double(chains) * double(hn::Lanes(d)) * steps;
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(MultiplyAdds);

double measure_multiply_add_peak(int rounds) {
  constexpr int steps = 20000;
  float first;
  const double per_call = HWY_DYNAMIC_DISPATCH(MultiplyAdds)(steps, 1e-3F, first);
  std::atomic<float> kept;
  return per_call * peak_call_rate(
                        [&] {
                          float sum;
                          HWY_DYNAMIC_DISPATCH(MultiplyAdds)(steps, 1e-3F, sum);
                          kept = sum;
                        },
                        rounds);
}

}  // namespace holotrace
#endif
