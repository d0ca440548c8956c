#pragma once

#include <array>
#include <optional>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/trace/geometry/box_tree.h"
#include "holotrace/trace/paths/lamp_rays.h"
#include "holotrace/trace/paths/specular_chain.h"

// What is known in advance of caustics, the light of small lamps (points, spots, beams, rectangles) that mirrors and glass
// throw on surfaces: bundles of rays, and where they go.

namespace holotrace {

/// Rays of a square that the same mirrors and glass surfaces send to neighbouring places.
struct LightBundle {
  RaySquare rays;
  std::vector<SpecularVertex> chain;  ///< of one ray, from the lamp on
  Vec2 known;                         ///< coordinates of that ray
  Vec3 place;                         ///< that it lights [m]
  Frame across;                       ///< z is the unit direction in which it arrives

  /// To first order, ray p is at a·(p − known) across that direction where the known ray is at `place`, and runs at an angle
  /// b·(p − known) to it. Columns: derivatives by p and q.
  std::array<Vec2, 2> a, b;

  /// The same for a ray that starts elsewhere on a rectangle. Columns: derivatives by the start, measured in its two edges.
  std::array<Vec2, 2> by_start{}, turned_by_start{};
  double limit =
      1;  ///< largest |p| and |q| at which the first order, or the chain's planes, may show a ray of this bundle
};

/// The bundles of one lamp, and for each of them a box around the places that it lights.
struct LampBundles {
  std::vector<LightBundle> bundles;
  BoxTree boxes;
};

/// What is known in advance about the light that mirrors and glass throw on other surfaces.
struct Caustics {
  /// Of each light of the scene, for each hero one after another; empty if there is no bundle.
  std::vector<LampBundles> lamps;
  bool has_uneven =
      false;  ///< whether light by a mirror or glass with a normal map, or with an opacity below 1, was left out
  bool has_long = false;        ///< whether light by more than most_chained surfaces was left out
  bool has_rectangles = false;  ///< whether a rectangle has bundles, so that such light is found in two ways

  bool is_empty() const { return lamps.empty(); }

  /// The bundles of one of the scene's lights.
  const LampBundles& of(size_t light, size_t lights, const Hero& hero) const {
    return lamps[size_t(hero.line) * lights + light];
  }
};

inline constexpr int most_chained = 12;  ///< mirrors and glass surfaces between a lamp and the surface that it lights

/// Sends rays from all small lamps toward the meshes that reflect as mirrors do or refract, and follows all reflections and
/// refractions to the surfaces that scatter. Empty if there are no such lamps or meshes. A rectangle is a small lamp for
/// surfaces that are twice its diagonal away, or more.
///
/// Chains that DirectLight finds without help are left out: for lamps that no ray can meet, straight through panes, and by one
/// flat mirror.
///
/// @param rays  number of rays from each lamp, about; 0: no caustics
Caustics find_caustics(const PathScene& scene, int rays);

/// The coordinates of the ray that reaches a place, to first order.
/// @param on_lamp  where on a rectangle it starts, measured in its edges from the middle
std::optional<Vec2> first_guess(const LightBundle& bundle, Vec3 place, Vec2 on_lamp);

}  // namespace holotrace
