#include "holotrace/data/shapes.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shape_parts.h"

namespace holotrace {
namespace {

// A step of a lathe's profile, with normals (radial, axial): its own, and those of the surface at its ends.
struct Step {
  double length = 0;
  Vec2 normal, start, end;
};

double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }

// Steps that meet at an angle of 30° or less, and of like lengths, are chords of one curve. A chord has the normal of the
// middle of its arc, and normals turn evenly along a circle: so the normal where two chords meet is the mean of theirs with
// the other's length as weight, and at the end of a curve the normal is that of the last chord's other end, reflected.
// Where a long step meets a short one, as a wall meets a rounded edge, it is the plain mean, and ends keep the step's own normal.
std::vector<Step> steps_of_profile(const std::vector<Vec2>& profile) {
  std::vector<Step> steps(profile.size() - 1);
  for (size_t k = 0; k < steps.size(); ++k) {
    const double dr = profile[k + 1].x - profile[k].x, dh = profile[k + 1].y - profile[k].y;
    const double length = std::hypot(dr, dh);
    steps[k] = {length, {dh / length, -dr / length}, {}, {}};
  }
  const bool closed = steps.size() > 2 && profile.front() == profile.back();
  // On the axis, a step meets its own mirror image.
  const auto mirrored = [](Step step) {
    step.normal.x = -step.normal.x;
    return step;
  };
  const auto are_alike = [](const Step& a, const Step& b) {
    return std::max(a.length, b.length) <= 2 * std::min(a.length, b.length);
  };
  struct Joint {
    bool is_smooth = false, is_curve = false;
    Vec2 normal;
  };
  const auto join = [&](const Step& step, const Step& other) -> Joint {
    if (dot(step.normal, other.normal) < std::cos(pi / 6) - 1e-12) return {};
    const bool is_curve = are_alike(step, other);
    const double a = is_curve ? other.length : 1, b = is_curve ? step.length : 1;
    const Vec2 mean{a * step.normal.x + b * other.normal.x, a * step.normal.y + b * other.normal.y};
    const double size = std::hypot(mean.x, mean.y);
    return {true, is_curve, {mean.x / size, mean.y / size}};
  };
  const auto joint_at = [&](size_t k, size_t point, bool is_end, size_t next) -> Joint {
    if (profile[point].x == 0) return join(steps[k], mirrored(steps[k]));
    return is_end && !closed ? Joint{} : join(steps[k], steps[next]);
  };
  for (size_t k = 0; k < steps.size(); ++k) {
    Step& step = steps[k];
    const size_t last = steps.size() - 1;
    const Joint before = joint_at(k, k, k == 0, k > 0 ? k - 1 : last);
    const Joint after = joint_at(k, k + 1, k == last, k < last ? k + 1 : 0);
    const auto normal_at = [&](const Joint& here, const Joint& there) {
      if (here.is_smooth) return here.normal;
      if (!there.is_curve) return step.normal;
      const double twice = 2 * dot(step.normal, there.normal);
      return Vec2{twice * step.normal.x - there.normal.x, twice * step.normal.y - there.normal.y};
    };
    const bool goes_on = k > 0 && before.is_smooth && profile[k].x > 0;
    step.start = goes_on ? steps[k - 1].end : normal_at(before, after);
    step.end = normal_at(after, before);
  }
  return steps;
}

}  // namespace

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
  const std::vector<Step> sides = steps_of_profile(profile);
  std::vector<double> along{0};  // arc length at each point
  for (const Step& side : sides) along.push_back(along.back() + side.length);

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
  uint32_t upper = 0;
  for (size_t k = 0; k < steps; ++k) {
    const bool shared = k > 0 && sides[k].start == sides[k - 1].end;
    const uint32_t lower = shared ? upper : add_ring(k, sides[k].start);
    upper = add_ring(k + 1, sides[k].end);
    for (uint32_t s = 0; s < uint32_t(segments); ++s) {
      if (profile[k].x > 0) mesh.triangles.push_back({lower + s, lower + s + 1, upper + s + 1});
      if (profile[k + 1].x > 0) mesh.triangles.push_back({lower + s, upper + s + 1, upper + s});
    }
  }
  require(!mesh.triangles.empty(), "expected a lathe profile that leaves the axis, got radius 0 throughout");
  return mesh;
}

double determinant(const Frame& frame) { return dot(frame.x, cross(frame.y, frame.z)); }

Vec3 transform_normal(const Frame& frame, Vec3 n) {
  // Normals transform by the inverse transpose, which is the cofactor matrix over the determinant.
  const Vec3 yz = cross(frame.y, frame.z), zx = cross(frame.z, frame.x), xy = cross(frame.x, frame.y);
  const double sign = determinant(frame) < 0 ? -1 : 1;
  return normalize(yz * (sign * n.x) + zx * (sign * n.y) + xy * (sign * n.z));
}

Light transform_light(const Frame& frame, Light light) {
  const double size = std::cbrt(std::abs(determinant(frame)));
  const auto turned = [&](Vec3 direction) { return normalize(transform_vector(frame, direction)); };
  if (auto* point = std::get_if<PointLight>(&light)) {
    point->position = transform_point(frame, point->position);
    point->intensity = point->intensity * (size * size);
  } else if (auto* spot = std::get_if<SpotLight>(&light)) {
    spot->position = transform_point(frame, spot->position);
    spot->direction = turned(spot->direction);
    spot->intensity = spot->intensity * (size * size);
  } else if (auto* parallel = std::get_if<DirectionalLight>(&light)) {
    parallel->position = transform_point(frame, parallel->position);
    parallel->direction = turned(parallel->direction);
    parallel->radius *= size;
  } else {
    auto& rectangle = std::get<RectangleLight>(light);
    rectangle.corner = transform_point(frame, rectangle.corner);
    rectangle.edge_u = transform_vector(frame, rectangle.edge_u);
    rectangle.edge_v = transform_vector(frame, rectangle.edge_v);
    if (determinant(frame) < 0) std::swap(rectangle.edge_u, rectangle.edge_v);  // it emits on the same side
  }
  return light;
}

void transform_mesh(const Frame& frame, Mesh& mesh) {
  for (Vec3& p : mesh.positions) p = transform_point(frame, p);
  for (Vec3& n : mesh.normals) n = transform_normal(frame, n);
  if (determinant(frame) < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

void drop_unused_vertices(Mesh& mesh) {
  constexpr uint32_t unused = UINT32_MAX;
  std::vector<uint32_t> places(mesh.positions.size(), unused);
  for (const auto& t : mesh.triangles)
    for (const uint32_t v : t) places[v] = 0;
  uint32_t count = 0;
  for (uint32_t& place : places)
    if (place != unused) place = count++;
  if (count == places.size()) return;
  const auto keep_used = [&](auto& values) {
    if (values.empty()) return;
    for (size_t v = 0; v < places.size(); ++v)
      if (places[v] != unused) values[places[v]] = values[v];
    values.resize(count);
  };
  keep_used(mesh.positions);
  keep_used(mesh.normals);
  keep_used(mesh.texture_coordinates);
  keep_used(mesh.second_coordinates);
  keep_used(mesh.colours);
  for (auto& t : mesh.triangles)
    for (uint32_t& v : t) v = places[v];
}

Mesh clip_mesh(const Mesh& mesh, const std::vector<HalfSpace>& inside) {
  Mesh clipped = mesh;
  clipped.triangles.clear();
  // A new vertex between two.
  const auto between = [&](uint32_t a, uint32_t b, double part) {
    const auto mix = [&](auto& values) {
      if (!values.empty()) values.push_back(values[a] + (values[b] - values[a]) * part);
    };
    mix(clipped.positions);
    mix(clipped.texture_coordinates);
    mix(clipped.second_coordinates);
    mix(clipped.colours);
    mix(clipped.normals);
    if (!clipped.normals.empty() && length(clipped.normals.back()) > 0)
      clipped.normals.back() = normalize(clipped.normals.back());
    return uint32_t(clipped.positions.size() - 1);
  };
  std::vector<uint32_t> polygon, cut;  // after Sutherland and Hodgman (1974)
  for (const auto& corners : mesh.triangles) {
    polygon.assign(corners.begin(), corners.end());
    for (const HalfSpace& half : inside) {
      const auto depth = [&](uint32_t i) { return dot(half.normal, clipped.positions[i]) - half.least; };
      cut.clear();
      for (size_t i = 0; i < polygon.size(); ++i) {
        const uint32_t a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        const double at_a = depth(a), at_b = depth(b);
        if (at_a >= 0) cut.push_back(a);
        if ((at_a >= 0) != (at_b >= 0)) cut.push_back(between(a, b, at_a / (at_a - at_b)));
      }
      polygon.swap(cut);
    }
    for (size_t i = 2; i < polygon.size(); ++i) clipped.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
  drop_unused_vertices(clipped);
  return clipped;
}

void bend_mesh(const std::vector<Frame>& frames, Mesh& mesh) {
  for (size_t i = 0; i < mesh.positions.size(); ++i) mesh.positions[i] = transform_point(frames[i], mesh.positions[i]);
  for (size_t i = 0; i < mesh.normals.size(); ++i) mesh.normals[i] = transform_normal(frames[i], mesh.normals[i]);
  for (auto& t : mesh.triangles)
    if (determinant(frames[t[0]]) < 0) std::swap(t[1], t[2]);
}

// Shapes of luminous points.

namespace {

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

}  // namespace holotrace
