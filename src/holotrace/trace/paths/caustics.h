#pragma once

#include <cstddef>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/trace/shared/ray.h"

// Light of small lamps (points, spots, beams, rectangles), thrown on surfaces by mirrors and glass: caustics.

namespace holotrace {

struct PathScene;
struct PathCounts;

/// Light of one lamp that reaches a place by one chain of mirrors and glass.
struct CausticLight {
  Vec3 direction;    ///< unit, from the place toward the last surface of the chain
  Vec3 radiance;     ///< of a rectangle, at the lines [W/m²/sr]; else the irradiance across the direction [W/m²]
  double pdf = 1;    ///< of a rectangle, see below [1/sr]; else 1
  int surfaces = 0;  ///< mirrors and glass surfaces on the way
  bool is_parted = false;   ///< whether dispersive glass is among them: only the light at the hero's line goes this way
  double optical_path = 0;  ///< Σ n·d from the lamp to the place; for a beam, from the plane through its position [m]
  double index = 1;         ///< refractive index of the medium at the place
  Vec3 phase{};             ///< that the surfaces add at the lines [rad], and −π/2 for each focal line on the way

  /// A surface of the chain, and its directions toward the place and toward the lamp.
  struct Turn {
    SurfacePoint point;
    Vec3 outgoing, incoming;
  };
  std::vector<Turn> turns{};  ///< from the place to the lamp, if polarization is followed; else empty
};

/// A light of the scene, and a place of it if it has an area.
struct LampPlace {
  size_t light;  ///< index into Scene::lights
  Vec3 start{};  ///< the place of a rectangle from which light comes [m]
  /// Whose way it goes; light at the other lines counts where nothing parts them (CausticLight::is_parted).
  Hero hero{};
};

/// All light that a lamp throws on a place by mirrors and glass; what lies in its way hides it.
///
/// The place x lies in the boxes of some bundles. In each of them the ray that reaches x is found by Newton's method: the
/// planes of the chain's triangles, with their normals extended beyond the edges, give the ray's coordinates; the real ray at
/// them gives the triangles for the next step, until they remain the same. The light of this ray is then exact,
///
///     E = I(ω)·Πᵢ Tᵢ · |dω/dA|      (parallel light: E₀·Πᵢ Tᵢ·|dA₀/dA|),
///
/// with the reflectances and transmittances Tᵢ of power, and the area dA across the ray at x that the solid angle dω of the
/// lamp lights. The derivatives are those of the chain in double (retrace). At a focal line dA is 0. Where several images of a
/// lamp are seen from x, each counts once.
///
/// The bundles decide which images are found, but not how bright they are: there is no blur and no noise. Images fainter than
/// a thousandth of the lamp, as far away, are left out, and so are chains of less than a thousandth of its light.
///
/// Rectangles are sampled at one place each. Paths meet them as well, and the two share the light (add_radiance, path.h). A
/// place of density 1/A has this density over the solid angle dω at x, divided by the share of light that the chain lets pass,
/// which is about the share of paths that take it:
///
///     pdf = dA/dω / A / max(Πᵢ Tᵢ).
///
/// Light on x from the rectangle is then f·cosθ·radiance/pdf·w with the weight w of DirectLight. Images that are not found are
/// left to paths alone (caustic_pdf), so nothing is missed or counted twice.
///
/// @param most_surfaces  longer chains are left out
/// @param with_phase     whether optical_path and phase are needed
///
/// Cost: 10 to 20 µs where caustics lie.
/// Reference: W. Jakob and S. Marschner, Manifold Exploration, ACM Trans. Graph. 31(4), 2012, for Newton's method on chains;
/// D. Mitchell and P. Hanrahan, Illumination from Curved Reflectors, SIGGRAPH 1992, for the light of the images.
std::vector<CausticLight> caustic_light(const PathScene& scene, const SurfacePoint& place, LampPlace lit_by,
                                        int most_surfaces, bool with_phase, PathCounts& counts);

/// The pdf of the light that a path has found: it left the place in that direction, and met the rectangle by a number of mirrors
/// and glass surfaces. 0 if caustic_light does not find it, with the same most_surfaces. The two are the same if, by the chain of
/// the one, the direction of the other leads to the same place of the lamp, up to a hundredth of the lamp and to rounding.
double caustic_pdf(const PathScene& scene, const SurfacePoint& place, Vec3 direction, LampPlace met, int surfaces,
                   int most_surfaces, PathCounts& counts);

}  // namespace holotrace
