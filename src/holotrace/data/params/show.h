#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "holotrace/data/params/choice.h"

// show: Hologram → Field

namespace holotrace {

/// The shape of the light on the panel.
enum class Wavefront { plane, spherical, gaussian };

/// The light on the panel, what of the panel is modelled, and how finely the field that leaves it is sampled.
struct ShowParams {
  int subpixels = 1;      ///< samples per pixel and axis: n holds the orders |m| ≤ (n−1)/2
  int fine_samples = 0;   ///< per pixel and axis on which crosstalk is modelled; 0: as it needs
  double wavelength = 0;  ///< of the illumination [m]; 0: the hologram's
  double irradiance = 1;  ///< of the illumination, on the axis [W/m²]
  Wavefront light = Wavefront::plane;
  double tilt_x = 0, tilt_y = 0;  ///< of the light from the panel's axis [rad]
  double source_distance = 0;     ///< spherical: from the point it comes from [m]; < 0: it goes to a point before
  double beam_radius = 0;         ///< Gaussian: at 1/e² of the irradiance, on the panel [m]
  double bandwidth = 0;           ///< full width at half maximum of the light's spectrum, a Gaussian [m]
  double source_angle = 0;        ///< full angle that the source is seen under from the panel, a disc [rad]
  int illumination_states = 0;    ///< over which partly coherent light and flicker are averaged; 0: as the views need
  std::vector<std::string> effects{};  ///< of the panel that are on; "all"
};

template <class Visitor>
void describe(Visitor& v, ShowParams& p) {
  v.count("subpixels", p.subpixels, range::from_to(1, 65536),
          "samples per pixel and axis; 3 shows the orders -1, 0, 1");
  v.count("fine_samples", p.fine_samples, range::from_to(0, 64), "per pixel and axis, for crosstalk; 0: as it needs");
  v.length("wavelength", p.wavelength, range::not_negative,
           "wavelength of the light on the SLM; 0 m: the hologram's own");
  v.number("irradiance", p.irradiance, range::not_negative,
           "irradiance of the light on the panel, on the axis, in W/m2");
  v.choice("light", p.light,
           {{"plane", Wavefront::plane}, {"spherical", Wavefront::spherical}, {"gaussian", Wavefront::gaussian}},
           "its wavefront and profile");
  v.angle("tilt_x", p.tilt_x, range::tilt, "tilt of the light from the panel's axis, toward x");
  v.angle("tilt_y", p.tilt_y, range::tilt, "tilt of the light from the panel's axis, toward y");
  v.length("source_distance", p.source_distance, range::any,
           "spherical: from the point that the light comes from to the panel; below 0: to which it converges");
  v.length("beam_radius", p.beam_radius, range::not_negative,
           "gaussian: of the beam on the panel, at 1/e2 of its irradiance");
  v.length("bandwidth", p.bandwidth, range::not_negative,
           "width of the light's spectrum, full width at half maximum; 0 m: one line");
  v.angle("source_angle", p.source_angle, range::below(0, std::numbers::pi),
          "full angle that the light's source is seen under; 0 deg: a point");
  v.count("illumination_states", p.illumination_states, range::from_to(0, 65536),
          "instants that partly coherent light and flicker are averaged over; 0: as many as the views need");
  v.texts(
      "effects", p.effects,
      "of the panel that are on: calibration, crosstalk, gaps, flicker, aberration, phase-map, dead-pixels, or all");
}

}  // namespace holotrace
