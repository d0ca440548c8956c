#pragma once

#include <vector>

#include "holotrace/data/params.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// Crosstalk along one axis: the field between the electrodes of neighbours runs over, so that the phase (unwrapped, as
/// they are driven) does not jump from pixel to pixel but is blurred by a Gaussian of σ pixels. Of pixels of even phase
/// that blur is known in closed form: at q from the centre of pixel i
///
///     φ(q) = Σ_d K(q − d)·φ(i + d),   K(x) = ½·[erf((x + ½)/√2σ) − erf((x − ½)/√2σ)]
///
/// It is taken at the centres of the s cells that the lit part w of a pixel is cut into, and the cells then shine
/// evenly: the error falls as 1/s². The panel is taken to repeat.
///
/// Reference: M. Persson, D. Engström, M. Goksör, Reducing the effect of pixel crosstalk in phase only spatial light
/// modulators, Opt. Express 20, 22334 (2012), whose kernel, measured, is bell-shaped.
struct CrosstalkTaps {
  int cells = 1;              ///< s
  int reach = 0;              ///< neighbours to each side: |d| ≤ reach, beyond which K < 1e-9
  std::vector<float> values;  ///< [cell][d + reach], of sum 1 in each cell

  const float* of_cell(int c) const { return values.data() + size_t(c) * size_t(2 * reach + 1); }
};

/// @param sigma  [pixels], > 0
/// @param lit    w, in (0, 1]
CrosstalkTaps crosstalk_taps(double sigma, double lit, int cells);

/// Cells per pixel and axis: 1 without crosstalk; else `params.fine_samples`, or 4 where that is 0 and 8 where σ is
/// below 0.2 pixels as well.
int crosstalk_cells(const Slm& slm, const ShowParams& params);

}  // namespace holotrace
