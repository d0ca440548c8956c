#pragma once

#include <vector>

#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// Crosstalk: the field between the electrodes of neighbours runs over, so that the phase (unwrapped, as
/// they are driven) does not jump from pixel to pixel but is blurred by a Gaussian of σ pixels. Of pixels of even phase
/// that blur is known in closed form: along each axis, at q from the centre of pixel i,
///
///     φ(q) = Σ_d K(q − d)·φ(i + d),   K(x) = ½·[erf((x + ½)/√2σ) − erf((x − ½)/√2σ)]
///
/// It is taken at the centres of the s cells that the lit part w of a pixel is cut into, and the cells then shine
/// evenly: the error falls as 1/s². The panel is taken to repeat.
///
/// Reference: M. Persson, D. Engström, M. Goksör, Reducing the effect of pixel crosstalk in phase only spatial light
/// modulators, Opt. Express 20, 22334 (2012), whose kernel, measured, is bell-shaped.
class PixelBlur {
 public:
  /// @param slm    σ of its crosstalk, its pixels and their lit sides; without crosstalk there is nothing to call
  /// @param cells  s
  PixelBlur(const Slm& slm, int cells);

  /// From all pixels, shape (ny, nx), to the cells of pixel row j that lie in cell row `cy` of the pixel: [cx][column].
  void to_cells(const float* pixels, int j, int cy, float* cells) const;

  /// The adjoint of to_cells in two steps. Along x, of one row of cells, summed over cx: [column].
  void from_cells(const float* cells, float* row) const;

  /// Along y: what row j of the pixels takes from all the rows that from_cells made, [cy][j][column].
  void from_rows(const float* rows, int j, float* to) const;

 private:
  // K of one axis.
  struct Taps {
    int reach = 0;              // neighbours to each side: |d| ≤ reach, beyond which K < 1e-9
    std::vector<float> values;  // [cell][d + reach], of sum 1 in each cell

    Taps() = default;
    Taps(double sigma, double lit, int cells);
    const float* of_cell(int c) const { return values.data() + size_t(c) * size_t(2 * reach + 1); }
  };

  int nx_, ny_, s_;
  Taps along_x_, along_y_;
};

/// Cells per pixel and axis: 1 without crosstalk; else `params.fine_samples`, or 4 where that is 0 and 8 where σ is
/// below 0.2 pixels as well.
int crosstalk_cells(const Slm& slm, const ShowParams& params);

}  // namespace holotrace
