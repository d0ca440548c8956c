#include "holotrace/data/spectrum.h"

#include <Eigen/SVD>

#include "holotrace/base/error.h"
#include "holotrace/data/grid.h"

namespace holotrace {

std::vector<Vec3> colour_matrix(const std::vector<double>& wavelengths) {
  require(!wavelengths.empty(), "expected at least one wavelength to make colours of, got none");
  const auto count = Eigen::Index(wavelengths.size());
  Eigen::MatrixX3d weights(count, 3);  // W
  for (Eigen::Index n = 0; n < count; ++n) {
    check_wavelength(wavelengths[size_t(n)]);
    const Vec3 w = channel_weights(wavelengths[size_t(n)]);
    weights.row(n) << w.x, w.y, w.z;
  }
  Eigen::JacobiSVD<Eigen::MatrixXd> decomposition(weights, Eigen::ComputeThinU | Eigen::ComputeThinV);
  decomposition.setThreshold(1e-5);  // smaller singular values, as parts of the largest, count as 0
  const Eigen::MatrixXd inverse = decomposition.solve(Eigen::MatrixXd::Identity(count, count));  // W⁺
  std::vector<Vec3> columns;
  for (Eigen::Index n = 0; n < count; ++n) columns.push_back({inverse(0, n), inverse(1, n), inverse(2, n)});
  return columns;
}

}  // namespace holotrace
