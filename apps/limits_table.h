#pragma once

#include <string>
#include <vector>

#include "facts.h"
#include "holotrace/data/slm.h"
#include "holotrace/estimate/alias_free.h"

namespace holotrace {

/// What `holotrace limits` is asked about a panel.
struct LimitsQuestion {
  Slm slm;
  std::vector<double> wavelengths;  ///< [m], at least one
  double distance = 0.3;            ///< of the scene behind, and of the viewer before the panel [m]
  double period = 0;                ///< of a grating [m]; 0: not asked
  int order = 1;
  double frames = 0;  ///< per second; 0: not asked
  int colours = 1;
  std::vector<Vec3> points{};  ///< of a scene
};

/// All figures under names of their own, in SI units and degrees: those of the first wavelength by themselves, and with
/// several those of each in "wavelengths".
Json limits_json(const LimitsQuestion& question);

/// The same for people: sections, a column per wavelength, units, and what each figure means.
std::string limits_table(const LimitsQuestion& question);

/// What an eye asks of the panel, and whether it is met, one sentence a line.
std::string vision_text(const LimitsQuestion& question);

}  // namespace holotrace
