#include "holotrace/trace/geometry/few_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/trace/geometry/few_triangles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, most_together>;
using F = hn::Vec<Floats>;
using Ints = hn::RebindToSigned<Floats>;
using Face = FewTriangles::Face;

struct Rays {
  F origin[3], direction[3], end;

  Rays(const RTCRay16& r, size_t i) {
    const Floats d;
    origin[0] = hn::LoadU(d, r.org_x + i), origin[1] = hn::LoadU(d, r.org_y + i), origin[2] = hn::LoadU(d, r.org_z + i);
    direction[0] = hn::LoadU(d, r.dir_x + i), direction[1] = hn::LoadU(d, r.dir_y + i);
    direction[2] = hn::LoadU(d, r.dir_z + i), end = hn::LoadU(d, r.tfar + i);
  }
};

// a·b + c
HWY_INLINE F dot_of(const float (&a)[4], const F (&b)[3], F c) {
  const Floats d;
  return hn::MulAdd(hn::Set(d, a[0]), b[0], hn::MulAdd(hn::Set(d, a[1]), b[1], hn::MulAdd(hn::Set(d, a[2]), b[2], c)));
}

struct Meeting {
  F distance, b1, b2;
  hn::Mask<Floats> is_met;  // before the end of the ray
};

HWY_INLINE Meeting meet(const Face& face, const Rays& rays, F end) {
  const Floats d;
  const F zero = hn::Zero(d), along = dot_of(face.normal, rays.direction, zero);
  Meeting found;
  found.distance = hn::Div(hn::Neg(dot_of(face.normal, rays.origin, hn::Set(d, face.normal[3]))), along);
  F place[3];
  for (int k = 0; k < 3; ++k) place[k] = hn::MulAdd(found.distance, rays.direction[k], rays.origin[k]);
  found.b1 = dot_of(face.u, place, hn::Set(d, face.u[3]));
  found.b2 = dot_of(face.v, place, hn::Set(d, face.v[3]));
  const F least = hn::Min(found.b1, found.b2), most = hn::Max(found.b1, found.b2), sum = hn::Add(found.b1, found.b2);
  // Comparisons with the NaN of a ray along the plane are false.
  const auto is_before = hn::And(hn::Gt(found.distance, zero), hn::Lt(found.distance, end));
  const auto is_inside =
      hn::And(hn::And(hn::Ge(least, zero), hn::Le(most, hn::Set(d, 1.0F))), hn::Le(sum, hn::Set(d, face.largest_sum)));
  found.is_met = hn::And(is_before, is_inside);
  return found;
}

HWY_INLINE hn::Mask<Floats> valid_lanes(const RayPacket& packet, size_t i) {
  const Ints ints;
  return hn::RebindMask(Floats(), hn::Lt(hn::LoadU(ints, packet.valid.data() + i), hn::Zero(ints)));
}

// Names the triangle at the place (b1, b2) of a face, and its barycentric coordinates.
void set_hit(const Face& face, RTCHit16& hit, size_t i) {
  const float b1 = hit.u[i], b2 = hit.v[i], beyond = b1 + b2 - 1;
  const bool is_second = beyond > 0 && face.largest_sum == 2;
  const float first[3] = {-beyond, b1, b2}, second[3] = {beyond, 1 - b2, 1 - b1};
  const float* weights = is_second ? second : first;
  hit.u[i] = weights[face.roles[is_second][0]];
  hit.v[i] = weights[face.roles[is_second][1]];
  hit.geomID[i] = face.mesh;
  hit.primID[i] = face.triangles[is_second];
}

void closest_hits(const Face* faces, size_t count, RayPacket* packet) {
  const Floats d;
  const Ints ints;
  auto& [ray, hit] = packet->query;
  for (size_t i = 0; i < most_together; i += hn::Lanes(d)) {
    const auto is_valid = valid_lanes(*packet, i);
    if (hn::AllFalse(d, is_valid)) continue;
    const Rays rays(ray, i);
    F nearest = rays.end, b1 = hn::Zero(d), b2 = b1;
    auto number = hn::Set(ints, -1);
    for (size_t n = 0; n < count; ++n) {
      const Meeting found = meet(faces[n], rays, nearest);
      nearest = hn::IfThenElse(found.is_met, found.distance, nearest);
      b1 = hn::IfThenElse(found.is_met, found.b1, b1);
      b2 = hn::IfThenElse(found.is_met, found.b2, b2);
      number = hn::IfThenElse(hn::RebindMask(ints, found.is_met), hn::Set(ints, int32_t(n)), number);
    }
    hn::StoreU(hn::IfThenElse(is_valid, nearest, rays.end), d, ray.tfar + i);
    hn::StoreU(b1, d, hit.u + i);
    hn::StoreU(b2, d, hit.v + i);
    alignas(64) int32_t numbers[most_together];
    hn::StoreU(hn::IfThenElse(hn::RebindMask(ints, is_valid), number, hn::Set(ints, -1)), ints, numbers);
    for (size_t lane = 0; lane < hn::Lanes(d); ++lane)
      if (numbers[lane] >= 0) set_hit(faces[numbers[lane]], hit, i + lane);
  }
}

void find_occluded(const Face* faces, size_t count, RayPacket* packet) {
  const Floats d;
  RTCRay16& ray = packet->query.ray;
  for (size_t i = 0; i < most_together; i += hn::Lanes(d)) {
    const auto is_valid = valid_lanes(*packet, i);
    if (hn::AllFalse(d, is_valid)) continue;
    const Rays rays(ray, i);
    auto is_met = hn::Not(is_valid);
    for (size_t n = 0; n < count && !hn::AllTrue(d, is_met); ++n)
      is_met = hn::Or(is_met, meet(faces[n], rays, rays.end).is_met);
    const F occluded = hn::Set(d, -std::numeric_limits<float>::infinity());
    hn::StoreU(hn::IfThenElse(hn::And(is_met, is_valid), occluded, rays.end), d, ray.tfar + i);
  }
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(closest_hits);
HWY_EXPORT(find_occluded);

namespace {

/// The face of the triangle (a, b, c), or of the parallelogram with these corners.
FewTriangles::Face make_face(const Vec3& a, const Vec3& b, const Vec3& c, bool is_parallelogram) {
  const Vec3 ab = b - a, ac = c - a, normal = cross(ab, ac);
  const double squared = dot(normal, normal);
  const Vec3 unit = normal * (1 / std::sqrt(squared));
  const Vec3 u = cross(ac, normal) * (1 / squared), v = cross(normal, ab) * (1 / squared);
  return {.normal = {float(unit.x), float(unit.y), float(unit.z), float(-dot(unit, a))},
          .u = {float(u.x), float(u.y), float(u.z), float(-dot(u, a))},
          .v = {float(v.x), float(v.y), float(v.z), float(-dot(v, a))},
          .largest_sum = is_parallelogram ? 2.0F : 1.0F,
          .mesh = 0,
          .triangles = {},
          .roles = {{1, 2}, {1, 2}}};
}

/// Sets the roles of a triangle's vertices; `lone` is the one that the two triangles do not share.
void set_roles(const std::array<Vec3, 3>& corners, size_t lone, const Vec3& b, uint8_t (&roles)[2]) {
  for (size_t n = 1; n < 3; ++n) roles[n - 1] = n == lone ? 0 : corners[n] == b ? 1 : 2;
}

}  // namespace

void FewTriangles::add(const std::array<Vec3, 3>& corners, uint32_t mesh, uint32_t triangle) {
  const auto has_area = [](const std::array<Vec3, 3>& c) { return length(cross(c[1] - c[0], c[2] - c[0])) > 0; };
  if (!has_area(corners)) return;
  const auto lone_in = [](const std::array<Vec3, 3>& own, const std::array<Vec3, 3>& other) {
    size_t lone = 0, shared = 0;
    for (size_t n = 0; n < 3; ++n)
      if (std::find(other.begin(), other.end(), own[n]) == other.end())
        lone = n;
      else
        ++shared;
    return shared == 2 ? lone : 3;
  };
  if (is_last_single_ && faces_.back().mesh == mesh) {
    const size_t mine = lone_in(corners, last_), its = lone_in(last_, corners);
    if (mine < 3 && its < 3) {
      const Vec3 a = last_[its], b = last_[(its + 1) % 3], c = last_[(its + 2) % 3], d = corners[mine];
      if (length(b + c - a - d) < 0.5 * std::numeric_limits<float>::epsilon() * std::max(length(d), length(b - c))) {
        Face face = make_face(a, b, c, true);
        face.mesh = mesh;
        face.triangles[0] = faces_.back().triangles[0], face.triangles[1] = triangle;
        set_roles(last_, its, b, face.roles[0]);
        set_roles(corners, mine, b, face.roles[1]);
        faces_.back() = face;
        is_last_single_ = false;
        return;
      }
    }
  }
  Face face = make_face(corners[0], corners[1], corners[2], false);
  face.mesh = mesh;
  face.triangles[0] = triangle;
  faces_.push_back(face);
  last_ = corners;
  is_last_single_ = true;
}

void FewTriangles::closest_hits(RayPacket& packet) const {
  HWY_DYNAMIC_DISPATCH(closest_hits)(faces_.data(), faces_.size(), &packet);
}

void FewTriangles::find_occluded(RayPacket& packet) const {
  HWY_DYNAMIC_DISPATCH(find_occluded)(faces_.data(), faces_.size(), &packet);
}

}  // namespace holotrace
#endif
