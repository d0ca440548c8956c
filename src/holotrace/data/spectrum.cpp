#include "holotrace/data/spectrum.h"

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/pseudo_inverse.h"
#include "holotrace/data/grid.h"

namespace holotrace {

double Spectrum::at(double wavelength) const {
  if (wavelengths.empty() || !(wavelength >= wavelengths.front() && wavelength <= wavelengths.back())) return 0;
  const auto next = std::upper_bound(wavelengths.begin(), wavelengths.end(), wavelength);
  if (next == wavelengths.end()) return values.back();
  const auto i = size_t(next - wavelengths.begin());
  const double share = (wavelength - wavelengths[i - 1]) / (wavelengths[i] - wavelengths[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

std::vector<Vec3> colour_matrix(const std::vector<double>& wavelengths) {
  require(!wavelengths.empty(), "expected at least one wavelength to make colours of, got none");
  const auto count = Eigen::Index(wavelengths.size());
  Eigen::MatrixX3d weights(count, 3);  // W
  for (Eigen::Index n = 0; n < count; ++n) {
    check_wavelength(wavelengths[size_t(n)]);
    const Vec3 w = channel_weights(wavelengths[size_t(n)]);
    weights.row(n) << w.x, w.y, w.z;
  }
  const Eigen::Matrix3Xd inverse = pseudo_inverse(weights, 1e-5);  // W⁺
  std::vector<Vec3> columns;
  for (Eigen::Index n = 0; n < count; ++n) columns.push_back({inverse(0, n), inverse(1, n), inverse(2, n)});
  return columns;
}

}  // namespace holotrace
