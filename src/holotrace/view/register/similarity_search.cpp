#include "holotrace/view/register/similarity_search.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

using Spectrum = std::vector<std::complex<float>>;

// The square in which the pictures are correlated, large enough that no shift wraps around.
struct Board {
  int side, turned;  // turned: side of the square that holds `fixed` at any angle
};

Spectrum transformed(Spectrum values, int side, FftDirection direction) {
  fft_2d(values.data(), side, side, direction);
  return values;
}

// Spectrum of moving's pixels, raised to a power; power 0 gives its outline.
Spectrum spectrum_of_power(const Channel& channel, int power, int side) {
  Spectrum values(size_t(side) * size_t(side));
  for (int j = 0; j < channel.ny; ++j)
    for (int i = 0; i < channel.nx; ++i)
      values[size_t(j) * size_t(side) + size_t(i)] = float(std::pow(channel(j, i), power));
  return transformed(std::move(values), side, FftDirection::forward);
}

// Spectra of `fixed` at an angle, in the middle of its square: its values, their squares and its outline.
struct Turned {
  Spectrum values, squares, outline;
};

Turned turn(const Channel& fixed, double angle, const Board& board) {
  const size_t count = size_t(board.side) * size_t(board.side);
  Turned t{Spectrum(count), Spectrum(count), Spectrum(count)};
  const double c = std::cos(angle), s = std::sin(angle), centre = (board.turned - 1) / 2.0;
  for (int j = 0; j < board.turned; ++j)
    for (int i = 0; i < board.turned; ++i) {
      const double u = i - centre, v = j - centre;
      const double column = c * u + s * v + fixed.u_centre(), row = -s * u + c * v + fixed.v_centre();
      if (!holds_cubic(fixed, column, row)) continue;
      const float value = float(sample_cubic(fixed, column, row).value);
      const size_t at = size_t(j) * size_t(board.side) + size_t(i);
      t.values[at] = value;
      t.squares[at] = value * value;
      t.outline[at] = 1;
    }
  for (Spectrum* values : {&t.values, &t.squares, &t.outline})
    *values = transformed(std::move(*values), board.side, FftDirection::forward);
  return t;
}

}  // namespace

std::vector<Match> coarse_search(const Channel& moving, const Channel& fixed, double step, double least_overlap) {
  Board board;
  board.turned = int(std::ceil(std::hypot(fixed.nx, fixed.ny))) + 1;
  const int side = board.side = fft_good_length(std::max(moving.nx, moving.ny) + board.turned);
  const Spectrum m = spectrum_of_power(moving, 1, side), squares = spectrum_of_power(moving, 2, side),
                 outline = spectrum_of_power(moving, 0, side);
  const double least =
      least_overlap * std::min(double(moving.nx) * moving.ny, double(fixed.nx) * fixed.ny) * side * side;  // FFT scale
  const int angles = std::max(1, int(std::ceil(2 * pi / step)));
  std::vector<Match> matches(static_cast<size_t>(angles));
  parallel_for(0, angles, [&](int64_t n) {
    const double angle = 2 * pi * double(n) / angles;
    const Turned t = turn(fixed, angle, board);
    // Two real correlations at once, as the real and the imaginary part of one transform.
    Spectrum both(m.size()), weights(m.size());
    const std::complex<float> i(0, 1);
    for (size_t k = 0; k < m.size(); ++k) {
      both[k] = m[k] * std::conj(t.values[k]) + i * squares[k] * std::conj(t.outline[k]);
      weights[k] = outline[k] * (std::conj(t.squares[k]) + i * std::conj(t.outline[k]));
    }
    both = transformed(std::move(both), side, FftDirection::backward);
    weights = transformed(std::move(weights), side, FftDirection::backward);
    Match& best = matches[size_t(n)];
    size_t place = 0;
    for (size_t k = 0; k < both.size(); ++k) {
      const double product = both[k].real(), mm = both[k].imag(), ff = weights[k].real(), overlap = weights[k].imag();
      if (overlap < least || product <= 0 || mm <= 0 || ff <= 0) continue;
      const double score = product / std::sqrt(mm * ff) * std::sqrt(overlap) / side;
      if (score > best.score) best.score = score, place = k;
    }
    // Shifts beyond the moving picture are negative. The turned picture's centre lies in the middle of its square.
    int column = int(place % size_t(side)), row = int(place / size_t(side));
    if (column >= moving.nx) column -= side;
    if (row >= moving.ny) row -= side;
    const double half = (board.turned - 1) / 2.0;
    best.map = {std::cos(angle), std::sin(angle), column + half - moving.u_centre(), row + half - moving.v_centre()};
  });
  return matches;
}

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
