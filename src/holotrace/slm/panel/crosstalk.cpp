#include "holotrace/slm/panel/crosstalk.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/array.h"

namespace holotrace {
namespace {

// The panel is taken as periodic.
int wrap_index(int i, int n) {
  while (i < 0) i += n;
  while (i >= n) i -= n;
  return i;
}

}  // namespace

PixelBlur::Taps::Taps(double sigma, double lit, int cells) {
  reach = int(std::ceil(6 * sigma + lit / 2 - 0.5 + 1e-9));
  const double scale = 1 / (std::sqrt(2.0) * sigma);
  for (int c = 0; c < cells; ++c) {
    const double q = lit * ((c + 0.5) / cells - 0.5);
    std::vector<double> k;
    double sum = 0;
    for (int d = -reach; d <= reach; ++d) {
      k.push_back(0.5 * (std::erf((q - d + 0.5) * scale) - std::erf((q - d - 0.5) * scale)));
      sum += k.back();
    }
    for (const double value : k) values.push_back(float(value / sum));
  }
}

PixelBlur::PixelBlur(const Slm& slm, int cells) : nx_(slm.grid.nx), ny_(slm.grid.ny), s_(cells) {
  if (!(slm.effects.crosstalk > 0)) return;
  along_x_ = Taps(slm.effects.crosstalk, slm.lit_x(), cells);
  along_y_ = Taps(slm.effects.crosstalk, slm.lit_y(), cells);
}

void PixelBlur::to_cells(const float* pixels, int j, int cy, float* cells) const {
  const int reach_y = along_y_.reach, reach_x = along_x_.reach;
  AlignedVector<float> blurred(size_t(nx_), 0.0F), wide(size_t(nx_ + 2 * reach_x));
  const float* ky = along_y_.of_cell(cy);
  for (int d = -reach_y; d <= reach_y; ++d) {
    const float* line = pixels + size_t(wrap_index(j + d, ny_)) * size_t(nx_);
    const float k = ky[d + reach_y];
    for (int i = 0; i < nx_; ++i) blurred[size_t(i)] += k * line[i];
  }
  for (int i = 0; i < nx_ + 2 * reach_x; ++i) wide[size_t(i)] = blurred[size_t(wrap_index(i - reach_x, nx_))];
  for (int cx = 0; cx < s_; ++cx) {
    const float* kx = along_x_.of_cell(cx);
    float* to = cells + size_t(cx) * size_t(nx_);
    std::fill(to, to + nx_, 0.0F);
    for (int d = 0; d <= 2 * reach_x; ++d)
      for (int i = 0; i < nx_; ++i) to[i] += kx[d] * wide[size_t(i + d)];
  }
}

void PixelBlur::from_cells(const float* cells, float* row) const {
  const int reach = along_x_.reach;
  AlignedVector<float> wide(size_t(nx_ + 2 * reach));
  std::fill(row, row + nx_, 0.0F);
  for (int cx = 0; cx < s_; ++cx) {
    const float* kx = along_x_.of_cell(cx);
    const float* from = cells + size_t(cx) * size_t(nx_);
    for (int i = 0; i < nx_ + 2 * reach; ++i) wide[size_t(i)] = from[wrap_index(i - reach, nx_)];
    for (int d = 0; d <= 2 * reach; ++d)  // cell i has read pixel i + d − reach
      for (int i = 0; i < nx_; ++i) row[i] += kx[d] * wide[size_t(i + 2 * reach - d)];
  }
}

void PixelBlur::from_rows(const float* rows, int j, float* to) const {
  const int reach = along_y_.reach;
  std::fill(to, to + nx_, 0.0F);
  for (int cy = 0; cy < s_; ++cy)
    for (int d = -reach; d <= reach; ++d) {
      const float k = along_y_.of_cell(cy)[d + reach];
      const float* from = rows + (size_t(cy) * size_t(ny_) + size_t(wrap_index(j - d, ny_))) * size_t(nx_);
      for (int i = 0; i < nx_; ++i) to[i] += k * from[i];
    }
}

int crosstalk_cells(const Slm& slm, const ShowParams& params) {
  if (!(slm.effects.crosstalk > 0)) return 1;
  if (params.fine_samples > 0) return params.fine_samples;
  return slm.effects.crosstalk < 0.2 ? 8 : 4;
}

}  // namespace holotrace
