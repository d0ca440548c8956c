#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numbers>
#include <string>
#include <vector>

#include "holotrace/data/params/parameter.h"
#include "holotrace/data/slm.h"

// show: Hologram → Field

namespace holotrace {

/// Shape of the light on the panel.
enum class Wavefront { plane, spherical, gaussian };

/// The light on the panel, the panel effects that are modelled, and the sampling of the field that leaves the panel.
struct ShowParams {
  int subpixels = 1;      ///< samples per pixel and axis; n samples hold the orders |m| ≤ (n−1)/2
  int fine_samples = 0;   ///< points per pixel and axis for crosstalk; 0: as many as it needs
  double wavelength = 0;  ///< wavelength of the illumination [m]; 0: the hologram's
  double irradiance = 1;  ///< irradiance of the illumination on the axis [W/m²]
  Wavefront light = Wavefront::plane;
  double tilt_x = 0, tilt_y = 0;  ///< tilt of the illumination from the panel's axis [rad]
  double source_distance = 0;     ///< spherical: distance of the source behind the panel [m]; < 0: converging light
  double beam_radius = 0;         ///< gaussian: radius of the beam on the panel at 1/e² of its irradiance [m]
  double bandwidth = 0;           ///< full width at half maximum of the Gaussian spectrum [m]
  double source_angle = 0;        ///< full angle of the source, a disc, as seen from the panel [rad]
  int illumination_states =
      0;  ///< states of partly coherent light and flicker to average; 0: as many as the views need
  std::vector<std::string> effects{};  ///< effects of the panel that are modelled; or "all"; none named: its own
  DeviceChoice device{};               ///< device that computes the light that leaves the panel
};

template <class Visitor>
void describe(Visitor&& v, ShowParams& p) {
  v(count("subpixels", p.subpixels, range::from_to(1, 65536),
          "samples of the field per pixel and axis; 1 shows order 0 only, 3 the orders -1, 0, 1"));
  v(count("fine_samples", p.fine_samples, range::from_to(0, 64),
          "points per pixel and axis for crosstalk; 0: as many as it needs"));
  v(wavelength("wavelength", p.wavelength, range::not_negative,
               "wavelength of the illumination; 0 m: the hologram's own"));
  v(number("irradiance", p.irradiance, range::not_negative, "irradiance of the illumination on the axis in W/m2"));
  v(choice("light", p.light,
           {{"plane", Wavefront::plane}, {"spherical", Wavefront::spherical}, {"gaussian", Wavefront::gaussian}},
           "wavefront and profile of the illumination"));
  v(angle("tilt_x", p.tilt_x, range::tilt, "tilt of the illumination from the panel's axis toward x"));
  v(angle("tilt_y", p.tilt_y, range::tilt, "tilt of the illumination from the panel's axis toward y"));
  v(length(
      "source_distance", p.source_distance, range::any,
      "spherical: distance of the point source behind the panel; negative: the light converges in front of the panel"));
  v(length("beam_radius", p.beam_radius, range::not_negative,
           "gaussian: radius of the beam on the panel at 1/e2 of its irradiance"));
  v(length("bandwidth", p.bandwidth, range::not_negative,
           "full width at half maximum of the illumination's spectrum; 0 m: one wavelength"));
  v(angle("source_angle", p.source_angle, range::below(0, std::numbers::pi),
          "full angle of the source as seen from the panel; 0 deg: a point source"));
  v(count("illumination_states", p.illumination_states, range::from_to(0, 65536),
          "number of states of partly coherent light and flicker to average; 0: as many as the views need"));
  v(texts("effects", p.effects,
          fmt::format("panel effects that are modelled: {}; all; or none; empty: those that the panel's own file has",
                      fmt::join(slm_effect_names(), ", "))));
  v(device("device", p.device, "computes the light that leaves the panel (holotrace show: and propagates it)"));
}

}  // namespace holotrace
