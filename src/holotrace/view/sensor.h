#pragma once

#include <optional>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// The properties of a field in front of a camera on which the samples of a sensor depend.
struct FieldShape {
  Grid grid;
  double wavelength = 0;  ///< [m]
  ImageSide image = ImageSide::virtual_image;
  std::optional<SpectralFilter> filter{};  ///< stop that it will pass, as in Field
};

/// The pixels of a sensor, and the samples of the field from which each pixel is computed.
struct Sensor {
  Grid pixels;
  PropagateParams window;  ///< window of the samples: the pixels, and `rim` more samples on every side
  int samples = 1;         ///< samples per pixel and axis
  int rim = 0, blur = 0;   ///< samples beyond the pixels on every side; those of them that a blur needs
  bool is_integrated = true;
};

/// The sensor that a camera asks for, in the plane at `z` [m] from the panel (the object plane of a lens).
///
/// If camera.pixel > 0: pixels of that side, as many as fit the camera's width and height. Otherwise each pixel holds
/// camera.binning² samples of the propagation's window (0: one panel pixel). That window differs from the panel's by an
/// even number of samples; samples beyond the last whole pixel are left out with a warning.
///
/// camera.sampling = integrate: samples that represent the irradiance, whose band is twice the field's. The band is at
/// most 2/pitch of the panel's samples, and 2·aperture/λz for the panel and for the pupil as apertures. There are at
/// least 2 samples per pixel, unless a pixel is smaller than a third of the field's resolution (mean_over_pixels gives
/// the reason). camera.sampling = point: camera.binning² samples per pixel, at least 1.
///
/// @param blur     reach of a blur of the irradiance [m]; light up to this distance beyond the pixels counts
/// @throws Error   for a size, a pixel or a binning below 0, a sensor smaller than a sample or a pixel, and a window
///                 given twice (by the camera and by the propagation)
Sensor sensor_of(const FieldShape& shown, const Slm& slm, double z, const PropagateParams& propagation,
                 const CameraParams& camera, double blur = 0, const Observer& observer = {});

/// The pixels of n × n samples each on a grid. If the grid does not divide evenly, equally many samples are left out at
/// opposite sides (an odd one at the right and at the bottom), with a warning.
/// @throws Error  unless n is from 1 to the grid's shorter side
Grid pixels_of(const Grid& samples, int n, const Observer& observer = {});

/// The window with n × n samples in each of the pixels, and `rim` more samples on every side.
PropagateParams window_of(const Grid& pixels, int n, int rim, PropagateParams propagation = {});

}  // namespace holotrace
