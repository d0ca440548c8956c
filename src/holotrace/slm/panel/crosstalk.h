#pragma once

#include <vector>

#include "holotrace/data/slm.h"

namespace holotrace {

/// Crosstalk: the electric fields of neighbouring electrodes overlap. The phase (unwrapped, as it is driven) therefore
/// does not jump from pixel to pixel but is blurred by a Gaussian of σ pixels. For pixels of even phase
/// this blur has a closed form. Along each axis, at q from the centre of pixel i,
///
///     φ(q) = Σ_d K(q − d)·φ(i + d),   K(x) = ½·[erf((x + ½)/√2σ) − erf((x − ½)/√2σ)]
///
/// It is evaluated at the points of a PixelExpansion in the lit part w of a pixel. The panel is taken as periodic.
///
/// Reference: M. Persson, D. Engström, M. Goksör, Reducing the effect of pixel crosstalk in phase only spatial light
/// modulators, Opt. Express 20, 22334 (2012); their measured kernel is bell-shaped.
class PixelBlur {
 public:
  /// K along one axis.
  struct Taps {
    int reach = 0;              ///< neighbours on each side, |d| ≤ reach; K < 3e-7 beyond
    std::vector<float> values;  ///< [point][d + reach]; the sum is 1 for each point

    Taps() = default;

    /// @param places  of the points, in halves of the lit side
    Taps(double sigma, double lit, const std::vector<double>& places);
    size_t taps() const { return size_t(2 * reach + 1); }
    const float* of_point(int c) const { return values.data() + size_t(c) * taps(); }
  };

  /// @param slm     σ of its crosstalk, its pixels and their lit sides
  /// @param places  of the points along each axis
  PixelBlur(const Slm& slm, const std::vector<double>& places);

  /// From all pixels, shape (ny, nx), to the points of pixel row j in row `cy` of the pixel's points: [cx][column].
  void to_points(const float* pixels, int j, int cy, float* values) const;

  /// The adjoint of to_points in two steps. First step, along x, for one row of points, summed over cx: [column].
  void from_points(const float* values, float* row) const;

  /// Second step, along y: the contribution to pixel row j from all rows that from_points made, [cy][j][column].
  void from_rows(const float* rows, int j, float* to) const;

  /// Empty without crosstalk.
  const Taps& along_x() const { return along_x_; }
  const Taps& along_y() const { return along_y_; }

 private:
  int nx_, ny_, points_;
  Taps along_x_, along_y_;
};

}  // namespace holotrace
