#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/slm.h"
#include "holotrace/estimate/alias_free.h"

namespace holotrace {

/// The note for a panel so fine that nothing limits it.
inline constexpr const char* everywhere =
    "the wavelength is 2 pitches or more: the panel holds waves of every direction, and every replica is evanescent";

/// Bytes that a pixel's level takes: levels are stored in whole bytes.
inline double bytes_per_pixel(const Slm& slm) { return slm.levels > 256 ? 2 : 1; }

/// A question about a panel: what it can show.
struct LimitsQuestion {
  Slm slm;
  std::vector<double> wavelengths;  ///< wavelengths [m], at least one
  double distance = 0.3;            ///< distance of the scene behind the panel and of the viewer in front of it [m]
  double period = 0;                ///< period of a grating [m]; 0: none
  int order = 1;
  double frames = 0;  ///< frame rate [1/s]; 0: none
  int colours = 1;
  std::vector<Vec3> points{};  ///< points of a scene [m]
};

/// All figures in SI units and degrees, by name. Those of the first wavelength are at the top level; with several
/// wavelengths, "wavelengths" has the figures of each.
nlohmann::ordered_json limits_json(const LimitsQuestion& question);

}  // namespace holotrace
