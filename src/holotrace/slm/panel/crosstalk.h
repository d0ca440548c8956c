#pragma once

#include <vector>

#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// Crosstalk: the electric fields of neighbouring electrodes overlap. The phase (unwrapped, as it is driven) therefore
/// does not jump from pixel to pixel but is blurred by a Gaussian of σ pixels. For pixels of even phase
/// this blur has a closed form. Along each axis, at q from the centre of pixel i,
///
///     φ(q) = Σ_d K(q − d)·φ(i + d),   K(x) = ½·[erf((x + ½)/√2σ) − erf((x − ½)/√2σ)]
///
/// It is evaluated at the centres of the s cells into which the lit part w of a pixel is divided. Each cell has one
/// phase, and the error falls as 1/s². The panel is taken as periodic.
///
/// Reference: M. Persson, D. Engström, M. Goksör, Reducing the effect of pixel crosstalk in phase only spatial light
/// modulators, Opt. Express 20, 22334 (2012); their measured kernel is bell-shaped.
class PixelBlur {
 public:
  /// K along one axis.
  struct Taps {
    int reach = 0;              ///< neighbours on each side, |d| ≤ reach; K < 1e-9 beyond
    std::vector<float> values;  ///< [cell][d + reach]; the sum is 1 in each cell

    Taps() = default;
    Taps(double sigma, double lit, int cells);
    size_t taps() const { return size_t(2 * reach + 1); }
    const float* of_cell(int c) const { return values.data() + size_t(c) * taps(); }
  };

  /// @param slm    σ of its crosstalk, its pixels and their lit sides; for a panel with crosstalk only
  /// @param cells  s, cells per pixel and axis
  PixelBlur(const Slm& slm, int cells);

  /// From all pixels, shape (ny, nx), to the cells of pixel row j in cell row `cy` of the pixel: [cx][column].
  void to_cells(const float* pixels, int j, int cy, float* cells) const;

  /// The adjoint of to_cells in two steps. First step, along x, for one row of cells, summed over cx: [column].
  void from_cells(const float* cells, float* row) const;

  /// Second step, along y: the contribution to pixel row j from all rows that from_cells made, [cy][j][column].
  void from_rows(const float* rows, int j, float* to) const;

  /// Empty without crosstalk.
  const Taps& along_x() const { return along_x_; }
  const Taps& along_y() const { return along_y_; }

 private:
  int nx_, ny_, s_;
  Taps along_x_, along_y_;
};

/// Cells per pixel and axis: 1 without crosstalk, otherwise `params.fine_samples`. If that is 0: 4, or 8 for σ below
/// 0.2 pixels.
int crosstalk_cells(const Slm& slm, const ShowParams& params);

}  // namespace holotrace
