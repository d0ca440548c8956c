#pragma once

#include <optional>
#include <vector>

#include "holotrace/trace/geometry/accelerator.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/path_scene.h"
#include "holotrace/trace/paths/specular_chain.h"

namespace holotrace {

/// What a branch of mirrors and glass ends at: a surface that scatters (surface); the mirror or glass surface itself,
/// which emits (glow); a light with an area (RectangleLight), seen by reflection (light); or nothing, infinitely far
/// away (beyond).
enum class LeafKind { surface, glow, light, beyond };

/// The focal lines of a wavefront with two curvatures, on a ray from the panel. Distances are from the ray's origin along it [m];
/// < 0: the light converges. A line is at most farthest_line away.
struct FocalLines {
  double first = 0, second = 0;  ///< |first| ≥ |second|
  Vec3 line;                     ///< unit vector along the first one, at right angles to the ray and the second one
};

/// Start of a wavefront that reaches the panel by mirrors and glass: at a surface that scatters or emits, or infinitely
/// far away.
struct SpecularLeaf {
  LeafKind kind = LeafKind::surface;
  PathStart start;          ///< start; if infinitely far away, only `outgoing` and the members after it
  int light = 0;            ///< index of the light, for LeafKind::light
  Vec3 weight{1, 1, 1};     ///< share of the radiance that reaches the panel, at the lines
  Vec3 phase;               ///< Fresnel phase that the mirrors and glass add at the lines [rad]
  double optical_path = 0;  ///< Σ n·d from the ray's origin to the surface [m]
  double distance = 0;      ///< R, from the ray's origin along it to the origin of the wavefront [m]; < 0: it converges
  bool is_far = false;      ///< whether R was set to farthest_origin (parallel wavefront)
  std::optional<FocalLines> lines;    ///< behind mirrors and glass, if the chain can be traced for displaced rays
  std::vector<SpecularVertex> chain;  ///< surfaces from the panel on; empty if seen directly
};

/// Distance used for waves that are parallel or nearly parallel at the panel [m]. At 100 m the sag left over 10 mm is
/// 10⁻⁶ m, two waves.
inline constexpr double farthest_origin = 100;

/// Distance of waves from infinitely far away that reach the panel without mirrors or glass [m]: their sag over 10 mm is 5·10⁻⁹ m, a
/// hundredth of a wave.
inline constexpr double background_distance = 1e4;

/// Largest distance of a focal line [m]: its sag over 10 mm is 5·10⁻¹⁰ m, a thousandth of a wave.
inline constexpr double farthest_line = 1e5;

/// What a ray from the panel finds behind mirrors and glass. It follows the whole tree of their reflections and
/// refractions, without random choice, down to the first surfaces that scatter. A smooth coat over a diffuse base
/// counts as such a surface: its mirror image stays on it. Branches end after `max_depth` surfaces, or if they
/// carry less than a thousandth of the light.
///
/// **Apparent distance.** A leaf's point Q is kept fixed while the ray's origin moves across it by δq. Its direction
/// must then change by δs = −J_d⁻¹·J_q δq, where J_q and J_d are the derivatives of the place where the ray meets the
/// leaf's plane. C = J_d⁻¹·J_q is the curvature of the wavefront at the panel, and
///
///     R = 2/tr C
///
/// The derivatives are those of the chain, traced again in double at the planes of the same triangles,
/// whose normals are extended linearly beyond their edges. R is exact (to 1e-8) for plane mirrors (the total distance)
/// and for slabs of glass (the apparent depth). Curved mirrors and lenses of smooth triangles follow their focal
/// law. Where the two principal curvatures of C differ (astigmatism: oblique incidence on glass or curved mirrors), R is that of
/// their mean, and the focal lines are at their own places. For leaves infinitely far away, the final direction is kept fixed
/// instead of the point.
///
/// The places on the surfaces and the optical path also come from the chain in double. They do not contain the offset
/// by which rays leave a surface (Accelerator::leave).
///
/// @param ray     from the panel; unit direction
/// @param counts  the rays are added here, and to `cut` the branches that end at max_depth
/// @return        the leaves; none if the ray itself meets nothing, unless PathParams::shows_background
///
/// Cost: one ray for each branch, and two passes over the chain for each leaf.
/// Reference: the ray-transfer matrix of a general optical system, M. Born and E. Wolf, Principles of Optics, 4.6.
std::vector<SpecularLeaf> follow_specular(const PathScene& scene, const Ray& ray, PathCounts& counts);

/// Follows another ray by the same reflections and refractions as those of `model`, to the leaf at their end, if any.
std::optional<SpecularLeaf> follow_like(const PathScene& scene, const Ray& ray, const SpecularLeaf& model,
                                        PathCounts& counts);

/// Whether a leaf that follow_like has found from `place` shows the same point as the model, and not something in front
/// of it or behind it:
///
/// - Behind flat facets only, whose images do not move: it must lie where the model's chain, traced again from `place`,
///   meets the plane of the model's leaf, up to rounding and the leaf's own curvature as the ray moves over it.
/// - Behind curved facets, whose images move: within a thousandth of the optical path from that plane.
///
/// In both cases within a hundredth of the path from the model's leaf. Leaves infinitely far away always agree.
bool shows_the_same(const PathScene& scene, const SpecularLeaf& found, const SpecularLeaf& model, const Ray& ray);

}  // namespace holotrace
