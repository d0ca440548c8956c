// Numbers and vectors of several paths in registers. For files that Highway compiles once for each instruction set, which
// is why the guard lets it in once for each.

#if defined(HOLOTRACE_TRACE_SHARED_VECTOR_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HOLOTRACE_TRACE_SHARED_VECTOR_LANES_INL_H_
#undef HOLOTRACE_TRACE_SHARED_VECTOR_LANES_INL_H_
#else
#define HOLOTRACE_TRACE_SHARED_VECTOR_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "holotrace/base/vec.h"
#include "holotrace/trace/shared/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, most_together>;
using V = hn::Vec<Doubles>;

struct Vectors {
  V x, y, z;
};

HWY_INLINE V set(double value) { return hn::Set(Doubles(), value); }
HWY_INLINE V load(const Lane& lane, size_t i) { return hn::LoadU(Doubles(), lane.data() + i); }
HWY_INLINE Vectors load(const LaneVectors& v, size_t i) { return {load(v.x, i), load(v.y, i), load(v.z, i)}; }
HWY_INLINE void store(V value, Lane& lane, size_t i) { hn::StoreU(value, Doubles(), lane.data() + i); }
HWY_INLINE void store(const Vectors& value, LaneVectors& v, size_t i) {
  store(value.x, v.x, i), store(value.y, v.y, i), store(value.z, v.z, i);
}

HWY_INLINE Vectors set(Vec3 v) { return {set(v.x), set(v.y), set(v.z)}; }

HWY_INLINE Vectors minus(const Vectors& a, const Vectors& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE V dot_of(const Vectors& a, const Vectors& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE Vectors cross_of(const Vectors& a, const Vectors& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

HWY_INLINE Vectors times(const Vectors& a, V s) { return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)}; }

// a + b·s
HWY_INLINE Vectors add_times(const Vectors& a, const Vectors& b, V s) {
  return {hn::MulAdd(b.x, s, a.x), hn::MulAdd(b.y, s, a.y), hn::MulAdd(b.z, s, a.z)};
}

HWY_INLINE V length_of(const Vectors& a) { return hn::Sqrt(dot_of(a, a)); }

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
