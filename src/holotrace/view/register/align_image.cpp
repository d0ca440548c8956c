#include "holotrace/view/register/align_image.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/view/register/channel.h"

namespace holotrace {
namespace {

// One channel, smoothed for sampling once per `scale` pixels.
Channel channel_for_scale(const Image& image, int channel, double scale) {
  Channel one(image.ny, image.nx);
  for (size_t i = 0; i < one.values.size(); ++i)
    one.values[i] = image.values[i * size_t(image.channels) + size_t(channel)];
  return scale > 1 ? reduced(one, 1, std::sqrt((scale * scale - 1) / 12)) : one;
}

// For each row, the height of the covered pixels that end there is known in each column. The largest rectangle under
// these heights is as high as one of the columns, and ends at lower columns on both sides.
PixelRectangle largest_rectangle(const std::vector<char>& is_covered, int ny, int nx) {
  PixelRectangle best;
  std::vector<int> height(size_t(nx) + 1, 0), open;  // 0 beyond the last column
  for (int row = 0; row < ny; ++row) {
    open.clear();  // columns of increasing height
    for (int column = 0; column <= nx; ++column) {
      if (column < nx)
        height[size_t(column)] = is_covered[size_t(row) * size_t(nx) + size_t(column)] ? height[size_t(column)] + 1 : 0;
      while (!open.empty() && height[size_t(open.back())] >= height[size_t(column)]) {
        const int rows = height[size_t(open.back())];
        open.pop_back();
        const int first = open.empty() ? 0 : open.back() + 1, columns = column - first;
        if (int64_t(rows) * columns > int64_t(best.rows) * best.columns) best = {row - rows + 1, first, rows, columns};
      }
      open.push_back(column);
    }
  }
  return best;
}

}  // namespace

AlignedImage align_image(const Image& moving, const Registration& registration, int ny, int nx) {
  AlignedImage aligned{Image(ny, nx, moving.channels), {}};
  std::vector<char> is_covered(size_t(nx) * size_t(ny));
  for (int channel = 0; channel < moving.channels; ++channel) {
    const Channel one = channel_for_scale(moving, channel, registration.scale);
    parallel_for(0, ny, [&](int64_t row) {
      for (int column = 0; column < nx; ++column) {
        const auto [x, y] = registration(column - (nx - 1) / 2.0, (ny - 1) / 2.0 - double(row));
        const double at_column = one.u_centre() + x, at_row = one.v_centre() - y;
        if (!holds_cubic(one, at_column, at_row)) continue;
        const double value = sample_cubic(one, at_column, at_row).value;
        aligned.image(int(row), column, channel) = float((value - registration.offset) / registration.gain);
        is_covered[size_t(row) * size_t(nx) + size_t(column)] = 1;
      }
    });
  }
  aligned.covered = largest_rectangle(is_covered, ny, nx);
  require(aligned.covered.rows >= 8 && aligned.covered.columns >= 8,
          "expected a photograph that covers 8 × 8 pixels of the simulation or more, got {} × {}; show more of it",
          aligned.covered.columns, aligned.covered.rows);
  return aligned;
}

Image cropped(const Image& image, const PixelRectangle& r) {
  Image out(r.rows, r.columns, image.channels);
  out.pitch = image.pitch;
  for (int row = 0; row < r.rows; ++row)
    for (int column = 0; column < r.columns; ++column)
      for (int c = 0; c < image.channels; ++c)
        out(row, column, c) = image(r.first_row + row, r.first_column + column, c);
  return out;
}

}  // namespace holotrace
