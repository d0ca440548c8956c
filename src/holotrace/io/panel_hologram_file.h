#pragma once

#include <string>

#include "holotrace/data/hologram.h"
#include "holotrace/io/field/hologram_file.h"

namespace holotrace {

/// Reads a hologram, of this or of another program, with the panel that shows it. A pitch that neither the file nor
/// `complete` knows is the panel's; without `slm`, the panel takes the hologram's pixels and pitch.
/// @param slm       panel as load_slm takes it; "": the one that the hologram was made for, or pluto
/// @param complete  as load_hologram takes it; its range [rad] becomes the panel's phase range
/// @throws Error    as load_hologram and load_slm do, and for a hologram whose wavelength nobody knows
PanelHologram load_panel_hologram(const std::string& path, const std::string& slm,
                                  const CompleteHologram& complete = {});

}  // namespace holotrace
