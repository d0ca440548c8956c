#pragma once

#include <cmath>

#include "holotrace/base/vec.h"

// Local frames of surfaces whose shading normal differs from the normal of the triangle.

namespace holotrace {

/// `normal`, turned toward the unit vector `direction` until their cosine is positive (about 1e-4 or more). A shading
/// normal may face away from a viewer who sees the triangle; it is then turned by the smallest useful amount.
inline Vec3 facing_normal(Vec3 normal, Vec3 direction) {
  constexpr double least = 1e-4;
  const double cosine = dot(normal, direction);
  return cosine >= least ? normal : normalize(normal + direction * (least - cosine));
}

/// The vector in the coordinates of the frame, whose axes are orthonormal.
inline Vec3 to_local(const Frame& frame, Vec3 v) { return {dot(frame.x, v), dot(frame.y, v), dot(frame.z, v)}; }

/// The surface as seen by one viewer: z is along the shading normal, turned to face the viewer.
struct ShadingView {
  Frame frame;
  Vec3 outgoing;  ///< local, z > 0

  ShadingView(Vec3 normal, Vec3 outgoing)
      : frame(frame_from_normal(facing_normal(normal, outgoing))), outgoing(to_local(frame, outgoing)) {}

  Vec3 local(Vec3 v) const { return to_local(frame, v); }
  Vec3 world(Vec3 v) const { return transform_vector(frame, v); }
};

/// Mirror image of a unit vector that points away from the surface.
inline Vec3 reflect(Vec3 outgoing, Vec3 normal) { return 2 * dot(outgoing, normal) * normal - outgoing; }

/// Snell's law: the refracted unit vector on the other side. `index` is the index of the far medium over that of the
/// near one; dot(outgoing, normal) > 0. Valid only below the critical angle.
inline Vec3 refract(Vec3 outgoing, Vec3 normal, double index) {
  const double cosine = dot(outgoing, normal);
  const double q = std::sqrt(std::fmax(0, index * index - (1 - cosine * cosine)));
  return ((cosine - q) * normal - outgoing) / index;
}

}  // namespace holotrace
