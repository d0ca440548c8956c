#pragma once

#include <string>
#include <vector>

#include "holotrace/data/grid.h"

namespace holotrace {

/// What a panel's pixels do to light.
enum class Modulation { phase, amplitude };

/// A spatial light modulator.
struct Slm {
  std::string name = "custom";
  Grid grid;
  Modulation modulation = Modulation::phase;
  int levels = 256;        ///< M: phase level ℓ shows 2πℓ/M at the design wavelength, amplitude level ℓ/(M−1)
  double fill_factor = 1;  ///< F: lit part of a pixel's area, in (0, 1]
  double design_wavelength = 0;  ///< [m] where level M would show 2π; 0: the wavelength in use
};

/// The names that slm_preset knows.
std::vector<std::string> slm_preset_names();

/// A panel by name: `pluto` (HOLOEYE PLUTO, 1920×1080, 8.0 µm, 8 bit, fill factor 0.93),
/// `gaea` (HOLOEYE GAEA, 4160×2464, 3.74 µm, 8 bit, 0.90), `ideal` (1920×1080, 8.0 µm, 65536 levels, 1).
/// @throws Error for an unknown name, suggesting the nearest.
Slm slm_preset(const std::string& name);

/// @throws Error unless the grid is valid, levels are 2 … 65536 and the fill factor is in (0, 1].
void check_slm(const Slm& slm);

}  // namespace holotrace
