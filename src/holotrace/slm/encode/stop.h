#pragma once

#include <optional>

#include "holotrace/data/grid.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"

namespace holotrace {

/// The stop (Hologram::filter) that a hologram with these parameters will name, known before encoding; none if it needs
/// none.
/// @throws Error  for a reference that is too steep for the pitch (off_axis.h)
std::optional<SpectralFilter> stop_of(const EncodeParams& params, const Grid& grid, double wavelength);

}  // namespace holotrace
