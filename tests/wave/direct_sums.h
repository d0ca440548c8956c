#pragma once

#include <gtest/gtest.h>

#include "holotrace/base/random.h"
#include "holotrace/wave/propagate/propagate.h"

namespace holotrace::test {

/// Relative L2 error of a propagation against the direct Rayleigh–Sommerfeld sum, at 60 pixels drawn from the output.
template <class Real>
double error_against_direct_sum(const FieldDouble& input, double z, const PropagateParams& params) {
  const BasicField<Real> output = propagate(convert<Real>(input), z, params);
  EXPECT_EQ(output.grid, propagation_output(input.grid, params));
  CounterRandom random(5, 0, 0);
  std::vector<Vec3> points;
  std::vector<std::complex<double>> found;
  for (int n = 0; n < 60; ++n) {
    const int i = int(random.uniform() * output.grid.nx), j = int(random.uniform() * output.grid.ny);
    points.push_back({output.grid.x(i), output.grid.y(j), z});
    found.push_back(std::complex<double>(output.samples(j, i)));
  }
  const auto expected = sum_rayleigh_sommerfeld(input, points);
  double error = 0, energy = 0;
  for (size_t n = 0; n < points.size(); ++n) {
    error += std::norm(found[n] - expected[n]);
    energy += std::norm(expected[n]);
  }
  return std::sqrt(error / energy);
}

}  // namespace holotrace::test
