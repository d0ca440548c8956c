#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/panel_image.h"
#include "holotrace/data/params/panel_image.h"

namespace holotrace {

/// The pictures that panels get for holograms: added phases, the vendor's table, mirrored and turned, several in one.
///
///     φ(x, y) = φ(ℓ) + 2π·(x/Λx + y/Λy) − 2π·(√(r² + f²) − |f|)·sign(f)/λ,  r² = x² + y²
///
/// The level whose phase is nearest is sent; its steps are those that the hologram's levels know (its `effects`). The blaze
/// turns light by asin(λ/Λ) toward +x and +y, which moves a real image there and a virtual one the other way; the lens makes a
/// plane wave one that converges to the distance f. Both belong to the hologram, and are turned with it. The correction belongs
/// to the panel. The order is: blaze and lens, flip, transpose, turn, correction, table, pack. Without parameters and tables the pictures show the levels as
/// hologram files do.
///
/// @param holograms  of one panel; for Packing::colours of three wavelengths, as many of each, of which the longest becomes
///                   red; for bits of two levels each, of which 24 make a picture, and the last picture has 0 for what is missing
/// @param value      greys of 8 or 16 bits (Hologram), or levels
/// @throws Error     for holograms of phase and amplitude, phases to add to amplitudes, a table that has not a value for each
///                   grey or level, a correction of another size, fringes finer than two pixels, a lens for a hologram without
///                   wavelength or of several, and holograms that do not pack
std::vector<PanelImage> panel_images(const std::vector<Hologram>& holograms, const PanelImageParams& params,
                                     const PanelTables& tables, PanelValue value, const Observer& observer = {});

}  // namespace holotrace
