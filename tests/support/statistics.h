#pragma once

#include <cmath>
#include <vector>

namespace holotrace {

/// Bound on a statistic that is about normal with mean 0 and variance 1, in the tests of a fixed seed: p = 6e-5.
constexpr double deviations = 4;

/// (χ² − k)/√(2k) for cells of equal chance, k degrees of freedom: about normal for k of some hundreds.
inline double chi_square_z(const std::vector<int>& counts, double expected) {
  double sum = 0;
  for (int count : counts) sum += (count - expected) * (count - expected) / expected;
  const double freedom = double(counts.size()) - 1;
  return (sum - freedom) / std::sqrt(2 * freedom);
}

}  // namespace holotrace
