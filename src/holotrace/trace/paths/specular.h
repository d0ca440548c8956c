#pragma once

#include <vector>

#include "holotrace/trace/geometry/accelerator.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/path_scene.h"

namespace holotrace {

/// A mirror or a smooth piece of glass on the way from the panel.
struct SpecularVertex {
  SurfacePoint point;
  Vec3 normal;           ///< unit, on the side of the ray, of the mirror or lens that does to the ray what was done
  bool is_transmission;  ///< refracted, or straight through a pane
  double near, far;      ///< refractive index before it and beyond it
};

/// What a branch of mirrors and glass ends at: a surface that scatters; the mirror or glass surface itself, which
/// shines; a light with an area (RectangleLight), which is seen in reflections; or nothing, infinitely far away.
enum class LeafKind { surface, glow, light, beyond };

/// How a wavefront that has come to a panel by way of mirrors and glass began: at a surface that scatters or
/// shines, or infinitely far away.
struct SpecularLeaf {
  LeafKind kind = LeafKind::surface;
  PathStart start;                    ///< where; beyond all surfaces only `outgoing` and what follows it
  int light = 0;                      ///< its index, for LeafKind::light
  Vec3 weight{1, 1, 1};               ///< share of the radiance that reaches the panel, at the lines
  Vec3 phase;                         ///< that the mirrors and glass add [rad], at the lines: Fresnel's
  double optical_path = 0;            ///< Σ n·d from the ray's origin to the surface [m]
  double distance = 0;                ///< R, from the ray's origin to where the wavefront seems to come from [m]
  bool is_far = false;                ///< R is the cap for wavefronts that are parallel or converge
  std::vector<SpecularVertex> chain;  ///< from the panel on; empty: seen directly
};

/// Where waves stand that are parallel at the panel, nearly so or converge [m]: at 100 m the curvature that is left
/// over 10 mm is 10⁻⁶ m, two waves; a converging wave becomes a flat one, its focus before the panel is lost.
inline constexpr double farthest_origin = 100;

/// What a ray from the panel finds behind mirrors and glass: the tree of their reflections and refractions, followed
/// without chance down to the first surfaces that scatter (a smooth coat over a diffuse base is one: its mirror image
/// stays on it), at most `max_depth` surfaces deep and to branches that
/// carry a thousandth of the light.
///
/// **Apparent distance.** A leaf's point Q is kept fixed while the ray's origin moves by δq across it; its direction
/// must then change by δs = −J_d⁻¹·J_q δq, J_q and J_d being the derivatives of the place where the ray meets the
/// leaf's plane. C = J_d⁻¹·J_q is the curvature of the wavefront at the panel, and
///
///     R = 2/tr C
///
/// The derivatives are central differences of the chain traced again in double, at the planes of the same
/// triangles, whose normals go on linearly beyond their edges. R is exact (to 1e-8) for plane mirrors, the total
/// distance, and for slabs of glass, the apparent depth; curved mirrors and lenses of smooth triangles follow their
/// focal law. Where the two principal curvatures differ (oblique incidence on glass or curved mirrors:
/// astigmatism), one spherical wave cannot be both: R is that of their mean. For leaves that have escaped the final
/// direction is kept fixed instead of the point.
///
/// The surfaces' places and the optical path, too, are those of the chain in double: the offset by which rays leave
/// a surface (Accelerator::leave) is not in them.
///
/// @param ray     from the panel; unit direction
/// @param counts  rays are added here, and `cut` for branches at max_depth
/// @return        the leaves; none where the ray itself meets nothing
///
/// Cost: a ray for each branch, and 8 passes over the chain for each leaf.
/// Reference: the ray-transfer matrix of a general optical system, M. Born and E. Wolf, Principles of Optics, 4.6.
std::vector<SpecularLeaf> follow_specular(const PathScene& scene, const Ray& ray, PathCounts& counts);

/// The leaf alone that the same reflections and refractions as those of `model` lead to from another ray, if any.
std::optional<SpecularLeaf> follow_like(const PathScene& scene, const Ray& ray, const SpecularLeaf& model,
                                        PathCounts& counts);

/// Whether a leaf that follow_like has found from `place` is what the model shows there, not something that stands
/// before or beyond it:
///
/// - behind facets all flat, whose images stand still, where the model's chain, traced again from the place, meets the
///   plane of the model's leaf, but for rounding and for what a leaf's own curvature adds as the ray wanders over it;
/// - behind curved ones, where images move, within a thousandth of the optical path from that plane.
///
/// In any case within a hundredth of the path from the model's leaf. Leaves infinitely far away are always alike.
bool shows_the_same(const PathScene& scene, const SpecularLeaf& found, const SpecularLeaf& model, const Ray& ray);

}  // namespace holotrace
