#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>

namespace holotrace {

/// A point, a direction or a colour, in double precision.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  friend Vec3 operator*(Vec3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec3 operator*(double s, Vec3 a) { return a * s; }
  friend Vec3 operator/(Vec3 a, double s) { return {a.x / s, a.y / s, a.z / s}; }
  Vec3& operator+=(Vec3 b) { return *this = *this + b; }
  Vec3& operator*=(Vec3 b) { return *this = *this * b; }
  Vec3& operator*=(double s) { return *this = *this * s; }
  bool operator==(const Vec3&) const = default;
};

inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Vec3 a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalize(Vec3 a) { return a / length(a); }
inline double max_component(Vec3 a) { return std::max(a.x, std::max(a.y, a.z)); }
/// Component 0, 1 or 2.
inline double component(Vec3 a, size_t number) { return number == 0 ? a.x : number == 1 ? a.y : a.z; }
inline bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// A texture coordinate, or any pair.
struct Vec2 {
  double x = 0, y = 0;
  bool operator==(const Vec2&) const = default;
};

inline Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
inline Vec2 operator*(Vec2 a, double s) { return {a.x * s, a.y * s}; }

/// An affine map p ↦ x·p.x + y·p.y + z·p.z + origin.
struct Frame {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin{0, 0, 0};
};

inline Vec3 transform_vector(const Frame& f, Vec3 v) { return f.x * v.x + f.y * v.y + f.z * v.z; }
inline Vec3 transform_point(const Frame& f, Vec3 p) { return transform_vector(f, p) + f.origin; }

/// The map that applies `inner`, then `outer`.
inline Frame compose(const Frame& outer, const Frame& inner) {
  return {transform_vector(outer, inner.x), transform_vector(outer, inner.y), transform_vector(outer, inner.z),
          transform_point(outer, inner.origin)};
}

/// Right-handed rotation by `angle` [rad] about the named axis through the origin.
inline Frame rotation_x(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{1, 0, 0}, {0, c, s}, {0, -s, c}, {}};
}
inline Frame rotation_y(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{c, 0, -s}, {0, 1, 0}, {s, 0, c}, {}};
}
inline Frame rotation_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}, {}};
}

/// An orthonormal frame whose z is the unit vector n (Duff et al., JCGT 6(1), 2017).
inline Frame frame_from_normal(Vec3 n) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n, {}};
}

/// A turn about an axis through the origin.
struct AxisTurn {
  char axis = 'x';   ///< x, y or z
  double angle = 0;  ///< right-handed [rad]
};

inline Frame rotation_of(const AxisTurn& turn) {
  return turn.axis == 'x' ? rotation_x(turn.angle) : turn.axis == 'y' ? rotation_y(turn.angle) : rotation_z(turn.angle);
}

/// The turn of a text such as "y 30 deg"; nothing unless it begins with an axis.
/// @throws Error  as parse_angle does
std::optional<AxisTurn> parse_turn(std::string_view text);

}  // namespace holotrace
