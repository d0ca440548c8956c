#pragma once

#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/source_part.h"

namespace holotrace {

/// What a sensor without a lens sees of the light that leaves an SLM, focused at `distance` [m] ≥ 0: behind
/// the panel for a virtual image, before it for a real one. Applies the stop that the encoder asked for.
///
/// With camera.pupil > 0 an eye takes the light: only what passes a round pupil about camera.eye, parallel to the
/// panel, goes on. The field is propagated to a window about the pupil in its plane, cut there, and from there (forward
/// or back) to the plane looked at: an eye that focuses on that plane, its retina in the plane's own scale. An eye
/// outside the eyebox is a warning: order 0 of the panel's middle goes to |x| ≤ z·tan(asin(λ/2p)) about the axis, at
/// z·λ/p from those of its neighbours, and beyond it (and beyond the panel's own width) there is less than half of
/// order 0, or none, and only what other orders the samples hold.
///
/// With camera.focal_length f > 0 a thin lens fills that pupil, and the sensor stands where it images the plane looked
/// at, at s from the lens. Sizes are then the sensor's:
///
///     m = f/(s − f),   s = eye.z + distance (virtual image) or eye.z − distance (real),   I_sensor(m·x) = I(x)/m²
///
/// with x upright, as a camera turns its picture, and the axis on x = 0 wherever the lens is (a lens that is shifted
/// along the sensor): pictures from several places lie on each other in the plane in focus. A width or height of 0 is
/// the image of the panel's window, a pixel of 0 that of a panel pixel. What the lens does to light is exact for the
/// plane in focus but for the aberrations of a real one.
///
/// Which pixels the sensor has, and of how many samples of the field each is read, is in sensor.h: by default each
/// pixel integrates the irradiance over its area (mean_over_pixels, expose.h). Its centre is free.
///
/// With an extended source the irradiance is that of all the directions in `source`, whose middle lit the panel:
/// the picture convolved with the source's own (source_image.h).
///
/// @return        irradiance [W/m²]
/// @throws Error  for a distance or a size below 0, an eye behind the panel or, on it, beside it, a lens without a
///                pupil or nearer than f to the plane, a sensor smaller than a sample or a pixel, a window given twice
///                (by the camera's and by the propagation's), and as propagate does
Image look(const Field& shown, const Slm& slm, double distance, const PropagateParams& propagation,
           const CameraParams& camera, const Observer& observer = {}, const SourcePart& source = {});

/// How much larger than the plane at `distance` its image on the sensor is: m, 1 without a lens.
/// @throws Error  for a lens without a pupil, or nearer than its focal length to the plane
double magnification(const CameraParams& camera, double distance, ImageSide image);

/// Bytes that look takes beside the field that is shown, its propagation above all. For checks before a job begins.
double looking_bytes(const Grid& shown, const Slm& slm, double wavelength, double distance, ImageSide image,
                     const PropagateParams& propagation, const CameraParams& camera, const SourcePart& source = {});

/// @throws Error  unless the pupil is 0 m (none) or more, and the eye behind one not behind the panel
void check_eye(const CameraParams& camera);

/// Part of the light of a point on the axis at `distance` that a panel takes in and sends on in order 0: what a white
/// surface there is the brighter for.
///
///     r = Π_axes ∫ sinc²(w·p·(u + u₀)) dx / side,   u = x/(λ√(x² + distance²))
///
/// with w the lit part of a pixel's side on that axis, over the part of the panel's side where |u| is below 1/2p, or
/// below the half width of the encoder's stop (centred at u₀), and that light on its way to the pupil of the camera
/// passes. Waves that keep to the cone of another wavelength (Sources::cone_wavelength; 0: their own) end at
/// 1/2p·cone_wavelength/λ. [0, 1]; 1 at a distance of 0 m, where it has no meaning.
double axial_reach(const Slm& slm, double wavelength, double distance, ImageSide image, const CameraParams& camera,
                   const std::optional<SpectralFilter>& filter, double cone_wavelength = 0);

/// The irradiance that is white in all the views: the exposure given, or the brightest view's own.
double common_white(const std::vector<Image>& views, double exposure);

/// A render as the sensor would see it: its window in the plane at `distance` [m] (render.h: the plane in focus, or any
/// plane for a pinhole at the panel's centre) falls on the sensor at x = distance·tan, each sensor pixel taking the
/// mean of the render over its area. Black past the render's window.
///
/// @param half_tangent  of the render's height
/// @return              radiance, as large as `sensor`, with the channels of the render
Image project_render(const Image& render, double half_tangent, const Image& sensor, double distance);

}  // namespace holotrace
