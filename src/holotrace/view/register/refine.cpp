#include "holotrace/view/register/refine.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

// Unknowns: a and b (times the picture's radius, so that all are lengths [pixels]), x and y.
using Vector = Eigen::Matrix<double, 4, 1>;
using Matrix = Eigen::Matrix<double, 4, 4>;

constexpr int block = 16;

// Contribution of a row of blocks to the equations, or their total.
struct Sums {
  Matrix normal = Matrix::Zero();   // Σ (∇m·Xₖ)(∇f·Xₗ)
  Matrix spread = Matrix::Zero();   // covariance of `balance`: Σ over blocks of share·shareᵀ
  Vector balance = Vector::Zero();  // Σ (f·∇m − m·∇f)·Xₖ
  double mm = 0, ff = 0, mf = 0, pixels = 0;

  void operator+=(const Sums& s) {
    normal += s.normal;
    spread += s.spread;
    balance += s.balance;
    mm += s.mm, ff += s.ff, mf += s.mf, pixels += s.pixels;
  }
};

double radius_of(const Channel& channel) { return std::max(1.0, std::hypot(channel.nx, channel.ny) / 2); }

Sums sum_rows(const Channel& moving, const Channel& fixed, const Similarity& map, int first_row) {
  const double radius = radius_of(fixed), scale_squared = map.a * map.a + map.b * map.b;
  std::vector<Vector> shares(size_t((fixed.nx + block - 1) / block), Vector::Zero());
  Sums sums;
  for (int row = std::max(first_row, 1); row < std::min(first_row + block, fixed.ny - 2); ++row)
    for (int column = 1; column < fixed.nx - 2; ++column) {
      const double u = column - fixed.u_centre(), v = row - fixed.v_centre();
      const auto [x, y] = map(u, v);
      const double at_column = x + moving.u_centre(), at_row = y + moving.v_centre();
      if (!holds_cubic(moving, at_column, at_row)) continue;
      const Sample m = sample_cubic(moving, at_column, at_row), f = sample_cubic(fixed, column, row);
      // ∇f along the axes of `moving`: the slopes of `fixed`, rotated and divided by the scale.
      const double f_u = (map.a * f.slope_u - map.b * f.slope_v) / scale_squared,
                   f_v = (map.b * f.slope_u + map.a * f.slope_v) / scale_squared;
      const auto along = [&](double slope_u, double slope_v) -> Vector {
        return {(slope_u * u + slope_v * v) / radius, (slope_v * u - slope_u * v) / radius, slope_u, slope_v};
      };
      const Vector of_m = along(m.slope_u, m.slope_v), of_f = along(f_u, f_v);
      sums.normal += of_m * of_f.transpose();
      shares[size_t(column / block)] += f.value * of_m - m.value * of_f;
      sums.mm += m.value * m.value;
      sums.ff += f.value * f.value;
      sums.mf += m.value * f.value;
      sums.pixels += 1;
    }
  for (const Vector& share : shares) {
    sums.balance += share;
    sums.spread += share * share.transpose();
  }
  return sums;
}

// The rows of blocks are added in order, so the result is the same on any number of threads.
Sums sum_all(const Channel& moving, const Channel& fixed, const Similarity& map) {
  std::vector<Sums> rows(size_t((fixed.ny + block - 1) / block));
  parallel_for(0, int64_t(rows.size()),
               [&](int64_t n) { rows[size_t(n)] = sum_rows(moving, fixed, map, int(n) * block); });
  Sums sums;
  for (const Sums& row : rows) sums += row;
  sums.normal = ((sums.normal + sums.normal.transpose()) / 2).eval();
  return sums;
}

double worst_corner_error(const Matrix& covariance, const Channel& fixed) {
  double worst = 0;
  for (const int right : {-1, 1})
    for (const int down : {-1, 1}) {
      const double u = right * fixed.nx / 2.0 / radius_of(fixed), v = down * fixed.ny / 2.0 / radius_of(fixed);
      Eigen::Matrix<double, 2, 4> places;
      places << u, -v, 1, 0, v, u, 0, 1;
      worst = std::max(worst, (places * covariance * places.transpose()).trace());
    }
  return std::sqrt(worst);
}

}  // namespace

double Fit::score() const { return correlation * std::sqrt(pixels); }

Fit refine(const Channel& moving, const Channel& fixed, const Similarity& start, int most_iterations) {
  constexpr double least_pixels = 64;   // with fewer, noise hides the four unknowns
  constexpr double small_step = 1e-4;   // pixels; far below the effect of noise
  constexpr double longest_step = 2.0;  // pixels; the slopes at the start hold no farther
  constexpr double least_rcond = 1e-4;  // below (a disc, a grating), the raster would decide instead of the picture
  const double radius = radius_of(fixed);
  Fit fit;
  fit.map = start;
  for (;; ++fit.iterations) {
    const Sums sums = sum_all(moving, fixed, fit.map);
    if (sums.pixels < least_pixels || sums.mm <= 0 || sums.ff <= 0) return {};
    const Eigen::LDLT<Matrix> solver(sums.normal);
    if (solver.info() != Eigen::Success || !solver.isPositive() || solver.rcond() < least_rcond) return {};
    Vector step = solver.solve(sums.balance) / 2;
    const double length = step.norm();
    if (length < small_step || fit.iterations == most_iterations) {
      const Matrix inverse = solver.solve(Matrix::Identity());
      fit.uncertainty = worst_corner_error(inverse * sums.spread * inverse / 4, fixed);
      fit.pixels = sums.pixels;
      fit.correlation = sums.mf / std::sqrt(sums.mm * sums.ff);
      return fit;
    }
    if (length > longest_step) step *= longest_step / length;
    fit.map.a += step[0] / radius;
    fit.map.b += step[1] / radius;
    fit.map.x += step[2];
    fit.map.y += step[3];
  }
}

}  // namespace holotrace
