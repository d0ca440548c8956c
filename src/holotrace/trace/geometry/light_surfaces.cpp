#include "holotrace/trace/geometry/light_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include "holotrace/base/error.h"

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
  return !scene.meshes.empty() ||
         std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& l) { return visible_rectangle(l); });
}

ScenePrecision precision_of(const Scene& scene) {
  const std::vector<LightSurface> lamps = light_surfaces(scene);
  const auto for_each_vertex = [&](const auto& visit) {
    const auto of_mesh = [&](const Mesh& mesh) {
      for (const auto& triangle : mesh.triangles)
        for (const uint32_t index : triangle) visit(mesh.positions[index]);
    };
    for (const Mesh& mesh : scene.meshes) of_mesh(mesh);
    for (const LightSurface& lamp : lamps) of_mesh(lamp.mesh);
  };
  ScenePrecision precision;
  Vec3 sum;
  double weights = 0, spread = 0;
  constexpr double nearest = 1e-6;  // [m]; keeps the weight of a vertex on the panel finite
  const auto weight_of = [](Vec3 p) { return std::pow(dot(p, p) + nearest * nearest, -1.5); };
  for_each_vertex([&](Vec3 p) {
    sum += p * weight_of(p);
    weights += weight_of(p);
  });
  precision.centre = sum / weights;
  for_each_vertex([&](Vec3 p) {
    const double distance = length(p - precision.centre);
    spread += weight_of(p) * distance;
    precision.radius = std::max(precision.radius, distance);
  });
  precision.unit = spread / weights;
  // If all vertices are in one place, their distances from the mean are rounding errors.
  require(std::isfinite(precision.radius) && precision.unit > 1e-14 * length(precision.centre),
          "expected meshes that fill some space, got all vertices in one place");
  return precision;
}

namespace {

struct Box {
  Vec3 low, high;
};

template <class Corners>
Box box_of(const Corners& corners, double margin) {
  Box box{corners[0], corners[0]};
  for (const Vec3& p : corners) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
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

std::vector<Mesh> lifted_light_surfaces(const Scene& scene) {
  std::vector<Mesh> lifted;
  std::vector<LightSurface> surfaces = light_surfaces(scene);
  if (surfaces.empty()) return lifted;
  const std::vector<double> lifts = light_lifts(scene, precision_of(scene));
  for (size_t n = 0; n < surfaces.size(); ++n) {
    auto& p = surfaces[n].mesh.positions;
    const Vec3 front = normalize(cross(p[1] - p[0], p[3] - p[0]));
    for (Vec3& position : p) position += front * lifts[n];
    lifted.push_back(std::move(surfaces[n].mesh));
  }
  return lifted;
}

}  // namespace holotrace
