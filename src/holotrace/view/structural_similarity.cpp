#include "holotrace/view/structural_similarity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

// Weighted means over the window of a, b, a², b² and ab, and of the noise of a and its square.
using Moments = std::array<double, 7>;

std::vector<double> gaussian_window(int size) {
  constexpr double sigma = 1.5;
  std::vector<double> window(static_cast<size_t>(size));
  double sum = 0;
  for (int i = 0; i < size; ++i) {
    const double x = i - (size - 1) / 2.0;
    sum += window[size_t(i)] = std::exp(-x * x / (2 * sigma * sigma));
  }
  for (double& w : window) w /= sum;
  return window;
}

double similarity(const Moments& m, double L) {
  const double c1 = (0.01 * L) * (0.01 * L), c2 = (0.03 * L) * (0.03 * L);
  const double of_a = m[2] - m[0] * m[0], variance_b = m[3] - m[1] * m[1], covariance = m[4] - m[0] * m[1];
  const double of_noise = m[6] - m[5] * m[5];
  const double variance_a = of_noise > 0 ? std::max(0.0, of_a - of_noise) : of_a;  // the noise may be more than all
  return (2 * m[0] * m[1] + c1) * (2 * covariance + c2) /
         ((m[0] * m[0] + m[1] * m[1] + c1) * (variance_a + variance_b + c2));
}

}  // namespace

double structural_similarity(const Image& reference, const Image& image, double s, double L,
                             std::span<const float> noise) {
  const int size = std::min({11, (reference.nx - 1) / 2 * 2 + 1, (reference.ny - 1) / 2 * 2 + 1});
  const std::vector<double> window = gaussian_window(size);
  const int nx = reference.nx - size + 1, ny = reference.ny - size + 1;
  std::vector<double> row_sum(static_cast<size_t>(ny));
  // The window is separable: first down the columns of one row of windows, then along this row.
  parallel_for(0, ny, [&](int64_t j) {
    std::vector<Moments> column(static_cast<size_t>(reference.nx));
    for (int channel = 0; channel < reference.channels; ++channel) {
      for (int i = 0; i < reference.nx; ++i) {
        Moments m{};
        for (int k = 0; k < size; ++k) {
          const double a = reference(int(j) + k, i, channel), b = s * image(int(j) + k, i, channel);
          const double w = window[size_t(k)];
          const size_t at = size_t(&reference(int(j) + k, i, channel) - reference.values.data());
          const double d = noise.empty() ? 0 : noise[at];
          m[0] += w * a, m[1] += w * b, m[2] += w * a * a, m[3] += w * b * b, m[4] += w * a * b;
          m[5] += w * d, m[6] += w * d * d;
        }
        column[size_t(i)] = m;
      }
      for (int i = 0; i < nx; ++i) {
        Moments m{};
        for (int k = 0; k < size; ++k)
          for (size_t q = 0; q < m.size(); ++q) m[q] += window[size_t(k)] * column[size_t(i + k)][q];
        row_sum[size_t(j)] += similarity(m, L);
      }
    }
  });
  double sum = 0;
  for (double row : row_sum) sum += row;
  return std::min(1.0, sum / (double(nx) * ny * reference.channels));
}

}  // namespace holotrace
