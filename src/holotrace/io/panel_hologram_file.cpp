#include "holotrace/io/panel_hologram_file.h"

#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/io/scene/slm_file.h"

namespace holotrace {

PanelHologram load_panel_hologram(const std::string& path, const std::string& slm, const CompleteHologram& complete) {
  HologramParams given;
  const bool has_levels = is_panel_table(path) && !is_hologram_file(path) && !slm.empty();  // those of its panel
  Hologram hologram = load_hologram(path, [&](HologramParams& of_file) {
    if (has_levels) of_file.levels = load_slm(slm).levels;
    if (complete) complete(of_file);
    given = of_file;
  });
  require(
      hologram.wavelength > 0,
      "expected a hologram whose wavelength is known, but {} has no metadata; give --wavelength, or make a hologram "
      "of a picture with holotrace encode",
      path);
  Slm panel = !slm.empty() ? load_slm(slm) : hologram.slm ? *hologram.slm : slm_preset("pluto");
  if (hologram.grid.pitch == 0) hologram.grid.pitch = panel.grid.pitch;
  if (slm.empty()) panel.grid = hologram.grid;
  if (given.range > 0) panel.phase_range = given.range;
  return {std::move(hologram), std::move(panel)};
}

}  // namespace holotrace
