// Extrusions: solids made from flat outlines.

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/data/shape_parts.h"
#include "holotrace/data/shapes.h"

namespace holotrace {
namespace {

// Twice the signed area of the triangle a, b, c: positive if it is counter-clockwise.
double turn(Vec2 a, Vec2 b, Vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

bool within(Vec2 p, Vec2 a, Vec2 b) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

// Whether the segments ab and cd have a point in common.
bool segments_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const double c_side = turn(a, b, c), d_side = turn(a, b, d), a_side = turn(c, d, a), b_side = turn(c, d, b);
  if (((c_side > 0) != (d_side > 0)) && ((a_side > 0) != (b_side > 0)) && c_side != 0 && d_side != 0 && a_side != 0 &&
      b_side != 0)
    return true;
  return (c_side == 0 && within(c, a, b)) || (d_side == 0 && within(d, a, b)) || (a_side == 0 && within(a, c, d)) ||
         (b_side == 0 && within(b, c, d));
}

void check_outline(const std::vector<Vec2>& outline) {
  const size_t n = outline.size();
  require(n >= 3, "expected an outline of 3 different points or more, got {}", n);
  for (size_t i = 0; i < n; ++i) {
    const Vec2 a = outline[i], b = outline[(i + 1) % n], c = outline[(i + 2) % n];
    const bool folds_back = turn(a, b, c) == 0 && (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y) < 0;
    require(!folds_back, "expected an outline that does not cross itself, but it folds back at point {}", (i + 1) % n);
    for (size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours share a point
      require(!segments_meet(a, b, outline[j], outline[(j + 1) % n]),
              "expected an outline that does not cross itself, but its sides {} and {} meet", i, j);
    }
  }
}

// Triangles of a simple counter-clockwise polygon, by ear clipping (Meisters 1975). Cost: O(n²) to O(n³).
std::vector<std::array<uint32_t, 3>> triangulate(const std::vector<Vec2>& polygon) {
  std::vector<uint32_t> left(polygon.size());
  std::iota(left.begin(), left.end(), 0u);
  std::vector<std::array<uint32_t, 3>> triangles;
  const auto is_ear = [&](size_t k, double least_turn) {
    const size_t n = left.size();
    const uint32_t a = left[(k + n - 1) % n], b = left[k], c = left[(k + 1) % n];
    if (turn(polygon[a], polygon[b], polygon[c]) <= least_turn) return false;
    return std::none_of(left.begin(), left.end(), [&](uint32_t p) {
      return p != a && p != b && p != c && turn(polygon[a], polygon[b], polygon[p]) >= 0 &&
             turn(polygon[b], polygon[c], polygon[p]) >= 0 && turn(polygon[c], polygon[a], polygon[p]) >= 0;
    });
  };
  while (left.size() > 3) {
    size_t ear = 0;
    while (ear < left.size() && !is_ear(ear, 0)) ++ear;
    if (ear == left.size())  // only collinear points remain between ears: cut off a flat one
      for (ear = 0; ear < left.size() && !is_ear(ear, -1e-300); ++ear) {
      }
    require(ear < left.size(), "expected an outline that can be cut into triangles, but {} points are left over",
            left.size());
    const size_t n = left.size();
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + ptrdiff_t(ear));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace

Mesh make_extrusion(const std::vector<Vec2>& given, double depth) {
  check_side(depth, "an extrusion", "depth");
  std::vector<Vec2> outline;
  for (Vec2 p : given) {
    require(std::isfinite(p.x) && std::isfinite(p.y), "expected finite points in an outline, got ({}, {})", p.x, p.y);
    if (outline.empty() || !(outline.back() == p)) outline.push_back(p);
  }
  while (outline.size() > 1 && outline.front() == outline.back()) outline.pop_back();
  check_outline(outline);
  const size_t n = outline.size();
  double area = 0;
  for (size_t i = 0; i < n; ++i) area += turn({0, 0}, outline[i], outline[(i + 1) % n]);
  require(area != 0, "expected an outline with an area, got {} points on a line", n);
  if (area < 0) std::reverse(outline.begin(), outline.end());

  Vec2 low = outline[0], high = outline[0];
  for (Vec2 p : outline) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  Mesh mesh;
  mesh.name = "extrusion";
  const auto caps = triangulate(outline);
  for (double side : {1.0, -1.0}) {
    const auto first = uint32_t(mesh.positions.size());
    for (Vec2 p : outline) {
      mesh.positions.push_back({p.x, p.y, side * depth / 2});
      mesh.normals.push_back({0, 0, side});
      mesh.texture_coordinates.push_back({(p.x - low.x) / (high.x - low.x), (p.y - low.y) / (high.y - low.y)});
    }
    for (auto [a, b, c] : caps)
      mesh.triangles.push_back(side > 0 ? std::array{first + a, first + b, first + c}
                                        : std::array{first + c, first + b, first + a});
  }
  for (size_t i = 0; i < n; ++i) {
    const Vec2 a = outline[i], b = outline[(i + 1) % n];
    add_face(mesh, {a.x, a.y, -depth / 2}, {b.x - a.x, b.y - a.y, 0}, {0, 0, depth});
    // The corners of the new face have exactly the positions of the caps' corners, bit for bit.
    const size_t corner = mesh.positions.size() - 4;
    mesh.positions[corner + 1] = {b.x, b.y, -depth / 2};
    mesh.positions[corner + 2] = {b.x, b.y, depth / 2};
    mesh.positions[corner + 3] = {a.x, a.y, depth / 2};
  }
  return mesh;
}

}  // namespace holotrace
