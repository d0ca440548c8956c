#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"

// Tests that compare samplers with the densities they state.

namespace holotrace {

/// Bound on a statistic that is about normal with mean 0 and variance 1, for tests with a fixed seed: p = 6e-5.
constexpr double deviations = 4;

/// (χ² − k)/√(2k) for cells of equal probability, k degrees of freedom: about normal for k of some hundreds.
inline double chi_square_z(const std::vector<int>& counts, double expected) {
  double sum = 0;
  for (int count : counts) sum += (count - expected) * (count - expected) / expected;
  const double freedom = double(counts.size()) - 1;
  return (sum - freedom) / std::sqrt(2 * freedom);
}

/// P(χ² ≥ statistic) with that many degrees of freedom: the regularised upper incomplete gamma function
/// Q(degrees/2, statistic/2) (Numerical Recipes, 3rd edition, 6.2).
double chi_square_tail(double statistic, int degrees_of_freedom);

/// Level of each of `tests` independent tests that together reject a true hypothesis with probability `level`:
/// 1 − (1 − level)^(1/tests) (Šidák, J. Am. Stat. Assoc. 62, 626, 1967).
double sidak_level(double level, int tests);

struct ChiSquare {
  double statistic = 0;
  int degrees_of_freedom = 0;
  double p_value = 1;
};

/// Pearson's test of counts against their expectations. Cells that expect fewer than 5 are merged, because
/// their statistic does not follow χ².
ChiSquare chi_square(std::span<const double> observed, std::span<const double> expected);

/// A map of the unit square to the sphere about an axis: its density relative to the uniform one increases toward
/// the axis as `concentration` falls below 1; a large one gives uniform areas.
///
///     (1 − cosθ)/2 = c·u/(1 + c − u),  φ = 2π·v
class SphereMap {
 public:
  SphereMap(Vec3 axis, double concentration) : frame_(frame_from_normal(axis)), c_(concentration) {}
  Vec3 direction(Vec2 square) const;
  Vec2 square(Vec3 direction) const;
  double solid_angle(double u) const { return 4 * pi * c_ * (1 + c_) / ((1 + c_ - u) * (1 + c_ - u)); }  ///< dω/(du·dv)

 private:
  Frame frame_;
  double c_;
};

struct SphereTest {
  ChiSquare chi_square;
  double drawn = 0;      ///< fraction of the tries that gave a direction
  double integral = 0;   ///< integral of the density over the sphere
  double deviation = 0;  ///< difference of the two in standard errors
};

/// Counts directions that `sample()` draws (std::optional<Vec3>) in 16 × 32 cells of the map and compares them with
/// the integral of `pdf(direction)` over each cell, by 16 × 16 midpoints (or as many as
/// `midpoints` says), or 8 times as many along each side where the density ends inside;
/// tries without a direction are one more cell.
template <class Sample, class Pdf>
SphereTest test_sphere_sampling(const SphereMap& map, int count, Sample&& sample, const Pdf& pdf, int midpoints = 16) {
  constexpr int rows = 16, columns = 32;
  std::vector<double> observed(rows * columns + 1), expected(rows * columns + 1);
  for (int k = 0; k < count; ++k) {
    const std::optional<Vec3> direction = sample();
    if (!direction) {
      ++observed.back();
      continue;
    }
    const Vec2 square = map.square(*direction);
    const int row = std::min(rows - 1, int(square.x * rows)), column = std::min(columns - 1, int(square.y * columns));
    ++observed[size_t(row * columns + column)];
  }
  const auto integral = [&](int row, int column, int points, bool& is_cut) {
    double sum = 0;
    int zeros = 0;
    for (int a = 0; a < points; ++a)
      for (int b = 0; b < points; ++b) {
        const double u = (row + (a + 0.5) / points) / rows, v = (column + (b + 0.5) / points) / columns;
        const double density = pdf(map.direction({u, v}));
        zeros += density == 0;
        sum += density * map.solid_angle(u);
      }
    is_cut = zeros > 0 && zeros < points * points;
    return sum / (rows * points) / (columns * points);
  };
  SphereTest test;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      bool is_cut = false;
      double cell = integral(row, column, midpoints, is_cut);
      if (is_cut) cell = integral(row, column, 8 * midpoints, is_cut);
      expected[size_t(row * columns + column)] = count * cell;
      test.integral += cell;
    }
  expected.back() = count * std::fmax(0, 1 - test.integral);
  test.chi_square = chi_square(observed, expected);
  test.drawn = 1 - observed.back() / count;
  const double p = std::fmin(1, test.integral);
  // The midpoint rule has an error of about 1e-4 where the lobe is cut at the horizon.
  test.deviation = std::fabs(test.drawn - test.integral) / (std::sqrt(p * (1 - p) / count) + 2e-4);
  return test;
}

}  // namespace holotrace
