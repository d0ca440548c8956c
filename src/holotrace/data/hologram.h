#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// What is loaded on an SLM: one level 0 … levels−1 per pixel, shape (ny, nx), and what a bench
/// must know to show it.
struct Hologram {
  Grid grid;
  Array2D<uint16_t> level;  ///< of phase, or of amplitude
  int levels = 256;
  Modulation modulation = Modulation::phase;
  double wavelength = 0;  ///< it was computed for [m]
  ImageSide image = ImageSide::virtual_image;
  std::optional<SpectralFilter> filter;  ///< the order to let through, if the encoding needs it
  std::string encoder;
  std::optional<Slm> slm;  ///< the panel it was made for, where that is known
  /// Irradiance of the light on the panel that shows the field at its own brightness [W/m²]: what one hologram of
  /// several (colours, path groups, lights, frames) is lit with in proportion. See encode.h.
  double illumination = 1;
  std::string name{};                  ///< of the path group or light that it shows, "" for all light
  uint32_t frame = 0;                  ///< of a time-multiplexed hologram
  double cone_wavelength = 0;          ///< of the waves that it shows (Sources) [m]; 0: its own
  Array2D<uint16_t> modulus_level{};   ///< of amplitude, beside those of phase, where the modulation is complex
  std::vector<std::string> effects{};  ///< of the panel that the levels allow for (slm_effect_names)
};

}  // namespace holotrace
