#pragma once

#include "holotrace/data/params/parameter.h"

// propagate: Field → Field

namespace holotrace {

/// Transfer function of free space; automatic: the one that the sampling condition allows.
enum class PropagationMethod { automatic, angular_spectrum, rayleigh_sommerfeld, fresnel };

/// How a field travels through free space, and the window it arrives in.
struct PropagateParams {
  PropagationMethod method = PropagationMethod::automatic;  ///< transfer function of free space
  int columns = 0, rows = 0;                                ///< size of the output window [samples]; 0: the input's
  double pitch = 0;                                         ///< pitch of the output's samples [m]; 0: the input's
  double centre_x = 0, centre_y = 0;                        ///< centre of the output window [m]
  bool is_periodic = false;                                 ///< the field is periodic: no padding, angular spectrum
  DeviceChoice device{};                                    ///< device that propagates
  bool operator==(const PropagateParams&) const = default;
};

template <class Visitor>
void describe(Visitor&& v, PropagateParams& p) {
  v(choice("method", p.method,
           {{"auto", PropagationMethod::automatic},
            {"angular-spectrum", PropagationMethod::angular_spectrum},
            {"rayleigh-sommerfeld", PropagationMethod::rayleigh_sommerfeld},
            {"fresnel", PropagationMethod::fresnel}},
           "propagation method; auto: chosen by the sampling condition"));
  v(count("columns", p.columns, range::not_negative, "width of the output window in samples; 0: the input's"));
  v(count("rows", p.rows, range::not_negative, "height of the output window in samples; 0: the input's"));
  v(length("pitch", p.pitch, range::not_negative, "pitch of the output's samples; 0 m: the input's"));
  v(length("centre_x", p.centre_x, range::any, "x of the output window's centre"));
  v(length("centre_y", p.centre_y, range::any, "y of the output window's centre"));
  v(flag("periodic", p.is_periodic, "field is periodic, as for gratings and plane waves: no padding"));
  v(device("device", p.device, "propagates the field"));
}

}  // namespace holotrace
