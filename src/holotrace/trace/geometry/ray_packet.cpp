#include "holotrace/trace/geometry/ray_packet.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/trace/geometry/ray_packet.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/trace/shared/vector_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

HWY_INLINE void store(V value, float* lanes, size_t i) {
  const hn::Rebind<float, Doubles> floats;
  hn::StoreU(hn::DemoteTo(floats, value), floats, lanes + i);
}

// The numbers of rays that are left out are 0: Embree with assertions looks at them, too.
void fill_rays(const RayLanes& rays, uint32_t asked, const ScenePrecision& precision, RayPacket* packet) {
  const Doubles d;
  const hn::Rebind<int32_t, Doubles> ints;
  const V zero = hn::Zero(d), infinite = set(std::numeric_limits<double>::infinity());
  const Vectors centre = set(precision.centre);
  const double per_unit = 1 / precision.unit, size = sphere_margin * precision.radius / precision.unit;
  RTCRay16& out = packet->query.ray;
  for (size_t i = 0; i < most_together; i += hn::Lanes(d)) {
    const Vectors start = minus(load(rays.origin, i), centre), direction = load(rays.direction, i);
    const V distance = load(rays.distance, i);
    // The rounding of the end.
    const Vectors end = add_times(start, direction, distance);
    const V from_start = hn::Min(set(precision.radius * precision.radius), dot_of(start, start));
    const V squared = hn::Max(hn::Max(dot_of(end, end), from_start), set(precision.unit * precision.unit));
    const V rounding = hn::Mul(set(end_rounding), hn::Sqrt(squared));
    const V before_end = hn::IfThenElse(hn::Lt(distance, infinite), hn::Sub(distance, rounding), distance);
    // The part inside the sphere, in units.
    const Vectors origin = times(start, set(per_unit));
    const V outside = hn::Sub(dot_of(origin, origin), set(size * size)), along = dot_of(origin, direction);
    const V discriminant = hn::MulSub(along, along, outside);
    const auto is_outside = hn::Gt(outside, zero);
    const auto misses = hn::And(is_outside, hn::Or(hn::Ge(along, zero), hn::Lt(discriminant, zero)));
    const V skipped = hn::IfThenElseZero(is_outside, hn::Neg(hn::Add(along, hn::Sqrt(hn::Max(discriminant, zero)))));
    const V length = hn::Sub(hn::Mul(before_end, set(per_unit)), skipped);
    const uint64_t bits = asked >> i;
    const auto is_asked = hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&bits));
    const auto is_valid =
        hn::And(is_asked, hn::AndNot(misses, hn::And(hn::Gt(before_end, zero), hn::Gt(length, zero))));
    const auto put = [&](V value, float* lanes) { store(hn::IfThenElseZero(is_valid, value), lanes, i); };
    const Vectors entry = add_times(origin, direction, skipped);
    put(entry.x, out.org_x), put(entry.y, out.org_y), put(entry.z, out.org_z);
    put(direction.x, out.dir_x), put(direction.y, out.dir_y), put(direction.z, out.dir_z);
    put(length, out.tfar);
    hn::StoreU(skipped, d, packet->skipped.data() + i);
    hn::StoreU(hn::DemoteTo(ints, hn::IfThenElseZero(is_valid, set(-1))), ints, packet->valid.data() + i);
  }
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(fill_rays);

void fill_packet(const RayLanes& rays, uint32_t asked, const ScenePrecision& precision, RayPacket& packet) {
  HWY_DYNAMIC_DISPATCH(fill_rays)(rays, asked, precision, &packet);
  auto& [ray, hit] = packet.query;
  for (size_t i = 0; i < most_together; ++i) {
    ray.tnear[i] = ray.time[i] = 0;
    ray.mask[i] = ~0U;
    ray.id[i] = ray.flags[i] = 0;
    hit.geomID[i] = hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
}

}  // namespace holotrace
#endif
