#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The scene as a pinhole at the panel's centre sees it, looking along −z: the picture that the
/// hologram's reconstruction is measured against. Radiance in red, green and blue [W/m²/sr], row 0 on top.
///
/// Pixels are square and even in the tangents: the height spans ±T, T = tan(field_of_view) or the panel's
/// acceptance_tangent; the width ±T·columns/rows. Each pixel is the mean of `paths` light paths
/// (path_radiance) through places stratified over it.
///
/// A luminous point of amplitude a that no mesh hides adds its light to the four pixels around it, as the white
/// radiance that would make the same wave in `trace` (pattern grid) from a cell of that pixel's tangent area dA:
///
///     L = a² / (dA·cos²θ)
///
/// @param scene       at z < 0 [m]
/// @param panel       for its acceptance, where no field_of_view is given
/// @param wavelength  for the same [m]; colours do not depend on it
/// @param params      columns 0: square picture
/// @param observer    hears the facts of `report`
/// @throws Error      as `trace` does
Image render(const Scene& scene, const Grid& panel, double wavelength, const RenderParams& params,
             const Observer& observer = {});

}  // namespace holotrace
