#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/exposure.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The scene as an eye in front of the panel sees it, with light added without interference. The hologram's
/// reconstruction is compared with this picture. Radiance in red, green and blue [W/m²/sr], row 0 on top.
///
/// **Window.** The picture's window is fixed in the plane z = −f, f = `focus`. Pixels are square, and evenly spaced in
/// the tangents tₓ, t_y from the panel's centre: the height spans ±T, T = tan(field_of_view) or the panel's
/// acceptance_tangent; the width ±T·columns/rows; its middle is in the direction (azimuth, elevation). A pixel stands for the places X = (tₓ·f, t_y·f, −f), for every
/// eye and lens. Pictures for different eyes therefore coincide in the plane in focus.
///
/// **Lens.** A pixel is the mean of `paths` light paths along rays q → X, X stratified over the pixel:
/// - `pinhole`: q = eye. For an eye at the origin the focus does not matter.
/// - `round`: q uniform over a disc of diameter `pupil` about the eye, parallel to the panel. A point of depth d, seen
///   from an eye on the panel, is blurred in the plane in focus to a disc of diameter pupil·|d − f|/d.
/// - `panel`: q uniform over the part of the panel that can send light to X: |q − X| ≤ f·acceptance_tangent in x and in
///   y, the box of every point on the ray. This is what a lensless camera at f records of the hologram's image, without
///   speckle. The eye does not matter; a pixel without such a part is black.
///
/// Rectangle lights are seen if they are visible. Light that meets no surface is a path `EL`.
///
/// A luminous point has amplitude a and depth d₀. If no mesh hides it from the eye (for `panel`: from its centre), at
/// the distance r and the angle θ to the axis, it adds its light to the four pixels around its place in the window,
/// sharp for every lens. Its white radiance L sends the wave's irradiance to the eye from the solid angle of
/// the pixel, which has the tangent area dA and is seen by the eye at z:
///
///     L·dA·(f/(f + z))²·cos⁴θ = a²·(d₀/r)²        for an eye at the origin  L = a²/(dA·cos²θ), as in `trace`
///
/// **Shutter.** The picture of an exposure is the mean over its time: paths are drawn stratified over its moments (exposed_scene.h),
/// and the eye moves, too. A luminous point adds its mean light.
///
/// @param exposure    moments of a scene behind the panel (z < 0 [m]), in front of it (z > 0), or on both sides
/// @param panel       used for its acceptance, if no field_of_view is given, and for its area as a lens
/// @param wavelength  used for the acceptance [m]; colours do not depend on it
/// @param params      columns 0: square picture. Several path groups add up; a path in two of them counts twice
/// @param observer    receives the facts of `report`
/// @throws Error      as `trace` does, and for an eye behind the panel (z < 0), a focus or pupil of 0 or less
///
/// Cost: as `trace`, one first hit per path; and the trees of each moment.
Image render(const SceneExposure& exposure, const Grid& panel, double wavelength, const RenderParams& params,
             const Observer& observer = {});

/// Mask of a picture's pixels, row by row; a pixel that is not 0 is selected.
using PixelMask = std::vector<uint8_t>;

/// Replaces pixels of a picture by those that render makes of these parameters, to the last bit.
/// @throws Error  as render does, and unless picture and mask have the size that the parameters ask for
void render_pixels(const SceneExposure& exposure, const Grid& panel, double wavelength, const RenderParams& params,
                   const PixelMask& mask, Image& image, const Observer& observer = {});

}  // namespace holotrace
