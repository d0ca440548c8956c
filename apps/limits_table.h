#pragma once

#include <string>
#include <vector>

#include "facts.h"
#include "holotrace/data/slm.h"
#include "holotrace/estimate/alias_free.h"

namespace holotrace {

/// Inputs of `holotrace limits` for a panel.
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
Json limits_json(const LimitsQuestion& question);

/// The figures as a table: sections, a column per wavelength, units, and the meaning of each figure.
std::string limits_table(const LimitsQuestion& question);

/// The requirements of an eye, and whether the panel meets them, one sentence per line.
std::string vision_text(const LimitsQuestion& question);

}  // namespace holotrace
