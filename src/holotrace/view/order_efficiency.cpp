#include "holotrace/view/order_efficiency.h"

#include <cmath>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

// The cells that a frequency belongs to: twice the same one, or two that each get half of it.
struct Cells {
  int first, second;
};

// The cells of every bin, for n·pixels samples and cells `pixels` bins wide. For an even number of samples the Nyquist
// bin stands for both signs, so it belongs to both outermost cells.
std::vector<Cells> cells_of(int pixels, int n) {
  const int samples = n * pixels;
  std::vector<Cells> cells;
  for (int k = 0; k < samples; ++k) {
    const int twice = 2 * signed_frequency(k, samples) + samples;  // distance from the lower border, in half bins
    const int cell = twice / (2 * pixels);
    cells.push_back(twice == 0 ? Cells{0, n - 1} : Cells{twice % (2 * pixels) == 0 ? cell - 1 : cell, cell});
  }
  return cells;
}

int samples_per_pixel(const Field& shown, double pitch) { return int(std::lround(pitch / shown.grid.pitch)); }

bool is_whole(const Field& shown, double pitch, int n) {
  return n >= 1 && shown.grid.nx % n == 0 && shown.grid.ny % n == 0 &&
         std::abs(n * shown.grid.pitch / pitch - 1) < 1e-9;
}

}  // namespace

bool has_orders(const Field& shown, double pitch) {
  const int n = samples_per_pixel(shown, pitch);
  return n > 1 && n % 2 == 1 && is_whole(shown, pitch, n);
}

std::vector<OrderPower> order_powers(const Field& shown, double pitch) {
  check_grid(shown.grid);
  const int n = samples_per_pixel(shown, pitch);
  require(
      n % 2 == 1 && is_whole(shown, pitch, n),
      "expected an odd number of samples per pixel, whose orders are whole, got samples of {} on pixels of {}; show "
      "the hologram with 3 subpixels",
      format_length(shown.grid.pitch), format_length(pitch));
  const int nx = shown.grid.nx, ny = shown.grid.ny;
  auto spectrum = shown.samples;
  fft_2d(spectrum.values.data(), ny, nx, FftDirection::forward);
  const std::vector<Cells> columns = cells_of(nx / n, n), rows = cells_of(ny / n, n);
  Array2D<double> of_rows(ny, n);  // light in each row of the spectrum, by cell
  parallel_for(0, ny, [&](int64_t j) {
    const std::complex<float>* u = spectrum.row(int(j));
    for (int i = 0; i < nx; ++i) {
      const double half = std::norm(std::complex<double>(u[i])) / 2;
      of_rows(int(j), columns[size_t(i)].first) += half;
      of_rows(int(j), columns[size_t(i)].second) += half;
    }
  });
  const int outermost = (n - 1) / 2;
  std::vector<OrderPower> orders;
  for (int j = -outermost; j <= outermost; ++j)
    for (int i = -outermost; i <= outermost; ++i) orders.push_back({i, j, 0});
  const double scale = shown.grid.pitch * shown.grid.pitch / double(shown.grid.pixels());  // by Parseval's theorem
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < n; ++i)
      for (const int row : {rows[size_t(j)].first, rows[size_t(j)].second})  // rows of the spectrum run against y
        orders[size_t((n - 1 - row) * n + i)].power += scale / 2 * of_rows(j, i);
  return orders;
}

}  // namespace holotrace
