#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/shared/lanes.h"
#include "holotrace/trace/shared/ray.h"

// Sampling of lights from a surface point, and the lights that rays can meet. To add a light: give its
// struct a place in data/scene.h and write its functions here; std::visit finds them.

namespace holotrace {

/// A direction from a surface point to a light. With f·cosθ of the surface toward it, the reflected light is
/// f·cosθ·radiance/pdf, if nothing lies between.
struct LightSample {
  Vec3 direction;       ///< unit, from the surface point to the light
  double distance = 0;  ///< [m]; infinite for parallel light and an environment
  Vec3 radiance;        ///< [W/m²/sr]; for point, spot and directional lights the irradiance across it [W/m²]
  double pdf = 1;       ///< [1/sr]; 1 for these lights, which no ray can meet
  double cosine = 0;    ///< |cosθ'| at the emitting surface, 0 without one
  double size = 0;      ///< none of that surface's corners is farther from the sampled point [m]
};

/// Samples of this density or more are left out: they arrive at a vanishing angle to the light, and squares stay finite.
inline constexpr double most_light_density = 1e150;

/// A shadow ray ends before a light's surface by its rounding, over the distance of its corners, and at grazing angles by
/// as much as at this cosine.
inline constexpr double light_rounding = 2e-6, least_light_cosine = 0.01;

/// Whether a ray can meet the light. If so, sampling and meeting share the light.
inline bool has_area(const Light& light) { return std::holds_alternative<RectangleLight>(light); }

/// The irradiance of a point light across the direction is I/d².
inline LightSample sample(const PointLight& light, Vec3 from, Vec2) {
  const Vec3 way = light.position - from;
  const double squared = dot(way, way);
  if (squared == 0) return {};
  const double distance = std::sqrt(squared), inverse = 1 / distance;
  return {way * inverse, distance, light.intensity * (inverse * inverse), 1};
}

/// Fraction of its full intensity that a spot light emits at an angle off its axis, given the angle's cosine:
/// x²(3 − 2x), x = (cosθ − cos outer)/(cos inner − cos outer) limited to [0, 1].
inline double spot_falloff(const SpotLight& light, double cosine) {
  const double inner = std::cos(light.inner_angle), outer = std::cos(light.outer_angle);
  if (cosine >= inner) return 1;
  if (cosine <= outer) return 0;
  const double x = (cosine - outer) / (inner - outer);
  return x * x * (3 - 2 * x);
}

inline LightSample sample(const SpotLight& light, Vec3 from, Vec2) {
  LightSample way = sample(PointLight{light.position, light.intensity}, from, {});
  way.radiance *= spot_falloff(light, -dot(way.direction, light.direction));
  return way;
}

/// Parallel light within its radius of the axis; the beam has no start.
inline LightSample sample(const DirectionalLight& light, Vec3 from, Vec2) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Vec3 offset = cross(from - light.position, light.direction);
  if (std::isfinite(light.radius) && dot(offset, offset) > light.radius * light.radius) return {};
  return {-light.direction, infinity, light.irradiance, 1};
}

/// The place u.x and u.y edges from the corner; both in [0, 1] on the rectangle [m].
inline Vec3 place_on(const RectangleLight& light, Vec2 u) {
  return light.corner + light.edge_u * u.x + light.edge_v * u.y;
}

/// The u of place_on of a place in the plane of the rectangle.
inline Vec2 edges_to(const RectangleLight& light, Vec3 place) {
  const Vec3 normal = cross(light.edge_u, light.edge_v), way = place - light.corner;
  const double squared = dot(normal, normal);
  return {dot(cross(way, light.edge_v), normal) / squared, dot(cross(light.edge_u, way), normal) / squared};
}

/// A place uniform over the area A: its density over solid angle is d²/(A·cosθ'), θ' the angle at the light.
inline LightSample sample(const RectangleLight& light, Vec3 from, Vec2 u) {
  const Vec3 way = place_on(light, u) - from;
  const double projected = -dot(cross(light.edge_u, light.edge_v), way);  // A·cosθ'·d
  if (projected <= 0) return {};
  const double squared = dot(way, way), distance = std::sqrt(squared);
  const double area = length(cross(light.edge_u, light.edge_v));
  return {way * (1 / distance),
          distance,
          light.radiance,
          squared * distance / projected,
          light.is_visible ? projected / (area * distance) : 0,
          length(light.edge_u) + length(light.edge_v)};
}

/// Draws a direction from the point `from` [m] to a light, by two numbers in [0, 1). Radiance 0 means that the light
/// does not reach the point.
inline LightSample sample_light(const Light& light, Vec3 from, Vec2 u) {
  if (const auto* rectangle = std::get_if<RectangleLight>(&light)) return sample(*rectangle, from, u);
  if (const auto* point = std::get_if<PointLight>(&light)) return sample(*point, from, u);
  return std::visit([&](const auto& l) { return sample(l, from, u); }, light);
}

/// Density with which `sample` draws the place that a ray has met, for its distance [m] and cosθ' to the normal
/// [1/sr].
inline double pdf(const RectangleLight& light, double distance, double cosine) {
  return distance * distance / (length(cross(light.edge_u, light.edge_v)) * cosine);
}

/// Intersection of a ray with the emitting side of a rectangle: the distance [m], and the density with which `sample`
/// draws that direction from the ray's origin [1/sr].
struct LightHit {
  double distance, pdf;
};

inline std::optional<LightHit> meet(const RectangleLight& light, const Ray& ray) {
  const Vec3 normal = cross(light.edge_u, light.edge_v), way = light.corner - ray.origin;
  const double projected = -dot(normal, ray.direction);  // A·cosθ'
  if (projected <= 0) return std::nullopt;
  const double distance = -dot(normal, way) / projected;
  if (!(distance > 0)) return std::nullopt;
  const Vec2 u = edges_to(light, ray.origin + ray.direction * distance);
  if (u.x < 0 || u.y < 0 || u.x > 1 || u.y > 1) return std::nullopt;
  return LightHit{distance, distance * distance / projected};
}

/// Optical path in vacuum from a laser to a point [m]. From a point light it is the distance; from a beam the distance
/// from the plane through its position, normal to it, below 0 before that plane. None for a light without phase.
inline std::optional<double> laser_path(const Light& light, Vec3 to) {
  if (const auto* point = std::get_if<PointLight>(&light); point && point->is_laser)
    return length(to - point->position);
  if (const auto* beam = std::get_if<DirectionalLight>(&light); beam && beam->is_laser)
    return dot(to - beam->position, beam->direction);
  return std::nullopt;
}

/// Emitting rectangles or triangles, of which each of several paths samples one; or a point light for all of them.
struct LightLanes {
  LaneVectors corner;     ///< [m]
  bool is_point = false;  ///< a light at the corner; of the others below, only its intensity is set: radiance [W/sr]
  LaneVectors edge_u, edge_v;  ///< [m]; edge_u × edge_v points to where it shines
  Lane per_size;               ///< 1/|edge_u × edge_v| [1/m²]
  Lane density;                ///< of places on the emitter [1/m²]
  Lane size;                   ///< no corner is farther from a place on the emitter [m]
  Lane two_sided;              ///< 1: it shines to both sides; 0: to one
  LaneVectors radiance;        ///< at the lines [W/m²/sr]
  bool are_triangles =
      false;  ///< places (u, v) are √u·((1 − v)·edge_u + v·edge_v) from the corner, not u·edge_u + v·edge_v
  bool are_surfaces = true;  ///< rays meet the emitter
  double lift = 0;           ///< of that surface (light_lifts) [m]
};

/// Numbers in [0, 1) that select the places on them.
struct PlaceLanes {
  Lane u, v;

  void set(size_t i, Vec2 place) { u[i] = place.x, v[i] = place.y; }
};

/// One light for all paths.
/// @param lift  of its surface [m]
LightLanes lanes_of(const RectangleLight& light, double lift);
LightLanes lanes_of(const PointLight& light);

}  // namespace holotrace
