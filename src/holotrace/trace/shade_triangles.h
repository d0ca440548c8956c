#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// The triangles of a scene's meshes that the panel sees, each emitting the light that path tracing finds on
/// it (the paper's complex primitives). Sets are those of `trace`: for each wavelength, and with separate path groups
/// or lights for each of them.
///
/// **Which.** The panel sees a place from its centre or, if light from there does not reach the centre within the acceptance, from the
/// nearest place that it does reach. The place emits if no surface lies on that line, on the viewer's side of it, and by the side that
/// it turns there; one-sided materials are black from behind. Flat: the centroid decides, and its radiance is that of the whole.
/// Smooth: each corner has its own radiance (taken a hundredth of the way in, so that the ray meets this triangle),
/// 0 if it is hidden; between corners the amplitude is linear (Gouraud). A triangle is dropped if all of these are
/// dark. Where something covers only a part of a triangle, that part is not cut out. Triangles with a side above 1/64
/// of the view's height at their depth, 2·depth·T, are halved until none is. Each half has its own light and phase, so
/// that shadows and textures appear on large faces.
///
/// **Amplitudes.** a = √(L·Ω), L the radiance toward that place of the panel (`linear`: L²/(1 W/m²/sr) for L),
///
///     Ω = ∫ (d/r)² dA/d²   over the part of the panel in the box of the centroid, at its depth d [sr]
///
/// A surface of radiance L and area S, as seen from the panel, sends the power L·S·Ω through that part, and a triangle
/// sends a²·S. Brightness therefore follows radiance at any depth and wavelength, as for the waves of `trace`.
///
/// **Directions.** Light leaves toward the nearest point of the panel's part in the box, less a margin at each edge:
/// straight ahead for triangles before the panel. Light to a triangle in front of it comes from there. The margin is an eighth of that part, or the width of the
/// triangle's beam by diffraction, λd/√(2·area) for the longest wavelength, and half of the part at most.
///
/// **Phases**: random, keyed by the number of the triangle (set_frame draws another), or 0 where the light arrives.
/// With constant phases the light of a smooth surface hardly spreads; a view without a lens still shows it.
///
/// Luminous points and everything that is not a mesh are left out, mirrors and glass show images on their surface,
/// and phases of lasers are not followed. A warning names each of these.
///
/// @param scene        meshes on either side of the panel, none through it [m]
/// @param params       paths, max_depth, clamp, amplitude, path groups, seed, …: the parameters of light in `trace`
/// @param shading      flat, or smooth
/// @param observer     receives "mesh_triangles", "triangles" (after cutting) and "shining" (in all sets)
/// @throws Error       as `trace` does, for a scene without meshes, surfaces that reach through the panel's plane, a strategy other than shared, and triangles that come
///                     to more than 2^24 pieces, such as long slivers that reach far behind the panel
///
/// Cost: per triangle (smooth: three times) a ray and `paths` light paths. Same result on any number of threads.
std::vector<Triangles> shade_triangles(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                                       const TraceParams& params, Shading shading, TrianglePhase phase,
                                       const Observer& observer = {});

/// Checks the arguments of shade_triangles before it starts.
/// @throws Error  for a scene without meshes, fewer than 1 path or frame, and a strategy other than shared
void check_shading(const Scene& scene, const TraceParams& params);

}  // namespace holotrace
