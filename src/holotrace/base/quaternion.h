#pragma once

#include <array>

#include "holotrace/base/vec.h"

namespace holotrace {

/// A rotation as a unit quaternion x, y, z, w, w being the cosine of half the angle; q and −q are the same rotation.
using Quaternion = std::array<double, 4>;

/// The map p ↦ q·p·q⁻¹.
Frame rotation_by(const Quaternion& q);

/// The quaternion of a rotation, w ≥ 0. @param rotation  axes that are orthonormal and right-handed
Quaternion quaternion_of(const Frame& rotation);

/// The quaternion of length 1 in that direction; one of length 0 becomes the identity.
Quaternion normalize(const Quaternion& q);

/// The rotation at `part` of the shortest way from a to b, at constant angular velocity (spherical linear interpolation).
/// Source: K. Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985.
Quaternion slerp(const Quaternion& a, const Quaternion& b, double part);

}  // namespace holotrace
