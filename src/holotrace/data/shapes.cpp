#include "holotrace/data/shapes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

void check_side(double side, const char* shape, const char* name) {
  require(std::isfinite(side) && side > 0, "expected a {} of {} above 0 m, got {} m", name, shape, side);
}

// A flat face a, a + u, a + u + v, a + v with the normal u × v and texture coordinates (0,0) … (1,1).
void add_face(Mesh& mesh, Vec3 a, Vec3 u, Vec3 v) {
  const auto first = uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, a + u, a + u + v, a + v});
  mesh.normals.insert(mesh.normals.end(), 4, normalize(cross(u, v)));
  mesh.texture_coordinates.insert(mesh.texture_coordinates.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

// Light of an image at the fractional pixel (x, y): bilinear interpolation, channels weighted.
double light_at(const Image& image, Vec3 weights, double x, double y) {
  const auto pixel = [&](int row, int column) -> double {
    if (image.channels < 3) return image(row, column);
    return weights.x * image(row, column, 0) + weights.y * image(row, column, 1) + weights.z * image(row, column, 2);
  };
  const int i = std::min(int(x), image.nx - 1), j = std::min(int(y), image.ny - 1);
  const int i1 = std::min(i + 1, image.nx - 1), j1 = std::min(j + 1, image.ny - 1);
  const double s = x - i, t = y - j;
  return (1 - t) * ((1 - s) * pixel(j, i) + s * pixel(j, i1)) + t * ((1 - s) * pixel(j1, i) + s * pixel(j1, i1));
}

}  // namespace

std::vector<ScenePoint> make_wireframe_cube(double size, int per_edge) {
  check_side(size, "a wireframe cube", "size");
  require(per_edge >= 2, "expected 2 points or more on an edge of a wireframe cube, got {}", per_edge);
  const int last = per_edge - 1;
  const auto at = [&](int i) { return size * (double(i) / last - 0.5); };
  std::vector<ScenePoint> points;
  points.reserve(size_t(12) * size_t(per_edge) - 16);
  const auto add = [&](int i, int j, int k) { points.push_back({{at(i), at(j), at(k)}}); };
  for (int k : {0, last})
    for (int j : {0, last})
      for (int i : {0, last}) add(i, j, k);
  for (int a : {0, last})
    for (int b : {0, last})
      for (int i = 1; i < last; ++i) {
        add(i, a, b);
        add(a, i, b);
        add(a, b, i);
      }
  return points;
}

std::vector<ScenePoint> make_wireframe_sphere(double size, int meridians, int parallels, int per_circle) {
  check_side(size, "a wireframe sphere", "size");
  require(meridians >= 1 && parallels >= 0 && per_circle >= 3,
          "expected a wireframe sphere of 1 meridian, 0 parallels and 3 points on a circle or more, got {}, {} and {}",
          meridians, parallels, per_circle);
  const double radius = size / 2;
  std::vector<ScenePoint> points{{{0, radius, 0}}, {{0, -radius, 0}}};
  const auto add = [&](double polar, double azimuth) {
    points.push_back({{radius * std::sin(polar) * std::sin(azimuth), radius * std::cos(polar),
                       radius * std::sin(polar) * std::cos(azimuth)}});
  };
  const int steps = (per_circle + 1) / 2;  // steps from pole to pole
  for (int m = 0; m < meridians; ++m)
    for (int s = 1; s < steps; ++s) add(pi * s / steps, 2 * pi * m / meridians);
  for (int p = 1; p <= parallels; ++p) {
    // Where the parallel crosses a meridian at one of the meridian's points, that point exists already.
    const bool meets = int64_t(p) * steps % (parallels + 1) == 0;
    for (int i = 0; i < per_circle; ++i)
      if (!(meets && int64_t(i) * meridians % per_circle == 0)) add(pi * p / (parallels + 1), 2 * pi * i / per_circle);
  }
  return points;
}

std::vector<ScenePoint> make_point_quad(double width, double height, int columns, int rows, const Image* texture,
                                        Vec3 weights) {
  check_side(width, "a point quad", "width");
  check_side(height, "a point quad", "height");
  require(columns >= 2 && rows >= 2, "expected a point quad of 2 × 2 points or more, got {} × {}", columns, rows);
  require(!texture || (texture->nx > 0 && texture->ny > 0),
          "expected a texture with pixels for a point quad, got none");
  std::vector<ScenePoint> points;
  points.reserve(size_t(columns) * size_t(rows));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double s = double(i) / (columns - 1), t = double(j) / (rows - 1);
      ScenePoint point{{width * (s - 0.5), height * (0.5 - t), 0}};
      if (texture) {
        const double light = light_at(*texture, weights, s * (texture->nx - 1), t * (texture->ny - 1));
        point.amplitude = float(std::sqrt(std::max(light, 0.0)));
      }
      points.push_back(point);
    }
  return points;
}

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
