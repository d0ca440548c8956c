#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/parameter.h"

// expose: Field → Image

namespace holotrace {

/// Series of views: none, through planes of focus, or with the eye moving along x.
enum class Sweep { none, focus, parallax };

/// File of the animation of a series of views.
enum class SweepFormat { gif, webp, mp4, webm };

/// What a sensor pixel reads: the mean irradiance over its area, or the irradiance at samples of the field.
enum class PixelSampling { integrate, point };

/// What the middle of the sensor shows: the axis of the panel in the plane in focus, or the place there that the eye sees through
/// the panel's middle. Automatic: the second, for an eye that moves or that the holograms are made for (run/choose.h).
enum class ViewWindow { automatic, axis, eye };

/// Colours of pictures of several wavelengths. `lines`: the colours of the scene are got back (colour_matrix of data/spectrum.h).
/// `cie`: as the CIE 1931 standard observer sees the light (cie_colour_matrix of data/cie.h).
enum class ViewColours { lines, cie };

/// A sensor without a lens (as on the paper's bench), a camera with a thin lens, or an eye; and how the sensor's values
/// become a picture.
struct CameraParams {
  std::vector<double> distances{0.3};  ///< distances from the panel to the planes in focus [m]; < 0: on the other side
  double pupil = 0;         ///< diameter of the eye's pupil or the lens [m]; 0: all light that leaves the panel
  Vec3 eye{0, 0, 0};        ///< position of that pupil [m], on the panel or in front of it: z ≥ 0
  double focal_length = 0;  ///< focal length of a thin lens in the pupil [m]; sizes below are then those of its sensor
  double width = 0, height = 0;               ///< size of the sensor [m]; 0: the panel's
  double centre_x = 0, centre_y = 0;          ///< centre of the sensor [m]
  ViewWindow window = ViewWindow::automatic;  ///< place that the centre is counted from
  double pixel = 0;                           ///< side of a sensor pixel [m]; 0: `binning` field samples
  int binning = 0;  ///< field samples per sensor pixel and axis; 0: one panel pixel, or as `pixel` needs
  PixelSampling sampling = PixelSampling::integrate;
  double exposure = 0;    ///< irradiance shown as white [W/m²]; 0: automatic (exposure_white)
  int bits = 8;           ///< bits per channel of a PNG: 8 or 16
  double electrons = 0;   ///< full-well capacity, with shot noise [electrons]; 0: no shot noise
  double read_noise = 0;  ///< read noise per pixel, rms [electrons]; needs `electrons`
  int64_t noise_seed = 1;
  ViewColours colours = ViewColours::lines;
  Sweep sweep = Sweep::none;            ///< a series of views beside those at `distances`
  int sweep_views = 24;                 ///< number of views of the series
  double sweep_from = 0, sweep_to = 0;  ///< first and last distance (focus) or x of the eye (parallax) [m]
  double sweep_seconds = 2;             ///< duration of the animation, forward and back [s]
  SweepFormat sweep_format = SweepFormat::gif;
};

template <class Visitor>
void describe(Visitor&& v, CameraParams& p) {
  v(lengths(
      "distances", p.distances, range::any,
      "distances from the panel to the planes in focus; negative: on the other side, in front of it for a virtual image"));
  v(length("pupil", p.pupil, range::not_negative,
           "diameter of the pupil of the eye or lens; 0 m: all light that leaves the panel is used"));
  v(position("eye", p.eye, range::not_negative,
             "position of that pupil, on the panel or in front of it (z of 0 m or more)"));
  v(length(
      "focal_length", p.focal_length, range::not_negative,
      "focal length of a thin lens in the pupil; width, height and pixel are then those of its sensor; 0 m: no lens"));
  v(length("width", p.width, range::not_negative, "width of the sensor; 0 m: the panel's"));
  v(length("height", p.height, range::not_negative, "height of the sensor; 0 m: the panel's"));
  v(length("centre_x", p.centre_x, range::any, "x of the sensor's centre"));
  v(length("centre_y", p.centre_y, range::any, "y of the sensor's centre"));
  v(choice(
      "window", p.window, {{"auto", ViewWindow::automatic}, {"axis", ViewWindow::axis}, {"eye", ViewWindow::eye}},
      "middle of the sensor: on the panel's axis (axis), or where the eye sees the middle of the panel (eye), so that "
      "the view moves with the eye; auto: eye for holograms for an eye and with an eye track, else axis"));
  v(length("pixel", p.pixel, range::not_negative, "side of a sensor pixel; 0 m: set by binning"));
  v(count("binning", p.binning, range::not_negative,
          "field samples per sensor pixel and axis; 0: those of one panel pixel, or as many as pixel needs"));
  v(choice(
      "sampling", p.sampling, {{"integrate", PixelSampling::integrate}, {"point", PixelSampling::point}},
      "irradiance that a sensor pixel reads: the mean over its area (integrate), or that at its field samples alone (point)"));
  v(number("exposure", p.exposure, range::not_negative,
           "irradiance shown as white in W/m2; 0: automatic, with white surfaces at 0.8 of white"));
  v(count("bits", p.bits, range::or_value(8, range::from_to(16, 16)), "bits per channel of a PNG"));
  v(number("electrons", p.electrons, range::from_to(0, 1e12),
           "full-well capacity in electrons; adds shot noise; 0: no shot noise"));
  v(number("read_noise", p.read_noise, range::not_negative,
           "read noise per pixel, rms, in electrons; needs electrons"));
  v(count("noise_seed", p.noise_seed, range::not_negative, "seed for the sensor's noise"));
  v(choice(
      "colours", p.colours, {{"lines", ViewColours::lines}, {"cie", ViewColours::cie}},
      "colours of views of several wavelengths: those of the scene (lines), or as the CIE 1931 standard observer sees "
      "the light, with colours outside of sRGB mixed with white (cie)"));
  v(choice("sweep", p.sweep, {{"none", Sweep::none}, {"focus", Sweep::focus}, {"parallax", Sweep::parallax}},
           "series of views with its animation: through planes of focus, or with the eye moving along x (parallax)"));
  v(count("sweep_views", p.sweep_views, range::from_to(2, 10000), "number of views of the series"));
  v(length("sweep_from", p.sweep_from, range::any, "first distance (focus) or first x of the eye (parallax)"));
  v(length("sweep_to", p.sweep_to, range::any, "last distance (focus) or last x of the eye (parallax)"));
  v(number("sweep_seconds", p.sweep_seconds, range::above_to(0, 3600),
           "duration of the animation in seconds, forward and back"));
  v(choice(
      "sweep_format", p.sweep_format,
      {{"gif", SweepFormat::gif}, {"webp", SweepFormat::webp}, {"mp4", SweepFormat::mp4}, {"webm", SweepFormat::webm}},
      "file of the animation beside the views; mp4 and webm need the program ffmpeg"));
}

}  // namespace holotrace
