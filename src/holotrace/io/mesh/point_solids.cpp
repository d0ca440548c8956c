#include "holotrace/io/mesh/point_solids.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

constexpr size_t most_solids = 400'000;
constexpr double least_opacity = 0.3;

// Three columns of a file as vectors, if it has them.
struct Columns {
  std::array<const std::vector<double>*, 3> of{};

  Columns(const PlyVertices& points, const std::array<const char*, 3>& names) {
    for (size_t c = 0; c < 3; ++c) of[c] = points.find(names[c]);
  }
  bool are_there() const { return of[0] && of[1] && of[2]; }
  Vec3 at(size_t i) const { return {(*of[0])[i], (*of[1])[i], (*of[2])[i]}; }
};

// Median distance to the fourth-nearest point, from some of the points.
double spacing_of(const std::vector<Vec3>& places) {
  constexpr size_t samples = 256, neighbours = 4;
  const size_t count = std::min(samples, places.size());
  std::vector<double> distances(count);
  parallel_for(0, int64_t(count), [&](int64_t k) {
    const Vec3 from = places[size_t(k) * places.size() / count];
    std::array<double, neighbours> nearest{};
    nearest.fill(std::numeric_limits<double>::infinity());
    for (const Vec3 place : places) {
      const Vec3 way = place - from;
      const double squared = dot(way, way);
      if (squared == 0 || squared >= nearest.back()) continue;
      nearest.back() = squared;
      std::sort(nearest.begin(), nearest.end());
    }
    const auto farthest = std::find_if(nearest.rbegin(), nearest.rend(), [](double d) { return std::isfinite(d); });
    distances[size_t(k)] = farthest == nearest.rend() ? 0 : std::sqrt(*farthest);
  });
  std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(count / 2), distances.end());
  return distances[count / 2];
}

// An octahedron: its axes are the half axes of an ellipsoid.
void add_ball(Vec3 centre, const std::array<Vec3, 3>& axes, Mesh& mesh) {
  const auto first = uint32_t(mesh.positions.size());
  for (const Vec3 axis : axes)
    for (const double side : {1.0, -1.0}) {
      mesh.positions.push_back(centre + axis * side);
      mesh.normals.push_back(normalize(axis) * side);
    }
  const bool is_left_handed = dot(cross(axes[0], axes[1]), axes[2]) < 0;
  for (uint32_t x = 0; x < 2; ++x)
    for (uint32_t y = 2; y < 4; ++y)
      for (uint32_t z = 4; z < 6; ++z) {
        const bool is_odd = ((x + y + z) % 2 == 1) != is_left_handed;
        mesh.triangles.push_back({first + x, first + (is_odd ? z : y), first + (is_odd ? y : z)});
      }
}

void add_disc(Vec3 centre, Vec3 normal, double radius, Mesh& mesh) {
  const auto first = uint32_t(mesh.positions.size());
  const Frame frame = frame_from_normal(normal);
  for (int corner = 0; corner < 6; ++corner) {
    const double angle = pi * corner / 3;
    mesh.positions.push_back(centre + (frame.x * std::cos(angle) + frame.y * std::sin(angle)) * radius);
    mesh.normals.push_back(normal);
  }
  for (uint32_t corner = 2; corner < 6; ++corner) mesh.triangles.push_back({first, first + corner - 1, first + corner});
}

// The half axes of a splat: exp(scale) along the axes that its quaternion (w, x, y, z) turns to.
std::array<Vec3, 3> axes_of_splat(Vec3 scale, double w, Vec3 q) {
  const double norm = std::sqrt(w * w + dot(q, q));
  w /= norm;
  q = q / norm;
  return {
      Vec3{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y + w * q.z), 2 * (q.x * q.z - w * q.y)} * std::exp(scale.x),
      Vec3{2 * (q.x * q.y - w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z + w * q.x)} * std::exp(scale.y),
      Vec3{2 * (q.x * q.z + w * q.y), 2 * (q.y * q.z - w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)} * std::exp(scale.z)};
}

}  // namespace

void add_point_solids(const PlyVertices& points, const std::vector<Vec3>& colours, Mesh& mesh,
                      std::vector<std::string>& warnings) {
  const Columns scale(points, {"scale_0", "scale_1", "scale_2"}), turn(points, {"rot_1", "rot_2", "rot_3"}),
      normal(points, {"nx", "ny", "nz"}), place(points, {"x", "y", "z"});
  const bool are_splats = scale.are_there();
  require(!are_splats || (turn.are_there() && points.find("rot_0") && points.find("opacity")),
          "{}: expected rot_0 to rot_3 and opacity beside scale_0 of splats, got some of them; export it again",
          points.path);
  std::vector<size_t> shown;
  for (size_t i = 0; i < points.count; ++i)
    if (!are_splats || 1 / (1 + std::exp(-(*points.find("opacity"))[i])) >= least_opacity) shown.push_back(i);
  require(!shown.empty(), "{}: expected splats of an opacity of {} or more, got none", points.path, least_opacity);
  if (shown.size() > most_solids) {
    warnings.push_back(fmt::format("{}: {} of its {} points are shown", points.path, most_solids, shown.size()));
    std::vector<size_t> some(most_solids);
    for (size_t k = 0; k < most_solids; ++k) some[k] = shown[k * shown.size() / most_solids];
    shown = std::move(some);
  }
  std::vector<Vec3> places;
  for (const size_t i : shown) places.push_back(place.at(i));
  const double radius = are_splats ? 0 : 0.75 * spacing_of(places);
  require(are_splats || radius > 0, "{}: expected points at different places, got a single point", points.path);
  mesh.positions.clear();
  mesh.normals.clear();
  mesh.texture_coordinates.clear();
  mesh.colours.clear();
  for (size_t k = 0; k < shown.size(); ++k) {
    const size_t i = shown[k], before = mesh.positions.size();
    const Vec3 n = normal.are_there() ? normal.at(i) : Vec3{};
    if (are_splats)
      add_ball(places[k], axes_of_splat(scale.at(i), (*points.find("rot_0"))[i], turn.at(i)), mesh);
    else if (is_finite(n) && length(n) > 0)
      add_disc(places[k], normalize(n), radius, mesh);
    else
      add_ball(places[k], {Vec3{radius, 0, 0}, {0, radius, 0}, {0, 0, radius}}, mesh);
    const size_t added = mesh.positions.size() - before;
    if (!colours.empty()) mesh.colours.insert(mesh.colours.end(), added, colours[i]);
  }
}

}  // namespace holotrace
