#pragma once

#include <string_view>

#include "holotrace/data/grid.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// @throws Error  unless `grid` has the pixels of the SLM and its pitch to 1e-9; the message names both
void require_grid_of(const Slm& slm, const Grid& grid, std::string_view what);

/// @throws Error  unless `levels` is in 2 … 65536
void check_levels(int levels);

}  // namespace holotrace
