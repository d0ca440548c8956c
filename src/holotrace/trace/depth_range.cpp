#include "holotrace/trace/depth_range.h"

#include <algorithm>
#include <cmath>

#include "holotrace/data/acceptance.h"
#include "holotrace/trace/paths/path_scene.h"
#include "holotrace/trace/paths/specular.h"

namespace holotrace {
namespace {

// All but the 0.5 % nearest and farthest depths.
DepthRange range_of(std::vector<double> depths) {
  std::sort(depths.begin(), depths.end());
  const size_t left_out = depths.size() / 200;
  return {depths[left_out], depths[depths.size() - 1 - left_out]};
}

}  // namespace

std::vector<DepthRange> depth_ranges(const Scene& scene, const Grid& panel, double wavelength) {
  constexpr int side = 215;                // rays along each axis of their directions
  constexpr double least_light = 0.1;      // of an image, as a part of that of its object
  constexpr size_t places_of_image = 100;  // one place in so many
  const PathScene path_scene(scene, Lines(), {}, {.caustic_rays = 0});
  const double tangent = std::min(10.0, acceptance_tangent(wavelength, panel.pitch));
  const double half_width = panel.width() / 2, half_height = panel.height() / 2;
  std::vector<double> surfaces, images;
  const auto add = [&](Vec3 place, std::vector<double>& depths) {
    if (place.z != 0 && std::abs(place.x) <= half_width && std::abs(place.y) <= half_height) depths.push_back(-place.z);
  };
  for (const ScenePoint& point : scene.points) add(point.position, surfaces);
  PathCounts counts;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      // Places spread evenly over the panel (the sequence R2): near it, each ray sees a small part of the scene only.
      const double number = j * side + i;
      const auto spread = [&](double step) { return 2 * (number * step - std::floor(number * step)) - 1; };
      const Vec3 from{half_width * spread(0.7548776662466927), half_height * spread(0.5698402909980532), 0};
      const auto slope = [&](int k) { return tangent * (2 * (k + 0.5) / side - 1); };
      const Ray ray = path_scene.accelerator.from_viewer({from, normalize({slope(i), slope(j), -1})});
      if (const auto hit = path_scene.accelerator.closest_hit(ray)) add(hit->point.position, surfaces);
      for (const SpecularLeaf& leaf : follow_specular(path_scene, ray, counts))
        if (!leaf.chain.empty() && leaf.kind != LeafKind::beyond && !leaf.is_far &&
            max_component(leaf.weight) >= least_light)
          add(ray.origin + ray.direction * leaf.distance, images);
    }
  std::vector<DepthRange> ranges;
  if (!surfaces.empty()) ranges.push_back(range_of(surfaces));
  if (!images.empty() && places_of_image * images.size() >= surfaces.size()) ranges.push_back(range_of(images));
  if (ranges.size() < 2) return ranges;
  if (ranges[1].nearest < ranges[0].nearest) std::swap(ranges[0], ranges[1]);
  if (ranges[1].nearest <= ranges[0].farthest)
    return {{ranges[0].nearest, std::max(ranges[0].farthest, ranges[1].farthest)}};
  return ranges;
}

}  // namespace holotrace
