#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/estimate/cost.h"
#include "support/statistics.h"
#include "trace/follow.h"

// The paper's number of rays (Eq. 19, 20), compared with paths in closed scenes, from which no ray escapes.

namespace holotrace {
namespace {

// Moments of the number of surfaces on a path that continues with probability ρ and has at most `most` surfaces:
// P(l ≥ j) = ρʲ⁻¹, so E l = Σρʲ⁻¹ and E l² = Σ(2j − 1)ρʲ⁻¹ for j = 1 … most.
double standard_deviation(double rho, int most) {
  double mean = 0, square = 0;
  for (int j = 1; j <= std::min(most, 2000); ++j) {
    mean += std::pow(rho, j - 1);
    square += (2 * j - 1) * std::pow(rho, j - 1);
  }
  return std::sqrt(square - mean * mean);
}

TEST(PathLength, InAClosedFurnaceIsEquation20) {
  // Every wall ends the path with probability 1 − ρ: Russian roulette continues with min(1, weight), and a surface of
  // albedo ρ gives each remaining path the weight ρ.
  constexpr int count = 40000;
  for (const double rho : {0.2, 0.5, 0.8}) {
    const Scene scene = make_box_scene({0, 0, -0.3}, {0.1, 0.1, 0.1}, grey(rho, 1));
    PathCounts counts;
    radiances(scene, {{0.01, 0.02, -0.29}, normalize({0.3, 0.2, -1})}, count,
              {.max_depth = unlimited, .roulette_depth = 1}, counts);
    ASSERT_EQ(counts.paths, count);
    EXPECT_EQ(counts.escaped, 0);
    const double z = (counts.mean_path_length() - mean_path_length(rho)) /
                     (standard_deviation(rho, unlimited) / std::sqrt(double(count)));
    EXPECT_LT(std::abs(z), deviations) << rho;
    EXPECT_DOUBLE_EQ(mean_path_length(rho), 1 / (1 - rho));
  }
}

TEST(PathLength, CutAfterKBouncesIsEquation19) {
  // max_depth surfaces are max_depth − 1 bounces: the sum 1 + ρ + … + ρᵏ has k + 1 terms.
  constexpr int count = 40000;
  const double rho = 0.8;
  const Scene scene = make_box_scene({0, 0, -0.3}, {0.1, 0.1, 0.1}, grey(rho, 1));
  for (const int depth : {1, 2, 4, 8}) {
    PathCounts counts;
    radiances(scene, {{0.01, 0.02, -0.29}, normalize({0.3, 0.2, -1})}, count, {.max_depth = depth, .roulette_depth = 1},
              counts);
    const double expected = mean_path_length(rho, depth - 1), error = standard_deviation(rho, depth);
    if (depth == 1) {
      EXPECT_EQ(counts.mean_path_length(), 1);
      continue;
    }
    const double standard_error = error / std::sqrt(double(count));
    EXPECT_LT(std::abs(counts.mean_path_length() - expected) / standard_error, deviations) << depth;
    // The paper's closed form ends the sum one term early: (1 − ρᵏ)/(1 − ρ) is less by ρᵏ, 0.21 at k = 7.
    EXPECT_GT(expected - (1 - std::pow(rho, depth - 1)) / (1 - rho), 10 * standard_error);
  }
}

}  // namespace
}  // namespace holotrace
