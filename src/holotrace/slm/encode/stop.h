#pragma once

#include <optional>

#include "holotrace/data/grid.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"

namespace holotrace {

/// The stop that a hologram encoded so names (Hologram::filter), before it is encoded; none where it needs none.
/// @throws Error  for a reference that is too steep for the pitch (off_axis.h)
std::optional<SpectralFilter> stop_of(const EncodeParams& params, const Grid& grid, double wavelength);

}  // namespace holotrace
