#pragma once

#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/source_part.h"
#include "holotrace/view/sensor.h"
#include "holotrace/wave/shared/placed_field.h"

namespace holotrace {

/// The irradiance that a sensor without a lens records of the light that leaves an SLM, focused at `distance` [m]:
/// behind the panel for a virtual image, in front of it for a real one; the other way round for a negative distance. Applies the stop that the encoder asked for.
///
/// With camera.pupil > 0 an eye receives the light: only light through a round pupil about camera.eye, parallel to the
/// panel, is used. The field is propagated to a window about the pupil in its plane, cut there, and propagated from
/// there (forward or back) to the plane in focus: an eye focused on that plane, its retina in the plane's own scale. An
/// eye outside the eyebox causes a warning. Order 0 of the panel's middle covers |x| ≤ z·tan(asin(λ/2p)) on the axis,
/// at z·λ/p from those of its neighbours. Beyond it (and beyond the panel's own width) there is less than half of
/// order 0, or none, and of other orders only those that the samples represent.
///
/// With camera.focal_length f > 0 a thin lens fills that pupil, and the sensor is where it images the plane in focus,
/// s from the lens. Sizes are then those on the sensor:
///
///     m = f/(s − f),   s = eye.z + distance (virtual image) or eye.z − distance (real),   I_sensor(m·x) = I(x)/m²
///
/// with x upright, as a camera turns its picture, and the axis at x = 0 for every position of the lens (a lens that is
/// shifted along the sensor). Pictures from several places thus coincide in the plane in focus. A width or height of 0
/// means the image of the panel's window, a pixel of 0 that of a panel pixel. The lens is exact for the
/// plane in focus, without the aberrations of a real one.
///
/// The sensor's pixels, and the number of samples of the field per pixel, are in sensor.h. By default each
/// pixel integrates the irradiance over its area (mean_over_pixels, expose.h). Its centre is free, and counted from the middle that
/// camera.window names (middle_of_window), unless `propagation` has a window.
///
/// With an extended source the irradiance is that of all the directions in `source`, whose middle lights the panel:
/// the picture is convolved with the image of the source (source_image.h).
///
/// The light goes to the device that propagation.device names, unless it is there already. There it passes stop, pupil and
/// free space, and is integrated over the pixels: 4 bytes per pixel come back (with an extended source 4 per sample, and
/// the processor goes on). light_in_pupil and focus_light choose the device `auto`, each for itself.
///
/// @return        irradiance [W/m²]
/// @throws Error  for a distance that is not finite, a size below 0, an eye behind the panel or, on it, beside it, a lens without a
///                pupil or nearer than f to the plane, a sensor smaller than a sample or a pixel, a window given twice
///                (by the camera's and by the propagation's), and as propagate does
Image look(const PlacedField& shown, const Slm& slm, double distance, const PropagateParams& propagation,
           const CameraParams& camera, const Observer& observer = {}, const SourcePart& source = {});
Image look(const Field& shown, const Slm& slm, double distance, const PropagateParams& propagation,
           const CameraParams& camera, const Observer& observer = {}, const SourcePart& source = {});

/// The properties of a field that a sensor depends on.
FieldShape shape_of(const Field& field);

/// Light that passed a camera's pupil.
struct PassedLight {
  PlacedField light;  ///< from light_in_pupil with the same camera
  FieldShape shown;   ///< of the shown field
};

/// The second step of look: what a camera sees of the light that its pupil passes (pupil_light.h). The device `auto` is
/// the one that is expected to be the fastest: the way of the light from where it is counts, and that of the picture back.
Image focus_light(const PassedLight& passed, const Slm& slm, double distance, const PropagateParams& propagation,
                  const CameraParams& camera, const Observer& observer = {}, const SourcePart& source = {});

/// What the middle of a camera's window shows in the plane at `distance`: its place there, as tangents from the panel's centre
/// (the place over |distance|). With ViewWindow::eye and a pupil in front of the panel, it is where the line from the eye through the
/// panel's centre goes; else 0.
Vec2 middle_of_window(const CameraParams& camera, double distance, ImageSide image);

/// Magnification m of the image of the plane at `distance` on the sensor; 1 without a lens.
/// @throws Error  for a lens without a pupil, or nearer than its focal length to the plane
double magnification(const CameraParams& camera, double distance, ImageSide image);

/// Bytes that look needs beside the shown field, mostly for its propagation. For checks before a job begins.
double looking_bytes(const FieldShape& shown, const Slm& slm, double distance, const PropagateParams& propagation,
                     const CameraParams& camera, const SourcePart& source = {});

/// @throws Error  unless the pupil is 0 m (none) or more and, with a pupil, the eye is not behind the panel
void check_eye(const CameraParams& camera);

/// The light of a hologram, as far as axial_reach depends on it.
struct HologramLight {
  double wavelength = 0;  ///< [m]
  ImageSide image = ImageSide::virtual_image;
  std::optional<SpectralFilter> filter{};  ///< stop of the encoder
  double cone_wavelength = 0;              ///< acceptance wavelength of its waves [m]; 0: its own
  LightLosses losses{};                    ///< as in Hologram
};

/// Fraction of the light of a point on the axis at `distance` that a panel accepts and sends on in order 0. A white
/// surface there appears brighter by this factor.
///
///     r = Π_axes ∫ sinc²(w·p·(u + u₀)) dx / side,   u = x/(λ√(x² + distance²))
///
/// with w the lit part of a pixel's side on that axis. The integral is over the part of the panel's side where |u| is
/// below 1/2p, or below the half width of the encoder's stop (centred at u₀), and from which light reaches the camera's
/// pupil. Waves that keep to the cone of another wavelength (Label::cone_wavelength; 0: their own) end at
/// 1/2p·cone_wavelength/λ. Without a loss by the cone the integral ends at the panel's side; without a loss by the pixels
/// the factor sinc² is 1. The result is in [0, 1]; it is 1 at a distance of 0 m, where it has no meaning.
double axial_reach(const Slm& slm, const HologramLight& light, double distance, const CameraParams& camera);

/// The irradiance shown as white in all the views: the exposure given, or that of the brightest view.
double common_white(const std::vector<Image>& views, double exposure);

/// A render as the sensor would see it. Its window in the plane at `distance` [m] (render.h: the plane in focus, or any
/// plane for a pinhole at the panel's centre) falls on the sensor at x = distance·tan; each sensor pixel gets the
/// mean of the render over its area. Black beyond the render's window.
///
/// @param half_tangent  half the height of the render, as a tangent
/// @return              radiance, as large as `sensor`, with the channels of the render
Image project_render(const Image& render, double half_tangent, const Image& sensor, double distance);

}  // namespace holotrace
