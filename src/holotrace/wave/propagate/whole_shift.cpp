#include "holotrace/wave/propagate/whole_shift.h"

#include "holotrace/wave/propagate/propagation_axis.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

std::optional<WindowShift> whole_shift(const Grid& grid, double wavelength, double distance,
                                       const PropagateParams& params) {
  if (distance != 0) return std::nullopt;
  const Grid window = propagation_output(grid, params);
  const PropagationAxis x = make_axis_x(grid, window, wavelength, 0), y = make_axis_y(grid, window, wavelength, 0);
  if (!x.is_on_lattice() || !y.is_on_lattice() || x.rest != 0 || y.rest != 0) return std::nullopt;
  return WindowShift{window, x.shift, y.shift};
}

}  // namespace holotrace
