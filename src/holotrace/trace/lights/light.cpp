#include "holotrace/trace/lights/light.h"

namespace holotrace {

LightLanes lanes_of(const RectangleLight& light, double lift) {
  LightLanes lanes;
  lanes.are_surfaces = light.is_visible;
  lanes.lift = lift;
  lanes.corner.fill(light.corner);
  lanes.edge_u.fill(light.edge_u);
  lanes.edge_v.fill(light.edge_v);
  lanes.per_size.fill(1 / length(cross(light.edge_u, light.edge_v)));
  lanes.density = lanes.per_size;
  lanes.size.fill(length(light.edge_u) + length(light.edge_v));
  lanes.two_sided.fill(0);
  lanes.radiance.fill(light.radiance);
  return lanes;
}

LightLanes lanes_of(const PointLight& light) {
  LightLanes lanes;
  lanes.is_point = true;
  lanes.corner.fill(light.position);
  lanes.radiance.fill(light.intensity);
  return lanes;
}

}  // namespace holotrace
