#pragma once

#include <cstddef>
#include <vector>

namespace holotrace {

/// The kernel of non-uniform FFTs, "exponential of semicircle", of Barnett, Magland & af Klinteberg, SIAM J. Sci.
/// Comput. 41, C479 (2019):
///
///     φ(x) = exp(β(√(1 − (2x/w)²) − 1)),  |x| < w/2 cells
///
struct SemicircleKernel {
  int width = 0;    ///< w [cells]
  double beta = 0;  ///< β, about 0.97π·w(1 − 1/2σ) for a grid σ times as fine as needed

  double value(double x) const;

  /// ∫xⁿφ(x)·exp(2πiξx)dx, with ξ in cycles per cell. Even moments are real; odd ones are i times the value that is
  /// returned.
  double moment(int n, double xi) const;
};

/// Spreads a plane wave of any frequency over the `width` nearest frequencies of a grid, so that an FFT of the grid
/// evaluates it. It is SemicircleKernel with the β of least error for each width: 1.80·w to 2.33·w for a grid twice as fine as the
/// FFT's outputs need, 1.47·w to 2.06·w for one that is 1.5 times as fine. Its error falls about tenfold for each added cell of width,
/// sixfold on the coarser grid.
class GriddingKernel {
 public:
  static constexpr int greatest_width = 8;
  static constexpr int degree = 11;
  /// Degree of the polynomials for a width: their error is below that of the kernel.
  static constexpr int degree_of(int width) { return width + 3 < degree ? width + 3 : degree; }

  /// @param width         width in cells, 2 … 8
  /// @param oversampling  of the grid: 2 or 1.5
  explicit GriddingKernel(int width, double oversampling = 2);

  int width() const { return kernel_.width; }

  /// Polynomial coefficients: the weight of cell l, for a wave at the fraction t ∈ [0, 1) (cell 0 lies t − w/2 from
  /// it), is Σ c[k][l]·(t − ½)ᵏ. Cells beyond the width have weight 0.
  const float* coefficients(int power) const { return &coefficients_[std::size_t(power) * greatest_width]; }

  /// Fourier transform φ̂(ξ) = ∫φ(x)·cos(2πξx)dx; ξ in cycles per cell.
  double transform(double xi) const { return moment(0, xi); }
  double moment(int n, double xi) const { return kernel_.moment(n, xi); }
  double value(double x) const { return kernel_.value(x); }
  /// The weight of cell l by the polynomials, t ∈ [0, 1].
  double weight(int l, double t) const;

 private:
  SemicircleKernel kernel_;
  std::vector<float> coefficients_;
};

/// Relative L2 error of a plane wave along one axis of a tile, over its outputs from one end on. The values are measured. At the
/// ends it is greater than in the middle.
/// @param used  part of the outputs that counts, above 0 to 1
double gridding_error(int width, double oversampling = 2, double used = 1);

}  // namespace holotrace
