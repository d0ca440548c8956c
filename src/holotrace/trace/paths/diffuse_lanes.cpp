#include "holotrace/trace/paths/diffuse_lanes.h"

#include <iterator>

#include "holotrace/base/units.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/shared/sampling.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/trace/paths/diffuse_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "holotrace/trace/shared/vector_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

// Numbers in [0, 1) from their 32 bits.
HWY_INLINE V fractions(const uint32_t* bits) {
  const Doubles d;
  const hn::Rebind<int32_t, Doubles> ints;
  const auto shifted = hn::BitCast(ints, hn::Xor(hn::LoadU(hn::RebindToUnsigned<decltype(ints)>(), bits),
                                                 hn::Set(hn::RebindToUnsigned<decltype(ints)>(), 0x80000000U)));
  return hn::MulAdd(hn::PromoteTo(d, shifted), hn::Set(d, 0x1p-32), hn::Set(d, 0.5));
}

void sample_lights(const DiffuseSurfaces& at, const LightLanes& light, const PlaceLanes& places, Vec3 middle,
                   LightSamples* samples) {
  const Doubles d;
  const V zero = hn::Zero(d), one = set(1);
  const Vectors centre = set(middle);
  for (size_t i = 0; i < size_t(at.count); i += hn::Lanes(d)) {
    const Vectors from = load(at.position, i);
    if (light.is_point) {
      const Vectors way = minus(load(light.corner, i), from);
      const V distance = length_of(way), inverse = hn::Div(one, distance);
      const Vectors direction = times(way, inverse);
      const V reflected = hn::Mul(dot_of(load(at.normal, i), direction), set(1 / pi));
      const auto is_lit =  // at the light itself, where `reflected` is no number, nothing is
          hn::And(hn::Gt(reflected, zero), hn::Ge(dot_of(load(at.geometric_normal, i), direction), zero));
      store(hn::IfThenElseZero(is_lit, hn::Mul(reflected, hn::Mul(inverse, inverse))), samples->share, i);
      store(direction, samples->direction, i);
      store(hn::Sub(distance, load(at.clearance, i)), samples->distance, i);
      continue;
    }
    const Vectors edge_u = load(light.edge_u, i), edge_v = load(light.edge_v, i);
    V s = load(places.u, i), t = load(places.v, i);
    if (light.are_triangles) {  // uniform over the triangle
      const V root = hn::Sqrt(s);
      s = hn::NegMulAdd(root, t, root);
      t = hn::Mul(root, t);
    }
    const Vectors way = add_times(add_times(minus(load(light.corner, i), from), edge_u, s), edge_v, t);
    // |edge_u × edge_v|·cosθ'·d, above 0 on the side to which the light shines
    const V in_front = hn::Neg(dot_of(cross_of(edge_u, edge_v), way));
    const V projected = hn::Max(in_front, hn::Neg(hn::Mul(in_front, load(light.two_sided, i))));
    const V squared = dot_of(way, way), distance = hn::Sqrt(squared), inverse = hn::Div(one, distance);
    const V cosine = hn::Mul(hn::Mul(projected, inverse), load(light.per_size, i));
    const V density = hn::Div(hn::Mul(load(light.density, i), squared), cosine);
    const Vectors direction = times(way, inverse);
    const V reflected = hn::Mul(dot_of(load(at.normal, i), direction), set(1 / pi));
    const auto is_lit =
        hn::And(hn::And(hn::Gt(projected, zero), hn::Lt(density, set(most_light_density))),
                hn::And(hn::Gt(reflected, zero), hn::Ge(dot_of(load(at.geometric_normal, i), direction), zero)));
    const V weight = hn::Div(density, hn::MulAdd(density, density, hn::Mul(reflected, reflected)));
    store(hn::IfThenElseZero(is_lit, hn::Mul(reflected, weight)), samples->share, i);
    if (!light.are_surfaces) {
      store(direction, samples->direction, i);
      store(hn::Sub(distance, load(at.clearance, i)), samples->distance, i);
      continue;
    }
    // The emitting surface itself is in the way: the ray ends before its plane, at grazing angles sooner.
    const Vectors end = add_times(from, way, one), rest = minus(end, load(at.start, i));
    const V from_start = length_of(rest);
    const V of_light = hn::Mul(set(light_rounding), hn::Add(length_of(minus(end, centre)), load(light.size, i)));
    store(times(rest, hn::Div(one, from_start)), samples->direction, i);
    store(hn::Sub(from_start, hn::Div(hn::Add(set(light.lift), of_light), hn::Max(cosine, set(least_light_cosine)))),
          samples->distance, i);
  }
}

// c₀ + y·(c₁ + y·(c₂ + …))
template <class Terms>
HWY_INLINE V series(const Terms& terms, V y) {
  V sum = set(terms[std::size(terms) - 1]);
  for (size_t n = std::size(terms) - 1; n-- > 0;) sum = hn::MulAdd(sum, y, set(terms[n]));
  return sum;
}

// cos 2πt and sin 2πt, as point_on_circle has them.
HWY_INLINE void find_point_on_circle(V t, V& cosine, V& sine) {
  const V turned = hn::Mul(t, set(4)), quarter = hn::Floor(hn::Add(turned, set(0.5)));  // 0 … 4
  const V x = hn::Mul(hn::Sub(turned, quarter), set(pi / 2)), y = hn::Neg(hn::Mul(x, x));
  const V c = series(cosine_terms, y), s = hn::Mul(x, series(sine_terms, y));
  const auto is = [&](double number) { return hn::Eq(quarter, set(number)); };
  const auto is_odd = hn::Or(is(1), is(3));
  const V first = hn::IfThenElse(is_odd, s, c), second = hn::IfThenElse(is_odd, c, s);
  cosine = hn::IfThenElse(hn::Or(is(1), is(2)), hn::Neg(first), first);
  sine = hn::IfThenElse(hn::Or(is(2), is(3)), hn::Neg(second), second);
}

void sample_directions(const DiffuseSurfaces& at, const uint32_t* u, const uint32_t* v, DiffuseSamples* samples) {
  const Doubles d;
  const V zero = hn::Zero(d), one = set(1);
  for (size_t i = 0; i < size_t(at.count); i += hn::Lanes(d)) {
    const V squared = fractions(u + i), radius = hn::Sqrt(squared), z = hn::Sqrt(hn::Sub(one, squared));
    V cosine, sine;
    find_point_on_circle(fractions(v + i), cosine, sine);
    const V x = hn::Mul(radius, cosine), y = hn::Mul(radius, sine);
    // frame_from_normal
    const Vectors n = load(at.normal, i);
    const V sign = hn::CopySign(one, n.z), a = hn::Neg(hn::Div(one, hn::Add(sign, n.z)));
    const V b = hn::Mul(hn::Mul(n.x, n.y), a);
    const Vectors along_x{hn::MulAdd(hn::Mul(hn::Mul(sign, n.x), n.x), a, one), hn::Mul(sign, b),
                          hn::Neg(hn::Mul(sign, n.x))};
    const Vectors along_y{b, hn::MulAdd(hn::Mul(n.y, n.y), a, sign), hn::Neg(n.y)};
    const Vectors direction = add_times(add_times(times(n, z), along_x, x), along_y, y);
    store(direction, samples->direction, i);
    const auto is_outside = hn::Ge(dot_of(load(at.geometric_normal, i), direction), zero);
    store(hn::IfThenElseZero(is_outside, hn::Mul(z, set(1 / pi))), samples->pdf, i);
  }
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(sample_lights);
HWY_EXPORT(sample_directions);

void sample_lights(const DiffuseSurfaces& at, const LightLanes& light, const PlaceLanes& places, Vec3 centre,
                   LightSamples& samples) {
  HWY_DYNAMIC_DISPATCH(sample_lights)(at, light, places, centre, &samples);
}

void sample_directions(const DiffuseSurfaces& at, const uint32_t* u, const uint32_t* v, DiffuseSamples& samples) {
  HWY_DYNAMIC_DISPATCH(sample_directions)(at, u, v, &samples);
}

}  // namespace holotrace
#endif
