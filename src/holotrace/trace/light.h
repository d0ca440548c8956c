#pragma once

#include <cmath>
#include <variant>

#include "holotrace/base/random.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"

// How a surface point asks a light for its light. To add a light: give its struct a place in
// data/scene.h, write its `sample` here, and std::visit finds it.

namespace holotrace {

/// A way from a surface point to a light. With f·cosθ of the surface toward it, the light reflected is
/// f·cosθ·radiance/pdf, if nothing stands between.
struct LightSample {
  Vec3 position;   ///< on the light [m]
  Vec3 direction;  ///< unit, from the surface point to it
  Vec3 radiance;   ///< [W/m²/sr]; of a point light I/d² [W/m²]
  double pdf = 1;  ///< [1/sr]; of a point light 1
};

/// The irradiance of a point light at normal incidence is I/d².
inline LightSample sample(const PointLight& light, Vec3 from, double, double) {
  const Vec3 way = light.position - from;
  const double squared = dot(way, way);
  if (squared == 0) return {light.position, {}, {}, 1};
  return {light.position, way / std::sqrt(squared), light.intensity / squared, 1};
}

/// A place evenly over the area A: its density over solid angle is d²/(A·cosθ'), θ' the angle at the light.
inline LightSample sample(const RectangleLight& light, Vec3 from, double u, double v) {
  const Vec3 position = light.corner + light.edge_u * u + light.edge_v * v;
  const Vec3 way = position - from, area_normal = cross(light.edge_u, light.edge_v);
  const double distance = length(way);
  if (distance == 0) return {position, {}, {}, 1};
  const Vec3 direction = way / distance;
  const double projected_area = -dot(area_normal, direction);  // A·cosθ'
  if (projected_area <= 0) return {position, direction, {}, 1};
  return {position, direction, light.radiance, distance * distance / projected_area};
}

template <class Other>
LightSample sample(const Other&, Vec3 from, double, double) {
  return {from, {}, {}, 1};
}

/// Draws a way from the point `from` [m] to a light, by two numbers in [0, 1).
inline LightSample sample_light(const Light& light, Vec3 from, double u, double v) {
  return std::visit([&](const auto& l) { return sample(l, from, u, v); }, light);
}

}  // namespace holotrace
