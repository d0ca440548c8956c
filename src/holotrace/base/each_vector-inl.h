// The loop over an array in vectors, shared by the kernels that Highway compiles once for every instruction set: include
// it inside a file that foreach_target.h repeats.

#if defined(HOLOTRACE_EACH_VECTOR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HOLOTRACE_EACH_VECTOR_INL_H
#undef HOLOTRACE_EACH_VECTOR_INL_H
#else
#define HOLOTRACE_EACH_VECTOR_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Calls step(tag, i) for every whole vector of `count` samples, i its first one, then with a tag of one lane for each of
/// the remaining samples.
template <class Real, class Step>
HWY_INLINE void each_vector(size_t count, const Step& step) {
  const hn::ScalableTag<Real> d;
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) step(d, i);
  for (; i < count; ++i) step(hn::CappedTag<Real, 1>(), i);
}

}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
