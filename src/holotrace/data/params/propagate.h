#pragma once

#include "holotrace/data/params/choice.h"

// propagate: Field → Field

namespace holotrace {

/// By which transfer function a field travels through free space; automatic: the one that the sampling allows.
enum class PropagationMethod { automatic, angular_spectrum, rayleigh_sommerfeld, fresnel };

/// How a field travels through free space, and the window it arrives in.
struct PropagateParams {
  PropagationMethod method = PropagationMethod::automatic;  ///< of the transfer function
  int columns = 0, rows = 0;                                ///< of the output window [samples]; 0: as the input
  double pitch = 0;                                         ///< of the output's samples [m]; 0: the input's
  double centre_x = 0, centre_y = 0;                        ///< of the output window [m]
  bool is_periodic = false;  ///< the window repeats for ever: no padding, by the angular spectrum
  bool operator==(const PropagateParams&) const = default;
};

template <class Visitor>
void describe(Visitor& v, PropagateParams& p) {
  v.choice("method", p.method,
           {{"auto", PropagationMethod::automatic},
            {"angular-spectrum", PropagationMethod::angular_spectrum},
            {"rayleigh-sommerfeld", PropagationMethod::rayleigh_sommerfeld},
            {"fresnel", PropagationMethod::fresnel}},
           "auto takes the one that the sampling condition allows");
  v.count("columns", p.columns, range::not_negative, "of the output window; 0: as the input");
  v.count("rows", p.rows, range::not_negative, "of the output window; 0: as the input");
  v.length("pitch", p.pitch, range::not_negative, "of the output's samples; 0 m: the input's");
  v.length("centre_x", p.centre_x, range::any, "of the output window");
  v.length("centre_y", p.centre_y, range::any, "of the output window");
  v.flag("periodic", p.is_periodic, "the window repeats for ever, as for gratings and plane waves: no padding");
}

}  // namespace holotrace
