#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "holotrace/data/image.h"

namespace holotrace {

/// One channel of a picture for registration, row 0 at the top. Places are in its pixels from its centre, u to the
/// right and v down: u(column) = column − (nx − 1)/2, v(row) = row − (ny − 1)/2.
struct Channel {
  int nx = 0, ny = 0;
  std::vector<float> values;

  Channel() = default;
  Channel(int ny, int nx) : nx(nx), ny(ny), values(size_t(nx) * size_t(ny)) {}
  float& operator()(int row, int column) { return values[size_t(row) * size_t(nx) + size_t(column)]; }
  const float& operator()(int row, int column) const { return values[size_t(row) * size_t(nx) + size_t(column)]; }
  double u_centre() const { return (nx - 1) / 2.0; }
  double v_centre() const { return (ny - 1) / 2.0; }
};

/// Map from places in one picture to places in another: (u, v) → (a·u − b·v + x, b·u + a·v + y), with a + ib =
/// scale·exp(i·angle). The angle is clockwise, since v points down.
struct Similarity {
  double a = 1, b = 0, x = 0, y = 0;
  std::array<double, 2> operator()(double u, double v) const { return {a * u - b * v + x, b * u + a * v + y}; }
};

/// The mean of an image's channels.
Channel mean_of_channels(const Image& image);

/// The picture in pixels `pixel` times as large, ⌊nx/pixel⌋ × ⌊ny/pixel⌋ of them about the same centre. Each is a mean
/// of the old pixels, weighted by a Gaussian of σ = blur·pixel.
/// @param pixel  > 0; the picture keeps at least one pixel
/// @param blur   > 0; from 0.8 on, detail finer than the new pixels is removed: exp(−(π·0.8)²/2) = 4 % is left at the
///               Nyquist frequency
Channel reduced(const Channel& channel, double pixel, double blur);

/// The picture less its own blur by a Gaussian of σ = `extent` pixels: without shading, ambient light and offset.
Channel without_shading(const Channel& channel, double extent);

/// Keys' kernel with a = −1/2 at the distances t + 1, t, 1 − t, 2 − t, and its slopes along t, for t in [0, 1).
void cubic_weights(double t, double weights[4], double slopes[4]);

/// Value and slopes at a place between pixel centres.
struct Sample {
  double value, slope_u, slope_v;
};

/// Cubic convolution (Keys, IEEE Trans. Acoust. 29, 1153 (1981)) of the 4 × 4 pixels about column and row, which must
/// be in [1, nx − 2) and [1, ny − 2).
Sample sample_cubic(const Channel& channel, double column, double row);

/// Whether the picture has the 4 × 4 pixels about the place.
inline bool holds_cubic(const Channel& channel, double column, double row) {
  return column >= 1 && row >= 1 && column < channel.nx - 2 && row < channel.ny - 2;
}

}  // namespace holotrace
