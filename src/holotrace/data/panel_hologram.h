#pragma once

#include "holotrace/data/hologram.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// A hologram, and the panel that shows it.
struct PanelHologram {
  Hologram hologram;  ///< with its pitch and wavelength
  Slm slm;
};

}  // namespace holotrace
