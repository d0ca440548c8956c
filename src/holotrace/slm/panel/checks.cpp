#include "holotrace/slm/panel/checks.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {

void require_grid_of(const Slm& slm, const Grid& grid, std::string_view what) {
  const Grid& panel = slm.grid;
  const bool same = grid.nx == panel.nx && grid.ny == panel.ny && std::abs(grid.pitch / panel.pitch - 1) <= 1e-9;
  require(same,
          "expected a {} of {} × {} samples at {}, the pixels of the SLM \"{}\", got {} × {} at {}; compute it on the "
          "SLM's grid or name the SLM it was computed for",
          what, panel.nx, panel.ny, format_length(panel.pitch), slm.name, grid.nx, grid.ny, format_length(grid.pitch));
}

void check_levels(int levels) { require(levels >= 2 && levels <= 65536, "expected 2 to 65536 levels, got {}", levels); }

}  // namespace holotrace
