#include "holotrace/trace/paths/rectangle_samples.h"

#include "holotrace/base/units.h"
#include "holotrace/trace/lights/light.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/trace/paths/rectangle_samples.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace holotrace {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, most_shadow_rays>;
using V = hn::Vec<Doubles>;

struct Vectors {
  V x, y, z;
};

HWY_INLINE Vectors set(Vec3 v) { return {hn::Set(Doubles(), v.x), hn::Set(Doubles(), v.y), hn::Set(Doubles(), v.z)}; }

HWY_INLINE V dot_of(const Vectors& a, const Vectors& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE Vectors times(const Vectors& a, V s) { return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)}; }

// a + b·s
HWY_INLINE Vectors add_times(const Vectors& a, const Vectors& b, V s) {
  return {hn::MulAdd(b.x, s, a.x), hn::MulAdd(b.y, s, a.y), hn::MulAdd(b.z, s, a.z)};
}

HWY_INLINE V length_of(const Vectors& a) { return hn::Sqrt(dot_of(a, a)); }

// Numbers in [0, 1) from their 32 bits.
HWY_INLINE V fractions(const uint32_t* bits) {
  const Doubles d;
  const hn::Rebind<int32_t, Doubles> ints;
  const auto shifted = hn::BitCast(ints, hn::Xor(hn::LoadU(hn::RebindToUnsigned<decltype(ints)>(), bits),
                                                 hn::Set(hn::RebindToUnsigned<decltype(ints)>(), 0x80000000U)));
  return hn::Mul(hn::Add(hn::PromoteTo(d, shifted), hn::Set(d, 0x1p31)), hn::Set(d, 0x1p-32));
}

void sample_all(const RectangleAndSurface& pair, const uint32_t* u, const uint32_t* v, RectangleSamples* samples) {
  const Doubles d;
  const Vec3 area = cross(pair.edge_u, pair.edge_v);
  const V zero = hn::Zero(d), one = hn::Set(d, 1);
  const Vectors corner = set(pair.corner), edge_u = set(pair.edge_u), edge_v = set(pair.edge_v), back = set(-area);
  const Vectors normal = set(pair.normal), geometric_normal = set(pair.geometric_normal);
  const Vectors start = set(pair.geometric_normal * -pair.clearance), centre = set(-pair.centre);
  const V per_area = hn::Set(d, 1 / length(area)), size = hn::Set(d, length(pair.edge_u) + length(pair.edge_v));
  for (size_t i = 0; i < size_t(most_shadow_rays); i += hn::Lanes(d)) {
    const Vectors way = add_times(add_times(corner, edge_u, fractions(u + i)), edge_v, fractions(v + i));
    const V projected = dot_of(back, way), squared = dot_of(way, way), distance = hn::Sqrt(squared);
    const V inverse = hn::Div(one, distance);
    const Vectors direction = times(way, inverse);
    const V density = hn::Div(hn::Mul(squared, distance), projected);
    const V reflected = hn::Mul(dot_of(normal, direction), hn::Set(d, 1 / pi));
    const auto is_lit = hn::And(hn::And(hn::Gt(projected, zero), hn::Lt(density, hn::Set(d, most_light_density))),
                                hn::And(hn::Gt(reflected, zero), hn::Ge(dot_of(geometric_normal, direction), zero)));
    const V weight = hn::Div(density, hn::MulAdd(density, density, hn::Mul(reflected, reflected)));
    hn::StoreU(hn::IfThenElseZero(is_lit, hn::Mul(reflected, weight)), d, samples->share.data() + i);
    Vectors toward = direction;
    V limit = hn::Sub(distance, hn::Set(d, pair.clearance));
    if (pair.is_visible) {
      const Vectors rest = add_times(way, start, one);
      const V from_start = length_of(rest);
      toward = times(rest, hn::Div(one, from_start));
      const V cosine = hn::Mul(hn::Mul(projected, inverse), per_area);
      const V of_light = hn::Mul(hn::Set(d, light_rounding), hn::Add(length_of(add_times(centre, way, one)), size));
      limit = hn::Sub(from_start, hn::Div(hn::Add(hn::Set(d, pair.lift), of_light),
                                          hn::Max(cosine, hn::Set(d, least_light_cosine))));
    }
    hn::StoreU(toward.x, d, samples->x.data() + i);
    hn::StoreU(toward.y, d, samples->y.data() + i);
    hn::StoreU(toward.z, d, samples->z.data() + i);
    hn::StoreU(limit, d, samples->distance.data() + i);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace holotrace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(sample_all);

void sample_rectangle(const RectangleAndSurface& pair, const uint32_t* u, const uint32_t* v,
                      RectangleSamples& samples) {
  HWY_DYNAMIC_DISPATCH(sample_all)(pair, u, v, &samples);
}

}  // namespace holotrace
#endif
