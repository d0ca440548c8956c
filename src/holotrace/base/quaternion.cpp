#include "holotrace/base/quaternion.h"

#include <cmath>

namespace holotrace {

Frame rotation_by(const Quaternion& q) {
  const auto [x, y, z, w] = q;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
          {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
          {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)},
          {}};
}

Quaternion normalize(const Quaternion& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 0)) return {0, 0, 0, 1};
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

Quaternion quaternion_of(const Frame& r) {
  // The component that is largest is found first, as a root of a sum that is not small.
  const std::array<double, 4> squares{1 + r.x.x - r.y.y - r.z.z, 1 - r.x.x + r.y.y - r.z.z, 1 - r.x.x - r.y.y + r.z.z,
                                      1 + r.x.x + r.y.y + r.z.z};
  size_t largest = 0;
  for (size_t i = 1; i < 4; ++i)
    if (squares[i] > squares[largest]) largest = i;
  const double xy = r.x.y + r.y.x, xz = r.x.z + r.z.x, yz = r.y.z + r.z.y;
  const double wx = r.y.z - r.z.y, wy = r.z.x - r.x.z, wz = r.x.y - r.y.x;
  const std::array<Quaternion, 4> rows{
      {{squares[0], xy, xz, wx}, {xy, squares[1], yz, wy}, {xz, yz, squares[2], wz}, {wx, wy, wz, squares[3]}}};
  Quaternion q = normalize(rows[largest]);
  if (q[3] < 0) q = {-q[0], -q[1], -q[2], -q[3]};
  return q;
}

Quaternion slerp(const Quaternion& a, const Quaternion& b, double part) {
  double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const double sign = cosine < 0 ? -1 : 1;
  cosine *= sign;
  double first = 1 - part, second = part;
  constexpr double close = 1 - 1e-9;  // there the chord and the arc differ by less than rounding
  if (cosine < close) {
    const double angle = std::acos(cosine), sine = std::sin(angle);
    first = std::sin((1 - part) * angle) / sine;
    second = std::sin(part * angle) / sine;
  }
  second *= sign;
  return normalize(Quaternion{first * a[0] + second * b[0], first * a[1] + second * b[1], first * a[2] + second * b[2],
                              first * a[3] + second * b[3]});
}

}  // namespace holotrace
