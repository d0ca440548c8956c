#include "holotrace/view/order_stop.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"

namespace holotrace {
namespace {

void check_filter(const SpectralFilter& f, const Grid& grid) {
  require(std::isfinite(f.u0) && std::isfinite(f.v0) && std::isfinite(f.half_u) && std::isfinite(f.half_v) &&
              f.half_u > 0 && f.half_v > 0,
          "expected a pass band with finite centre and half widths above 0, got centre ({}, {}) /m, half widths ({}, "
          "{}) /m",
          f.u0, f.v0, f.half_u, f.half_v);
  const double nyquist = 1 / (2 * grid.pitch);
  require(std::abs(f.u0) - f.half_u < nyquist && std::abs(f.v0) - f.half_v < nyquist,
          "expected a pass band that begins below {:.6g} /m, the Nyquist frequency of samples {} apart, got one around "
          "({:.6g}, {:.6g}) /m; show the hologram with more subpixels",
          nyquist, format_length(grid.pitch), f.u0, f.v0);
}

// Whether the band around `centre` contains the frequency of each bin; an edge that falls on a bin counts as inside.
std::vector<char> bins_inside(int n, double side, double sign, double centre, double half) {
  std::vector<char> inside(static_cast<size_t>(n));
  for (int k = 0; k < n; ++k)
    inside[size_t(k)] = std::abs(sign * signed_frequency(k, n) / side - centre) <= half * (1 + 1e-9);
  return inside;
}

// exp(−2πi·f·x) along one axis; the phase is reduced to a fraction of a cycle in double.
template <class Position>
std::vector<std::complex<double>> carrier(int n, double f, const Position& position) {
  std::vector<std::complex<double>> wave(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) wave[size_t(i)] = cis_cycles(-f * position(i));
  return wave;
}

}  // namespace

int order_stop_margin(const SpectralFilter& filter, const Grid& grid) {
  const double width = 1 / (2 * std::min(filter.half_u, filter.half_v) * grid.pitch);
  return int(std::min(std::ceil(32 * width), double(largest_order_stop_margin(grid))));
}

Field apply_order_stop(const Field& field, const SpectralFilter& filter, int margin, const Observer& observer) {
  check_grid(field.grid);
  check_filter(filter, field.grid);
  require(margin >= 0, "expected a margin of 0 samples or more beside a window, got {}", margin);
  Field out = field;
  out.filter.reset();
  out.grid.nx += 2 * margin;
  out.grid.ny += 2 * margin;
  const Grid& grid = out.grid;
  if (margin > 0) {
    out.samples = Array2D<std::complex<float>>(grid.ny, grid.nx);
    for (int j = 0; j < field.grid.ny; ++j)
      std::copy_n(field.samples.row(j), field.grid.nx, out.samples.row(j + margin) + margin);
  }
  fft_2d(out.samples.values.data(), grid.ny, grid.nx, FftDirection::forward);
  const std::vector<char> columns = bins_inside(grid.nx, grid.width(), 1, filter.u0, filter.half_u);
  const std::vector<char> rows = bins_inside(grid.ny, grid.height(), -1, filter.v0, filter.half_v);  // y is up
  parallel_for(0, grid.ny, [&](int64_t j) {
    std::complex<float>* sample = out.samples.row(int(j));
    for (int i = 0; i < grid.nx; ++i)
      if (!rows[size_t(j)] || !columns[size_t(i)]) sample[i] = 0;
  });
  fft_2d(out.samples.values.data(), grid.ny, grid.nx, FftDirection::backward);

  const auto along_x = carrier(grid.nx, filter.u0, [&](int i) { return grid.x(i); });
  const auto along_y = carrier(grid.ny, filter.v0, [&](int j) { return grid.y(j); });
  const double scale = 1 / double(grid.pixels());
  parallel_for(0, grid.ny, [&](int64_t j) {
    std::complex<float>* sample = out.samples.row(int(j));
    for (int i = 0; i < grid.nx; ++i) sample[i] *= std::complex<float>(scale * along_x[size_t(i)] * along_y[size_t(j)]);
  });
  const double before = power(field);
  observer.fact("filter_power", Fact(before > 0 ? power(out) / before : 0.0));
  return out;
}

}  // namespace holotrace
