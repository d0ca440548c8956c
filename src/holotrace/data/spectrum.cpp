#include "holotrace/data/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/data/grid.h"

namespace holotrace {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

// A Jacobi rotation of the rows and columns p and q of a symmetric matrix: a[p][q] becomes 0; the columns of v follow.
void rotate(Matrix& a, Matrix& v, size_t p, size_t q) {
  if (a[p][q] == 0) return;
  const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1), s = t * c;
  const size_t r = 3 - p - q;
  const double arp = a[r][p], arq = a[r][q];
  a[p][p] -= t * a[p][q];
  a[q][q] += t * a[p][q];
  a[p][q] = a[q][p] = 0;
  a[r][p] = a[p][r] = c * arp - s * arq;
  a[r][q] = a[q][r] = s * arp + c * arq;
  for (auto& row : v) {
    const double vp = row[p], vq = row[q];
    row[p] = c * vp - s * vq;
    row[q] = s * vp + c * vq;
  }
}

// Moore–Penrose inverse of a symmetric matrix, by its eigenvalues; those below `cut` times the largest count as 0.
Matrix pseudo_inverse(Matrix a, double cut) {
  Matrix v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int sweep = 0; sweep < 30; ++sweep) {  // converges quadratically: six sweeps suffice
    rotate(a, v, 0, 1);
    rotate(a, v, 0, 2);
    rotate(a, v, 1, 2);
  }
  const double largest = std::max({a[0][0], a[1][1], a[2][2]});
  Matrix inverse{};
  for (size_t k = 0; k < 3; ++k) {
    if (a[k][k] <= cut * largest) continue;
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) inverse[i][j] += v[i][k] * v[j][k] / a[k][k];
  }
  return inverse;
}

}  // namespace

std::vector<Vec3> colour_matrix(const std::vector<double>& wavelengths) {
  require(!wavelengths.empty(), "expected at least one wavelength to make colours of, got none");
  Matrix square{};  // WᵀW
  for (const double wavelength : wavelengths) {
    check_wavelength(wavelength);
    const Vec3 w = channel_weights(wavelength);
    const std::array<double, 3> row{w.x, w.y, w.z};
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) square[i][j] += row[i] * row[j];
  }
  const Matrix inverse = pseudo_inverse(square, 1e-10);  // cut for squares of singular values
  std::vector<Vec3> columns;
  for (const double wavelength : wavelengths) {  // M = (WᵀW)⁺·Wᵀ
    const Vec3 w = channel_weights(wavelength);
    const auto part = [&](size_t i) { return inverse[i][0] * w.x + inverse[i][1] * w.y + inverse[i][2] * w.z; };
    columns.push_back({part(0), part(1), part(2)});
  }
  return columns;
}

}  // namespace holotrace
