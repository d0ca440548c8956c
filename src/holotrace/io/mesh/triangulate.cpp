#include <array>
#include <cmath>
#include <numeric>

#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {
namespace {

double cross(Vec2 a, Vec2 b, Vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// The polygon's normal by Newell's formula, twice its area long.
Vec3 newell_normal(const std::vector<Vec3>& corners) {
  Vec3 n{};
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i], b = corners[(i + 1) % corners.size()];
    n += Vec3{(a.y - b.y) * (a.z + b.z), (a.z - b.z) * (a.x + b.x), (a.x - b.x) * (a.y + b.y)};
  }
  return n;
}

// The polygon in the coordinate plane that it faces most, counter-clockwise.
std::vector<Vec2> projected(const std::vector<Vec3>& corners) {
  const Vec3 n = newell_normal(corners);
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  std::vector<Vec2> flat;
  for (const Vec3& p : corners) {
    if (z >= x && z >= y)
      flat.push_back(n.z >= 0 ? Vec2{p.x, p.y} : Vec2{p.y, p.x});
    else if (x >= y)
      flat.push_back(n.x >= 0 ? Vec2{p.y, p.z} : Vec2{p.z, p.y});
    else
      flat.push_back(n.y >= 0 ? Vec2{p.z, p.x} : Vec2{p.x, p.z});
  }
  return flat;
}

bool is_convex(const std::vector<Vec2>& flat) {
  for (size_t i = 0, n = flat.size(); i < n; ++i)
    if (cross(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) < 0) return false;
  return true;
}

// Whether the corner i of the rest of a polygon can be cut off: it is convex, and no other corner lies in its triangle.
bool is_ear(const std::vector<Vec2>& flat, const std::vector<uint32_t>& rest, size_t i) {
  const size_t n = rest.size();
  const Vec2 a = flat[rest[(i + n - 1) % n]], b = flat[rest[i]], c = flat[rest[(i + 1) % n]];
  if (!(cross(a, b, c) > 0)) return false;
  for (size_t k = 2; k + 1 < n; ++k) {
    const Vec2 p = flat[rest[(i + k) % n]];
    if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0 && !(p == a) && !(p == c)) return false;
  }
  return true;
}

}  // namespace

void triangulate(const std::vector<Vec3>& corners, std::vector<std::array<uint32_t, 3>>& triangles) {
  constexpr size_t most_corners = 500;  // cutting ears takes the cube of the corners
  std::vector<uint32_t> rest(corners.size());
  std::iota(rest.begin(), rest.end(), 0u);
  if (corners.size() > 3 && corners.size() <= most_corners) {
    const std::vector<Vec2> flat = projected(corners);
    bool is_cut = !is_convex(flat);
    while (is_cut && rest.size() > 3) {
      is_cut = false;
      for (size_t i = 0, n = rest.size(); i < n && !is_cut; ++i) {
        if (!is_ear(flat, rest, i)) continue;
        triangles.push_back({rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]});
        rest.erase(rest.begin() + std::ptrdiff_t(i));
        is_cut = true;
      }
    }
  }
  for (size_t i = 2; i < rest.size(); ++i) triangles.push_back({rest[0], rest[i - 1], rest[i]});
}

}  // namespace holotrace
