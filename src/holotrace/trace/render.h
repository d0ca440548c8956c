#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The scene as an eye before the panel sees it: the picture that the hologram's reconstruction is measured
/// against, light added without interference. Radiance in red, green and blue [W/m²/sr], row 0 on top.
///
/// **Window.** The picture's window is fixed in the plane z = −f, f = `focus`. Pixels are square and even in the
/// tangents tₓ, t_y from the panel's centre: the height spans ±T, T = tan(field_of_view) or the panel's
/// acceptance_tangent; the width ±T·columns/rows. A pixel stands for the places X = (tₓ·f, t_y·f, −f), whatever the
/// eye and its lens: pictures of different eyes lie on each other in the plane in focus.
///
/// **Lens.** A pixel is the mean of `paths` light paths along rays q → X, X stratified over the pixel:
/// - `pinhole`: q = eye. With the eye at the origin the focus does not matter.
/// - `round`: q even over a disc of diameter `pupil` about the eye, parallel to the panel. A point of depth d, seen
///   from an eye on the panel, blurs in the plane in focus to a disc of diameter pupil·|d − f|/d.
/// - `panel`: q even over the part of the panel that can send light to X: |q − X| ≤ f·acceptance_tangent in x and in y,
///   the box of every point on the ray. What a lensless camera at f finds in the hologram's image, but for speckle. The
///   eye does not matter; a pixel without such a part is black.
///
/// Rectangle lights are seen if they are visible. Light that meets no surface is a path `EL`.
///
/// A luminous point of amplitude a and depth d₀ that no mesh hides from the eye (for `panel`: from its centre) at the
/// distance r and the angle θ to the axis, adds its light to the four pixels around its place in the window, sharp
/// whatever the lens. Its white radiance L is that which sends the wave's irradiance to the eye from the solid angle of
/// the pixel, of the tangent area dA, seen by the eye at z:
///
///     L·dA·(f/(f + z))²·cos⁴θ = a²·(d₀/r)²        for an eye at the origin  L = a²/(dA·cos²θ), as in `trace`
///
/// @param scene       at z < 0 [m]
/// @param panel       for its acceptance, where no field_of_view is given, and its area as a lens
/// @param wavelength  for the acceptance [m]; colours do not depend on it
/// @param params      columns 0: square picture. Several path groups add up, a path in two of them twice
/// @param observer    hears the facts of `report`
/// @throws Error      as `trace` does, and for an eye behind the panel (z < 0), a focus or pupil of 0 or less
///
/// Cost: as `trace`, one first hit per path.
Image render(const Scene& scene, const Grid& panel, double wavelength, const RenderParams& params,
             const Observer& observer = {});

}  // namespace holotrace
