#include "holotrace/view/register/coarse_search.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

using Spectrum = std::vector<std::complex<float>>;

// The square in which the pictures are correlated, large enough that no shift wraps around.
struct Board {
  int side, turned;  // turned: side of the square that holds `fixed` at any angle
};

Spectrum transformed(Spectrum values, int side, FftDirection direction) {
  fft_2d(values.data(), side, side, direction);
  return values;
}

// Spectrum of moving's pixels, raised to a power; power 0 gives its outline.
Spectrum spectrum_of_power(const Channel& channel, int power, int side) {
  Spectrum values(size_t(side) * size_t(side));
  for (int j = 0; j < channel.ny; ++j)
    for (int i = 0; i < channel.nx; ++i)
      values[size_t(j) * size_t(side) + size_t(i)] = float(std::pow(channel(j, i), power));
  return transformed(std::move(values), side, FftDirection::forward);
}

// Spectra of `fixed` at an angle, in the middle of its square: its values, their squares and its outline.
struct Turned {
  Spectrum values, squares, outline;
};

Turned turn(const Channel& fixed, double angle, const Board& board) {
  const size_t count = size_t(board.side) * size_t(board.side);
  Turned t{Spectrum(count), Spectrum(count), Spectrum(count)};
  const double c = std::cos(angle), s = std::sin(angle), centre = (board.turned - 1) / 2.0;
  for (int j = 0; j < board.turned; ++j)
    for (int i = 0; i < board.turned; ++i) {
      const double u = i - centre, v = j - centre;
      const double column = c * u + s * v + fixed.u_centre(), row = -s * u + c * v + fixed.v_centre();
      if (!holds_cubic(fixed, column, row)) continue;
      const float value = float(sample_cubic(fixed, column, row).value);
      const size_t at = size_t(j) * size_t(board.side) + size_t(i);
      t.values[at] = value;
      t.squares[at] = value * value;
      t.outline[at] = 1;
    }
  for (Spectrum* values : {&t.values, &t.squares, &t.outline})
    *values = transformed(std::move(*values), board.side, FftDirection::forward);
  return t;
}

}  // namespace

std::vector<Match> coarse_search(const Channel& moving, const Channel& fixed, double step, double least_overlap) {
  Board board;
  board.turned = int(std::ceil(std::hypot(fixed.nx, fixed.ny))) + 1;
  const int side = board.side = fft_good_length(std::max(moving.nx, moving.ny) + board.turned);
  const Spectrum m = spectrum_of_power(moving, 1, side), squares = spectrum_of_power(moving, 2, side),
                 outline = spectrum_of_power(moving, 0, side);
  const double least =
      least_overlap * std::min(double(moving.nx) * moving.ny, double(fixed.nx) * fixed.ny) * side * side;  // FFT scale
  const int angles = std::max(1, int(std::ceil(2 * pi / step)));
  std::vector<Match> matches(static_cast<size_t>(angles));
  parallel_for(0, angles, [&](int64_t n) {
    const double angle = 2 * pi * double(n) / angles;
    const Turned t = turn(fixed, angle, board);
    // Two real correlations at once, as the real and the imaginary part of one transform.
    Spectrum both(m.size()), weights(m.size());
    const std::complex<float> i(0, 1);
    for (size_t k = 0; k < m.size(); ++k) {
      both[k] = m[k] * std::conj(t.values[k]) + i * squares[k] * std::conj(t.outline[k]);
      weights[k] = outline[k] * (std::conj(t.squares[k]) + i * std::conj(t.outline[k]));
    }
    both = transformed(std::move(both), side, FftDirection::backward);
    weights = transformed(std::move(weights), side, FftDirection::backward);
    Match& best = matches[size_t(n)];
    size_t place = 0;
    for (size_t k = 0; k < both.size(); ++k) {
      const double product = both[k].real(), mm = both[k].imag(), ff = weights[k].real(), overlap = weights[k].imag();
      if (overlap < least || product <= 0 || mm <= 0 || ff <= 0) continue;
      const double score = product / std::sqrt(mm * ff) * std::sqrt(overlap) / side;
      if (score > best.score) best.score = score, place = k;
    }
    // Shifts beyond the moving picture are negative. The turned picture's centre lies in the middle of its square.
    int column = int(place % size_t(side)), row = int(place / size_t(side));
    if (column >= moving.nx) column -= side;
    if (row >= moving.ny) row -= side;
    const double half = (board.turned - 1) / 2.0;
    best.map = {std::cos(angle), std::sin(angle), column + half - moving.u_centre(), row + half - moving.v_centre()};
  });
  return matches;
}

}  // namespace holotrace
