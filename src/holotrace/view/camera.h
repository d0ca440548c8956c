#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// What a sensor without a lens sees of the light that leaves an SLM, focused at `distance` [m] ≥ 0: behind
/// the panel for a virtual image, before it for a real one. Applies the stop that the encoder asked for.
///
/// The sensor's window is centred and differs from the panel's by an even number of samples per axis; its
/// pixels hold camera.binning² samples of the field, 0 for those of one panel pixel.
///
/// @return        irradiance [W/m²]
/// @throws Error  for a distance or a size below 0, a sensor smaller than a sample, a window given twice (by
///                the camera's width and height and by the propagation's columns and rows), and as propagate does
Image look(const Field& shown, const Slm& slm, double distance, const PropagateParams& propagation,
           const CameraParams& camera, const Observer& observer = {});

/// The irradiance that is white in all the views: the exposure given, or the brightest view's own.
double common_white(const std::vector<Image>& views, double exposure);

/// A render as the sensor would see it: what stands at `distance` [m] falls on the sensor at x = distance·tan,
/// each sensor pixel taking the mean of the render over its area. Black past the render's window.
///
/// @param half_tangent  of the render's height
/// @param weights       of red, green and blue at the hologram's wavelength (channel_weights)
/// @return              radiance at that wavelength, as large as `sensor`
Image project_render(const Image& render, double half_tangent, Vec3 weights, const Image& sensor, double distance);

}  // namespace holotrace
