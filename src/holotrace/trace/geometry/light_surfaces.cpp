#include "holotrace/trace/geometry/light_surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

SceneSphere sphere_around(const Scene& scene) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low{infinity, infinity, infinity}, high = -low;
  const auto include = [&](const Mesh& mesh) {
    for (const auto& triangle : mesh.triangles)
      for (uint32_t index : triangle) {
        const Vec3 p = mesh.positions[index];
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      }
  };
  for (const Mesh& mesh : scene.meshes) include(mesh);
  for (const LightSurface& surface : light_surfaces(scene)) include(surface.mesh);
  const SceneSphere sphere{(low + high) * 0.5, length(high - low) * 0.5};
  require(std::isfinite(sphere.radius) && sphere.radius > 0,
          "expected meshes that fill some space, got all vertices in one place");
  return sphere;
}

std::vector<Mesh> lifted_light_surfaces(const Scene& scene) {
  std::vector<Mesh> lifted;
  std::vector<LightSurface> surfaces = light_surfaces(scene);
  if (surfaces.empty()) return lifted;
  const double lift = light_lift * sphere_around(scene).clearance();
  for (LightSurface& surface : surfaces) {
    auto& p = surface.mesh.positions;
    const Vec3 front = normalize(cross(p[1] - p[0], p[3] - p[0]));
    for (Vec3& position : p) position += front * lift;
    lifted.push_back(std::move(surface.mesh));
  }
  return lifted;
}

}  // namespace holotrace
