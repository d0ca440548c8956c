#include "holotrace/trace/geometry/light_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/trace/geometry/box_tree.h"

namespace holotrace {

namespace {

const RectangleLight* visible_rectangle(const Light& light) {
  const auto* rectangle = std::get_if<RectangleLight>(&light);
  return rectangle && rectangle->is_visible ? rectangle : nullptr;
}

}  // namespace

std::vector<LightSurface> light_surfaces(const Scene& scene) {
  std::vector<LightSurface> surfaces;
  for (size_t i = 0; i < scene.lights.size(); ++i)
    if (const RectangleLight* light = visible_rectangle(scene.lights[i])) {
      LightSurface surface{int(i), {}};
      const Vec3 c = light->corner, u = light->edge_u, v = light->edge_v;
      surface.mesh.positions = {c, c + u, c + u + v, c + v};
      surface.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
      surface.mesh.material = -1;
      surfaces.push_back(std::move(surface));
    }
  return surfaces;
}

bool has_surfaces(const Scene& scene) {
  return !scene.meshes.empty() || !scene.media.empty() ||
         std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& l) { return visible_rectangle(l); });
}

namespace {

/// Triangles of a mesh that one thread visits.
struct TriangleBlock {
  const Mesh* mesh;
  size_t first, last;
};

std::vector<TriangleBlock> blocks_of(const Scene& scene, const std::vector<LightSurface>& lamps) {
  constexpr size_t size = 4096;
  std::vector<TriangleBlock> blocks;
  const auto add = [&](const Mesh& mesh) {
    for (size_t first = 0; first < mesh.triangles.size(); first += size)
      blocks.push_back({&mesh, first, std::min(first + size, mesh.triangles.size())});
  };
  for (const Mesh& mesh : scene.meshes) add(mesh);
  for (const LightSurface& lamp : lamps) add(lamp.mesh);
  return blocks;
}

/// Sums over vertices p of the weight w: Σ w·p, Σ w and, d being the distance from a centre, Σ w·d and the largest d.
struct Moments {
  Vec3 first;
  double weight = 0, spread = 0, radius = 0;

  Moments& operator+=(const Moments& other) {
    first += other.first;
    weight += other.weight;
    spread += other.spread;
    radius = std::max(radius, other.radius);
    return *this;
  }
};

/// The sum of add(place, weight, moments) over the corners of all triangles. The blocks are added in their order, so the sum
/// does not depend on the number of threads.
template <class Add>
Moments sum_over(const std::vector<TriangleBlock>& blocks, const Add& add) {
  constexpr double nearest = 1e-6;  // [m]; keeps the weight of a vertex on the panel finite
  std::vector<Moments> sums(blocks.size());
  parallel_for(0, int64_t(blocks.size()), [&](int64_t b) {
    const auto& [mesh, first, last] = blocks[size_t(b)];
    for (size_t t = first; t < last; ++t)
      for (const uint32_t index : mesh->triangles[t]) {
        const Vec3 p = mesh->positions[index];
        const double squared = dot(p, p) + nearest * nearest;
        add(p, 1 / (squared * std::sqrt(squared)), sums[size_t(b)]);
      }
  });
  Moments total;
  for (const Moments& sum : sums) total += sum;
  return total;
}

}  // namespace

ScenePrecision precision_of(const Scene& scene) {
  const std::vector<LightSurface> lamps = light_surfaces(scene);
  const std::vector<TriangleBlock> blocks = blocks_of(scene, lamps);
  ScenePrecision precision;
  const Moments mean = sum_over(blocks, [](Vec3 p, double weight, Moments& sum) {
    sum.first += p * weight;
    sum.weight += weight;
  });
  precision.centre = mean.first / mean.weight;
  const Moments around = sum_over(blocks, [&](Vec3 p, double weight, Moments& sum) {
    const double distance = length(p - precision.centre);
    sum.spread += weight * distance;
    sum.radius = std::max(sum.radius, distance);
  });
  precision.radius = around.radius;
  precision.unit = around.spread / mean.weight;
  // If all vertices are in one place, their distances from the mean are rounding errors.
  require(std::isfinite(precision.radius) && precision.unit > 1e-14 * length(precision.centre),
          "expected meshes that fill some space, got all vertices in one place");
  return precision;
}

namespace {

template <class Corners>
Box box_of(const Corners& corners, double margin) {
  Box box;
  for (const Vec3& p : corners) box.include(p);
  const Vec3 around{margin, margin, margin};
  return {box.low - around, box.high + around};
}

bool touch(const Box& a, const Box& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

constexpr double light_lift = 2;  // clearances

}  // namespace

std::vector<double> light_lifts(const Scene& scene, const ScenePrecision& precision) {
  std::vector<double> lifts;
  for (const LightSurface& lamp : light_surfaces(scene)) {
    double clearance = precision.clearance_of(lamp.mesh.positions);
    const Box box = box_of(lamp.mesh.positions, clearance);
    for (const Mesh& mesh : scene.meshes)
      for (const auto& [i, j, k] : mesh.triangles) {
        const std::array<Vec3, 3> corners{mesh.positions[i], mesh.positions[j], mesh.positions[k]};
        const double other = precision.clearance_of(corners);
        if (other > clearance && touch(box, box_of(corners, other))) clearance = other;
      }
    lifts.push_back(light_lift * clearance);
  }
  return lifts;
}

std::vector<double> light_lifts(const Scene& scene) {
  return light_surfaces(scene).empty() ? std::vector<double>{} : light_lifts(scene, precision_of(scene));
}

Mesh lifted(const LightSurface& surface, double lift) {
  Mesh mesh = surface.mesh;
  auto& p = mesh.positions;
  const Vec3 front = normalize(cross(p[1] - p[0], p[3] - p[0]));
  for (Vec3& position : p) position += front * lift;
  return mesh;
}

std::vector<Mesh> lifted_light_surfaces(const Scene& scene, const std::vector<double>& lifts) {
  std::vector<Mesh> meshes;
  const std::vector<LightSurface> surfaces = light_surfaces(scene);
  for (size_t n = 0; n < surfaces.size(); ++n) meshes.push_back(lifted(surfaces[n], lifts[n]));
  return meshes;
}

}  // namespace holotrace
