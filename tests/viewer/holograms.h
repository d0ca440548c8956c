#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "holotrace/data/hologram.h"
#include "holotrace/io/field/hologram_file.h"
#include "support/temporary.h"

namespace holotrace::test {

inline Slm small_panel() {
  Slm slm;
  slm.grid = {64, 48, 8e-6};
  slm.fill_factor = 0.9;
  slm.effects.gap_amplitude = 0.3;
  return slm;
}

/// A hologram of random levels: light everywhere, so that any difference shows.
inline Hologram random_hologram(double wavelength, uint32_t seed, double illumination = 1) {
  Hologram h;
  h.slm = small_panel();
  h.grid = h.slm->grid;
  h.wavelength = wavelength;
  h.encoder = "phase";
  h.illumination = illumination;
  h.label.frame = seed;
  h.level = Array2D<uint16_t>(h.grid.ny, h.grid.nx);
  uint32_t state = 12345 + seed;
  for (uint16_t& level : h.level.values) level = uint16_t((state = state * 1664525 + 1013904223) >> 24);
  return h;
}

/// Writes holograms hologram.png, hologram_2.png, … into a folder of the test.
inline std::string folder_of(const std::vector<Hologram>& holograms) {
  const std::string folder = temporary("out");
  std::filesystem::create_directories(folder);
  for (size_t i = 0; i < holograms.size(); ++i)
    save_hologram(folder + (i == 0 ? "/hologram.png" : "/hologram_" + std::to_string(i + 1) + ".png"), holograms[i]);
  return folder;
}

}  // namespace holotrace::test
