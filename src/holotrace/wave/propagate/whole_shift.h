#pragma once

#include <optional>

#include "holotrace/data/grid.h"
#include "holotrace/data/params/propagate.h"

namespace holotrace {

/// A window on the lattice of a field's samples: its sample (0, 0) is the field's sample (down, right).
struct WindowShift {
  Grid window;
  int right = 0, down = 0;
};

/// The window of a propagation over no distance, whose samples are those of the field; nothing for other propagations.
/// @throws Error  as propagation_output does
std::optional<WindowShift> whole_shift(const Grid& grid, double wavelength, double distance,
                                       const PropagateParams& params);

}  // namespace holotrace
