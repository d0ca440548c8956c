#pragma once

#include <cstdint>
#include <string>

#include "holotrace/data/params/parameter.h"

// animate: the eye of a viewer who walks

namespace holotrace {

/// How the eye of a viewer moves, and how a display measures it.
struct EyeParams {
  std::string track{};        ///< file of the eye's places over time (io/scene/eye_track_file.h); "": none
  double latency = 0;         ///< from the measurement of the eye to the hologram that is made for it [s]
  double noise = 0;           ///< standard deviation of a measured place along each axis [m]
  int64_t seed = 1;           ///< of the noise
  bool is_predicted = false;  ///< the measured way of the last latency is added to the measured place
};

template <class Visitor>
void describe(Visitor&& v, EyeParams& p) {
  v(path(
      "track", p.track,
      "table (CSV) of the eye's place over time, with the columns time_s, x_mm, y_mm, z_mm; places between its lines "
      "are interpolated"));
  v(time("latency", p.latency, range::not_negative,
         "time from the measurement of the eye's place to the hologram that is made for it"));
  v(length("noise", p.noise, range::not_negative, "standard deviation of a measured place along each axis"));
  v(count("seed", p.seed, range::not_negative, "seed for the noise of the measured places"));
  v(flag("predict", p.is_predicted,
         "linear prediction of the eye's place: the displacement measured over one latency is added"));
}

}  // namespace holotrace
