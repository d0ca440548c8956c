#pragma once

#include <cstdint>
#include <optional>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"
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

/// The reading of a sensor after a whole exposure, with shot noise and read noise:
///
///     n ~ Poisson(N·I/white),   reading = clamp(n + σ·g, 0, N)·white/N,   g ~ Normal(0, 1)
///
/// N = camera.electrons is the full well, the electrons of a white pixel; σ = camera.read_noise. Below the full well a
/// reading of m electrons has the variance m + σ². I is the sum of all frames and colours of one exposure. Each channel
/// of a colour picture counts as a pixel of its own; negative light (CombinedViews) counts as 0. The levels of the
/// picture's file add another rounding. Random numbers come from counters, fixed by the seed and `exposure`.
///
/// @param view      irradiance [W/m²]
/// @param white     irradiance that fills a pixel [W/m²], above 0
/// @param exposure  number of the exposure; each has its own noise
/// @return          irradiance as read, in [0, white]; the view itself if camera.electrons is 0
/// @throws Error    as check_sensor does, and for a white that is not above 0
/// Reference: J. R. Janesick, Photon Transfer, 2007, chapters 3 and 5. Poisson numbers: standard library.
Image add_sensor_noise(const Image& view, double white, const CameraParams& camera, uint32_t exposure = 0);

/// @throws Error  for electrons outside 0 … 1e12, a read noise below 0, or a read noise without electrons
void check_sensor(const CameraParams& camera);

}  // namespace holotrace
