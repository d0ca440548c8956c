#include "holotrace/trace/depth_range.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/data/acceptance.h"
#include "holotrace/trace/geometry/accelerator.h"

namespace holotrace {

std::optional<DepthRange> depth_range(const Scene& scene, const Grid& panel, double wavelength) {
  constexpr int side = 96;  // rays along each axis from each place
  const Accelerator accelerator(scene);
  const double tangent = std::min(10.0, acceptance_tangent(wavelength, panel.pitch));
  const double half_width = panel.width() / 2, half_height = panel.height() / 2;
  std::vector<double> depths;
  const auto add = [&](Vec3 place) {
    if (place.z < 0 && std::abs(place.x) <= half_width && std::abs(place.y) <= half_height) depths.push_back(-place.z);
  };
  for (const ScenePoint& point : scene.points) add(point.position);
  for (const Vec2 at : {Vec2{0, 0}, Vec2{-0.5, -0.5}, Vec2{0.5, -0.5}, Vec2{-0.5, 0.5}, Vec2{0.5, 0.5}}) {
    const Vec3 from{at.x * half_width, at.y * half_height, 0};
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const auto slope = [&](int k) { return tangent * (2 * (k + 0.5) / side - 1); };
        const Ray ray{from, normalize({slope(i), slope(j), -1})};
        if (const auto hit = accelerator.closest_hit(ray)) add(hit->point.position);
      }
  }
  if (depths.empty()) return std::nullopt;
  std::sort(depths.begin(), depths.end());
  const size_t left_out = depths.size() / 200;
  return DepthRange{depths[left_out], depths[depths.size() - 1 - left_out]};
}

}  // namespace holotrace
