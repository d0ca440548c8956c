#include "holotrace/data/shapes.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shape_parts.h"

namespace holotrace {

Mesh make_quad(double width, double height) {
  check_side(width, "a quad", "width");
  check_side(height, "a quad", "height");
  Mesh mesh;
  mesh.name = "quad";
  add_face(mesh, {-width / 2, -height / 2, 0}, {width, 0, 0}, {0, height, 0});
  return mesh;
}

Mesh make_box(Vec3 size) {
  check_side(size.x, "a box", "width");
  check_side(size.y, "a box", "height");
  check_side(size.z, "a box", "depth");
  const Vec3 h = size / 2, x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  Mesh mesh;
  mesh.name = "box";
  add_face(mesh, {-h.x, -h.y, h.z}, x, y);   // front
  add_face(mesh, {h.x, -h.y, -h.z}, -x, y);  // back
  add_face(mesh, {h.x, -h.y, h.z}, -z, y);   // right
  add_face(mesh, {-h.x, -h.y, -h.z}, z, y);  // left
  add_face(mesh, {-h.x, h.y, h.z}, x, -z);   // top
  add_face(mesh, {-h.x, -h.y, -h.z}, x, z);  // bottom
  return mesh;
}

Mesh make_sphere(double size, int segments) {
  check_side(size, "a sphere", "size");
  require(segments >= 3, "expected a sphere of 3 segments or more, got {}", segments);
  const int steps = (segments + 1) / 2;
  std::vector<Vec2> profile{{0, -size / 2}};
  for (int s = 1; s < steps; ++s) {
    const double polar = pi * s / steps;
    profile.push_back({size / 2 * std::sin(polar), -size / 2 * std::cos(polar)});
  }
  profile.push_back({0, size / 2});
  Mesh mesh = make_lathe(profile, segments);
  mesh.name = "sphere";
  for (size_t i = 0; i < mesh.positions.size(); ++i) mesh.normals[i] = normalize(mesh.positions[i]);
  return mesh;
}

Mesh make_lathe(const std::vector<Vec2>& outline, int segments) {
  require(segments >= 3, "expected a lathe of 3 segments or more, got {}", segments);
  std::vector<Vec2> profile;
  for (Vec2 p : outline) {
    require(std::isfinite(p.x) && std::isfinite(p.y) && p.x >= 0,
            "expected lathe points of a radius of 0 m or more and a finite height, got ({}, {})", p.x, p.y);
    if (profile.empty() || !(profile.back() == p)) profile.push_back(p);
  }
  require(profile.size() >= 2, "expected a lathe profile of 2 different points or more, got {}", profile.size());

  // If the profile encloses a positive volume, Σ π/3 (r₀² + r₀r₁ + r₁²)(h₁ − h₀), its outside is on the right
  // of each step, and the triangles face outward. Otherwise it is reversed.
  double volume = 0;
  for (size_t k = 0; k + 1 < profile.size(); ++k) {
    const auto [r0, h0] = profile[k];
    const auto [r1, h1] = profile[k + 1];
    volume += (r0 * r0 + r0 * r1 + r1 * r1) * (h1 - h0);
  }
  if (volume < 0) std::reverse(profile.begin(), profile.end());

  const size_t steps = profile.size() - 1;
  const bool closed = steps > 2 && profile.front() == profile.back();
  std::vector<Vec2> normals(steps);  // normal (radial, axial) of each step of the profile
  std::vector<double> along{0};      // arc length at each point
  for (size_t k = 0; k < steps; ++k) {
    const double dr = profile[k + 1].x - profile[k].x, dh = profile[k + 1].y - profile[k].y;
    const double step = std::hypot(dr, dh);
    normals[k] = {dh / step, -dr / step};
    along.push_back(along.back() + step);
  }

  std::vector<double> sine(size_t(segments) + 1), cosine(size_t(segments) + 1);
  for (int s = 0; s < segments; ++s) {
    sine[size_t(s)] = std::sin(2 * pi * s / segments);
    cosine[size_t(s)] = std::cos(2 * pi * s / segments);
  }
  sine.back() = sine.front();
  cosine.back() = cosine.front();

  Mesh mesh;
  mesh.name = "lathe";
  const auto add_ring = [&](size_t point, Vec2 normal) {
    const auto first = uint32_t(mesh.positions.size());
    for (size_t s = 0; s <= size_t(segments); ++s) {
      mesh.positions.push_back({profile[point].x * sine[s], profile[point].y, profile[point].x * cosine[s]});
      mesh.normals.push_back({normal.x * sine[s], normal.y, normal.x * cosine[s]});
      mesh.texture_coordinates.push_back({double(s) / segments, along[point] / along.back()});
    }
    return first;
  };
  const double smooth = std::cos(pi / 6);
  // The normal at the end of step k that touches step `other`: the mean of both, or the step's own at a crease.
  const auto joint = [&](size_t k, size_t other) {
    const Vec2 a = normals[k], b = normals[other];
    if (a.x * b.x + a.y * b.y < smooth - 1e-12) return a;
    const double size = std::hypot(a.x + b.x, a.y + b.y);
    return Vec2{(a.x + b.x) / size, (a.y + b.y) / size};
  };
  uint32_t upper = 0;
  for (size_t k = 0; k < steps; ++k) {
    const size_t before = k > 0 ? k - 1 : (closed ? steps - 1 : k), after = k + 1 < steps ? k + 1 : (closed ? 0 : k);
    const Vec2 start = joint(k, before);
    const bool shared = k > 0 && !(start == normals[k] && !(normals[before] == normals[k]));
    const uint32_t lower = shared ? upper : add_ring(k, start);
    upper = add_ring(k + 1, joint(k, after));
    for (uint32_t s = 0; s < uint32_t(segments); ++s) {
      if (profile[k].x > 0) mesh.triangles.push_back({lower + s, lower + s + 1, upper + s + 1});
      if (profile[k + 1].x > 0) mesh.triangles.push_back({lower + s, upper + s + 1, upper + s});
    }
  }
  require(!mesh.triangles.empty(), "expected a lathe profile that leaves the axis, got radius 0 throughout");
  return mesh;
}

void transform_mesh(const Frame& frame, Mesh& mesh) {
  // Normals transform by the inverse transpose, which is the cofactor matrix over the determinant.
  const Vec3 yz = cross(frame.y, frame.z), zx = cross(frame.z, frame.x), xy = cross(frame.x, frame.y);
  const double determinant = dot(frame.x, yz), sign = determinant < 0 ? -1 : 1;
  for (Vec3& p : mesh.positions) p = transform_point(frame, p);
  for (Vec3& n : mesh.normals) n = normalize(yz * (sign * n.x) + zx * (sign * n.y) + xy * (sign * n.z));
  if (determinant < 0)  // a reflection turns triangles inside out
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

}  // namespace holotrace
