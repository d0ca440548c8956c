#include "holotrace/slm/panel/crosstalk.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "holotrace/base/array.h"
#include "holotrace/slm/panel/panel_loops.h"

namespace holotrace {
namespace {

// The panel is taken as periodic.
int wrap_index(int i, int n) {
  while (i < 0) i += n;
  while (i >= n) i -= n;
  return i;
}

// to[i] = Σ_d taps[d + reach]·from[i + d], or += that, on a line of n values that repeats.
void blur_periodic(const float* from, const float* taps, int reach, int n, bool adds, float* to) {
  const int count = 2 * reach + 1, inner = std::max(0, n - 2 * reach);
  if (inner > 0) blur_line(from, taps, size_t(count), size_t(inner), adds, to + reach);
  const int left = inner > 0 ? reach : n;
  const auto at = [&](int i) {
    float sum = adds ? to[i] : 0;
    for (int d = -reach; d <= reach; ++d) sum += taps[d + reach] * from[wrap_index(i + d, n)];
    to[i] = sum;
  };
  for (int i = 0; i < left; ++i) at(i);
  for (int i = left + inner; i < n; ++i) at(i);
}

}  // namespace

PixelBlur::Taps::Taps(double sigma, double lit, const std::vector<double>& places) {
  const double farthest = lit / 2 * *std::max_element(places.begin(), places.end());
  reach = int(std::ceil(5 * sigma + farthest - 0.5 + 1e-9));
  const double scale = 1 / (std::sqrt(2.0) * sigma);
  for (const double place : places) {
    const double q = lit / 2 * place;
    std::vector<double> k;
    double sum = 0;
    for (int d = -reach; d <= reach; ++d) {
      k.push_back(0.5 * (std::erf((q - d + 0.5) * scale) - std::erf((q - d - 0.5) * scale)));
      sum += k.back();
    }
    for (const double value : k) values.push_back(float(value / sum));
  }
}

PixelBlur::PixelBlur(const Slm& slm, const std::vector<double>& places)
    : nx_(slm.grid.nx), ny_(slm.grid.ny), points_(int(places.size())) {
  if (!(slm.effects.crosstalk > 0)) return;
  along_x_ = Taps(slm.effects.crosstalk, slm.lit_x(), places);
  along_y_ = Taps(slm.effects.crosstalk, slm.lit_y(), places);
}

void PixelBlur::to_points(const float* pixels, int j, int cy, float* values) const {
  const int reach_y = along_y_.reach;
  std::vector<const float*> lines;
  for (int d = -reach_y; d <= reach_y; ++d) lines.push_back(pixels + size_t(wrap_index(j + d, ny_)) * size_t(nx_));
  AlignedVector<float> blurred(static_cast<size_t>(nx_));
  sum_lines(lines.data(), along_y_.of_point(cy), lines.size(), blurred.size(), blurred.data());
  for (int cx = 0; cx < points_; ++cx)
    blur_periodic(blurred.data(), along_x_.of_point(cx), along_x_.reach, nx_, false, values + size_t(cx) * size_t(nx_));
}

void PixelBlur::from_points(const float* values, float* row) const {
  for (int cx = 0; cx < points_; ++cx) {
    // Point i has read pixel i + d − reach: the adjoint has the taps in reverse order.
    const std::vector<float> reversed(std::make_reverse_iterator(along_x_.of_point(cx) + along_x_.taps()),
                                      std::make_reverse_iterator(along_x_.of_point(cx)));
    blur_periodic(values + size_t(cx) * size_t(nx_), reversed.data(), along_x_.reach, nx_, cx > 0, row);
  }
}

void PixelBlur::from_rows(const float* rows, int j, float* to) const {
  const int reach = along_y_.reach;
  std::vector<const float*> lines;
  std::vector<float> factors;
  for (int cy = 0; cy < points_; ++cy)
    for (int d = -reach; d <= reach; ++d) {
      factors.push_back(along_y_.of_point(cy)[d + reach]);
      lines.push_back(rows + (size_t(cy) * size_t(ny_) + size_t(wrap_index(j - d, ny_))) * size_t(nx_));
    }
  sum_lines(lines.data(), factors.data(), lines.size(), size_t(nx_), to);
}

}  // namespace holotrace
