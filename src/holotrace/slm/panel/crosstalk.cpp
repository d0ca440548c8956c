#include "holotrace/slm/panel/crosstalk.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "holotrace/base/array.h"
#include "holotrace/slm/panel/blur_kernels.h"

namespace holotrace {
namespace {

// The panel is taken as periodic.
int wrap_index(int i, int n) {
  while (i < 0) i += n;
  while (i >= n) i -= n;
  return i;
}

// A line of n values with `reach` more on each side.
AlignedVector<float> continued(const float* line, int n, int reach) {
  AlignedVector<float> wide(size_t(n + 2 * reach));
  std::copy_n(line, n, wide.data() + reach);
  for (int i = 0; i < reach; ++i) {
    wide[size_t(i)] = line[wrap_index(i - reach, n)];
    wide[size_t(n + reach + i)] = line[wrap_index(n + i, n)];
  }
  return wide;
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
  const int reach_y = along_y_.reach;
  std::vector<const float*> lines;
  for (int d = -reach_y; d <= reach_y; ++d) lines.push_back(pixels + size_t(wrap_index(j + d, ny_)) * size_t(nx_));
  AlignedVector<float> blurred(static_cast<size_t>(nx_));
  sum_lines(lines.data(), along_y_.of_cell(cy), lines.size(), blurred.size(), blurred.data());
  const AlignedVector<float> wide = continued(blurred.data(), nx_, along_x_.reach);
  for (int cx = 0; cx < s_; ++cx)
    blur_line(wide.data(), along_x_.of_cell(cx), along_x_.taps(), size_t(nx_), cells + size_t(cx) * size_t(nx_));
}

void PixelBlur::from_cells(const float* cells, float* row) const {
  std::vector<AlignedVector<float>> parts;
  std::vector<const float*> lines;
  for (int cx = 0; cx < s_; ++cx) {
    const AlignedVector<float> wide = continued(cells + size_t(cx) * size_t(nx_), nx_, along_x_.reach);
    // Cell i has read pixel i + d − reach: the adjoint has the taps in reverse order.
    const std::vector<float> reversed(std::make_reverse_iterator(along_x_.of_cell(cx) + along_x_.taps()),
                                      std::make_reverse_iterator(along_x_.of_cell(cx)));
    blur_line(wide.data(), reversed.data(), reversed.size(), size_t(nx_), parts.emplace_back(size_t(nx_)).data());
    lines.push_back(parts.back().data());
  }
  const std::vector<float> ones(lines.size(), 1.0F);
  sum_lines(lines.data(), ones.data(), lines.size(), size_t(nx_), row);
}

void PixelBlur::from_rows(const float* rows, int j, float* to) const {
  const int reach = along_y_.reach;
  std::vector<const float*> lines;
  std::vector<float> factors;
  for (int cy = 0; cy < s_; ++cy)
    for (int d = -reach; d <= reach; ++d) {
      factors.push_back(along_y_.of_cell(cy)[d + reach]);
      lines.push_back(rows + (size_t(cy) * size_t(ny_) + size_t(wrap_index(j - d, ny_))) * size_t(nx_));
    }
  sum_lines(lines.data(), factors.data(), lines.size(), size_t(nx_), to);
}

int crosstalk_cells(const Slm& slm, const ShowParams& params) {
  if (!(slm.effects.crosstalk > 0)) return 1;
  if (params.fine_samples > 0) return params.fine_samples;
  return slm.effects.crosstalk < 0.2 ? 8 : 4;
}

}  // namespace holotrace
