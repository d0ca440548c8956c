#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// The pixels of a sensor, and the samples of the field that each of them is read from.
struct Sensor {
  Grid pixels;
  PropagateParams window;  ///< of the samples: the pixels, and `rim` samples more on every side
  int samples = 1;         ///< per pixel and axis
  int rim = 0, blur = 0;   ///< samples beyond the pixels on every side, and those of them that a blur takes
  bool is_integrated = true;
};

/// The sensor that a camera asks for, in the plane at `z` [m] from the panel (the object plane of a lens).
///
/// With camera.pixel > 0: pixels of that side, as many as its width and height hold. Else its pixels hold
/// camera.binning² samples of the propagation's window (0: one panel pixel), and that window has an even number of
/// samples more or less than the panel's; samples beyond the last whole pixel are left out with a warning.
///
/// camera.sampling = integrate takes samples that hold the irradiance, whose band is twice the field's: 2/pitch of the
/// panel's samples at most, and 2·aperture/λz, for the panel and for the pupil as apertures; and at least 2 per pixel
/// unless a pixel is below a third of what the field's band resolves (mean_over_pixels has the reason). point takes
/// camera.binning² samples per pixel, at least 1.
///
/// @param blur     reach of a blur of the irradiance [m]: light that far beyond the pixels counts in them
/// @throws Error   for a size, a pixel or a binning below 0, a sensor smaller than a sample or a pixel, and a window
///                 given twice (by the camera's and by the propagation's)
Sensor sensor_of(const Grid& shown, const Slm& slm, double wavelength, double z, const PropagateParams& propagation,
                 const CameraParams& camera, double blur = 0, const Observer& observer = {});

/// The pixels of n × n samples that a grid holds. Where it does not divide evenly, samples are left out evenly at
/// opposite sides (the odd one at the right and at the bottom) and a warning says so.
/// @throws Error  unless n is from 1 to the grid's shorter side
Grid pixels_of(const Grid& samples, int n, const Observer& observer = {});

/// The window of n × n samples in each of the pixels, and of `rim` samples beyond them on every side.
PropagateParams window_of(const Grid& pixels, int n, int rim, PropagateParams propagation = {});

}  // namespace holotrace
