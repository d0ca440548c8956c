#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/choice.h"

// expose: Field → Image

namespace holotrace {

/// What a series of views moves: nothing, the plane in focus, or the eye along x.
enum class Sweep { none, focus, parallax };

/// What a pixel of a sensor reads of the irradiance: its mean over the pixel's area, or at samples of the field alone.
enum class PixelSampling { integrate, point };

/// A sensor without a lens, as on the paper's bench, a camera with a thin lens, or an eye, and what of its reading goes
/// into a picture.
struct CameraParams {
  std::vector<double> distances{0.3};  ///< from the panel to the planes looked at [m], ≥ 0
  double pupil = 0;              ///< diameter of the eye's pupil or the lens [m]; 0: all light that leaves the panel
  Vec3 eye{0, 0, 0};             ///< place of that pupil [m], on the panel or before it: z ≥ 0
  double focal_length = 0;       ///< of a thin lens in the pupil [m]: sizes are then those on its sensor
  double width = 0, height = 0;  ///< of the sensor [m]; 0: the panel's
  double centre_x = 0, centre_y = 0;  ///< of the sensor [m]
  double pixel = 0;                   ///< side of a sensor pixel [m]; 0: `binning` field samples
  int binning = 0;  ///< field samples per sensor pixel and axis; 0: one panel pixel, or as `pixel` needs
  PixelSampling sampling = PixelSampling::integrate;
  double exposure = 0;    ///< irradiance that is white [W/m²]; 0: the 99.9th percentile
  int bits = 8;           ///< of a PNG: 8 or 16
  double electrons = 0;   ///< that a white pixel holds, with their shot noise; 0: no noise of light
  double read_noise = 0;  ///< of a pixel, rms, with `electrons` [electrons]
  int64_t noise_seed = 1;
  Sweep sweep = Sweep::none;            ///< a series of views beside those at `distances`
  int sweep_views = 24;                 ///< of the series
  double sweep_from = 0, sweep_to = 0;  ///< focus: distances; parallax: x of the eye [m]
  double sweep_seconds = 2;             ///< of the animated file, there and back
};

template <class Visitor>
void describe(Visitor& v, CameraParams& p) {
  v.lengths("distances", p.distances, range::not_negative, "from the panel to the planes looked at");
  v.length("pupil", p.pupil, range::not_negative,
           "diameter of the eye's pupil or the lens; 0 m: all light that leaves the panel");
  v.position("eye", p.eye, range::not_negative, "place of that pupil, on the panel or before it (z of 0 m or more)");
  v.length(
      "focal_length", p.focal_length, range::not_negative,
      "of a thin lens in the pupil: width, height and pixel are then those of its sensor; 0 m: no lens, or an eye");
  v.length("width", p.width, range::not_negative, "of the sensor; 0 m: the panel's");
  v.length("height", p.height, range::not_negative, "of the sensor; 0 m: the panel's");
  v.length("centre_x", p.centre_x, range::any, "of the sensor");
  v.length("centre_y", p.centre_y, range::any, "of the sensor");
  v.length("pixel", p.pixel, range::not_negative, "side of a sensor pixel; 0 m: as binning says");
  v.count("binning", p.binning, range::not_negative,
          "field samples per sensor pixel and axis; 0: one panel pixel, or with pixel as many as are needed");
  v.choice(
      "sampling", p.sampling, {{"integrate", PixelSampling::integrate}, {"point", PixelSampling::point}},
      "what a sensor pixel reads: the irradiance over its area (integrate), or at its field samples alone (point)");
  v.number("exposure", p.exposure, range::not_negative, "irradiance that is white in W/m2; 0: the 99.9th percentile");
  v.count("bits", p.bits, range::or_value(8, range::from_to(16, 16)), "bits of a PNG's channel, 8 or 16");
  v.number("electrons", p.electrons, range::from_to(0, 1e12),
           "full-well capacity in electrons; adds shot noise; 0: no noise");
  v.number("read_noise", p.read_noise, range::not_negative, "read noise of a pixel, rms, in electrons");
  v.count("noise_seed", p.noise_seed, range::not_negative, "seed of the noise");
  v.choice("sweep", p.sweep, {{"none", Sweep::none}, {"focus", Sweep::focus}, {"parallax", Sweep::parallax}},
           "a series of views and its animation: through distances, or with the eye moving along x");
  v.count("sweep_views", p.sweep_views, range::at_least(2), "of the series");
  v.length("sweep_from", p.sweep_from, range::any, "first distance (focus), or first x of the eye (parallax)");
  v.length("sweep_to", p.sweep_to, range::any, "last distance, or last x of the eye");
  v.number("sweep_seconds", p.sweep_seconds, range::positive, "duration of the animation in seconds, there and back");
}

}  // namespace holotrace
