#include "holotrace/view/diffraction_orders.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "holotrace/wave/transform/line_transform.h"

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

// The frequencies of an axis within a band: `count` signed ones from `first` on, of a transform of n samples.
struct Band {
  int n = 0, first = 0, count = 0;

  bool holds(int bin) const {
    const int k = signed_frequency(bin, n);
    return k >= first && k < first + count;
  }
};

// An edge that falls on a bin counts as inside.
Band band_of(int n, double pitch, double centre, double half) {
  Band band{n};
  for (int k = -(n / 2); k < (n + 1) / 2; ++k) {
    if (std::abs(k / (n * pitch) - centre) > half * (1 + 1e-9)) continue;
    if (band.count == 0) band.first = k;
    ++band.count;
  }
  return band;
}

// A stop for light on a grid: the window behind it, with the margin on each side, and the frequencies that pass, in the
// order of the bins of a period. The period begins with the window.
struct Stop {
  Grid from, window;
  int margin;
  Band x, y;

  Stop(const Grid& shown, const SpectralFilter& filter, int margin) : from(shown), window(shown), margin(margin) {
    check_grid(shown);
    check_filter(filter, shown);
    require(margin >= 0, "expected a margin of 0 samples or more beside a window, got {}", margin);
    window.nx += 2 * margin;
    window.ny += 2 * margin;
    const auto period = [&](int side) { return margin > 0 ? fft_good_length(side) : side; };
    x = band_of(period(window.nx), shown.pitch, filter.u0, filter.half_u);
    y = band_of(period(window.ny), shown.pitch, -filter.v0, filter.half_v);  // rows of the spectrum run against y
  }
  bool is_closed() const { return x.count == 0 || y.count == 0; }
  double samples_of_period() const { return double(x.n) * y.n; }
};

// exp(−2πi·f·x) along one axis; the phase is reduced to a fraction of a cycle in double.
template <class Position>
std::vector<std::complex<double>> carrier(int n, double f, const Position& position) {
  std::vector<std::complex<double>> wave(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) wave[size_t(i)] = cis_cycles(-f * position(i));
  return wave;
}

// The carriers by which the light is multiplied behind a stop.
struct Carriers {
  std::vector<std::complex<double>> x, y;

  Carriers(const Grid& window, const SpectralFilter& filter)
      : x(carrier(window.nx, filter.u0, [&](int i) { return window.x(i); })),
        y(carrier(window.ny, filter.v0, [&](int j) { return window.y(j); })) {}
};

// The light behind a stop, on its window, but for the samples.
Field head_behind(const Field& field, const Grid& grid) {
  Field head = head_of(field);
  head.filter.reset();
  head.grid = grid;
  return head;
}

void tell_power(double before, double behind, const Observer& observer) {
  observer.fact("filter_power", Fact(before > 0 ? behind / before : 0.0));
}

std::vector<std::complex<float>> floats(const std::vector<std::complex<double>>& factors, double scale) {
  std::vector<std::complex<float>> values;
  for (const std::complex<double>& factor : factors) values.emplace_back(scale * factor);
  return values;
}

constexpr double sample_bytes = sizeof(std::complex<float>);

// Only the columns of the spectrum that pass are transformed.
DeviceField behind_stop(const DeviceField& field, const SpectralFilter& filter, int margin, const Observer& observer) {
  const Stop stop(field.head.grid, filter, margin);
  const Grid &from = stop.from, &window = stop.window;
  Device& device = *field.device;
  DeviceField out = make_device_field(device, head_behind(field.head, window));
  if (stop.is_closed()) {
    clear(out);
    tell_power(1, 0, observer);
    return out;
  }
  const auto factors = [&](const std::vector<std::complex<float>>& values) { return device.upload(values, "a stop"); };
  const Carriers carriers(window, filter);
  const DeviceBuffer along_x = factors(floats(carriers.x, 1 / stop.samples_of_period()));
  const DeviceBuffer along_y = factors(floats(carriers.y, 1));
  std::vector<std::complex<float>> open(size_t(stop.y.n));
  for (int j = 0; j < stop.y.n; ++j) open[size_t(j)] = stop.y.holds(j) ? 1 : 0;
  const DeviceBuffer rows_open = factors(open);
  const int columns = stop.x.count;
  const auto make = [&](int rows) {
    return device.make_buffer(size_t(rows) * size_t(columns) * sizeof open[0], "a stop");
  };
  const DeviceBuffer rows = make(window.ny), by_column = make(from.ny), filtered = make(window.ny);
  LineTransforms lines(device);
  lines.run({stop.x.n, FftDirection::forward, {from.nx, margin}, {columns, stop.x.first}}, from.ny, field.samples,
            rows);
  lines.transpose(from.ny, columns, rows, by_column);
  lines.run({stop.y.n, FftDirection::forward, {from.ny, margin}, {window.ny, 0, {&along_y}}, {&rows_open}}, columns,
            by_column, filtered);
  lines.transpose(columns, window.ny, filtered, rows);
  lines.run({stop.x.n, FftDirection::backward, {columns, stop.x.first}, {window.nx, 0, {&along_x}}}, window.ny, rows,
            out.samples);
  device.finish();
  tell_power(power(field), power(out), observer);
  return out;
}

}  // namespace

int order_stop_margin(const SpectralFilter& filter, const Grid& grid) {
  const double width = 1 / (2 * std::min(filter.half_u, filter.half_v) * grid.pitch);
  return int(std::min(std::ceil(32 * width), double(largest_order_stop_margin(grid))));
}

Field apply_order_stop(const Field& field, const SpectralFilter& filter, int margin, const Observer& observer) {
  const Stop stop(field.grid, filter, margin);
  const Carriers carriers(stop.window, filter);
  const int nx = stop.x.n, ny = stop.y.n;
  Array2D<std::complex<float>> period(ny, nx);
  for (int j = 0; j < field.grid.ny; ++j)
    std::copy_n(field.samples.row(j), field.grid.nx, period.row(j + margin) + margin);
  fft_2d(period.values.data(), ny, nx, FftDirection::forward);
  parallel_for(0, ny, [&](int64_t j) {
    std::complex<float>* sample = period.row(int(j));
    for (int i = 0; i < nx; ++i)
      if (!stop.y.holds(int(j)) || !stop.x.holds(i)) sample[i] = 0;
  });
  fft_2d(period.values.data(), ny, nx, FftDirection::backward);
  Field out = head_behind(field, stop.window);
  out.samples = Array2D<std::complex<float>>(out.grid.ny, out.grid.nx);
  const double scale = 1 / stop.samples_of_period();
  parallel_for(0, out.grid.ny, [&](int64_t j) {
    const std::complex<float>* sample = period.row(int(j));
    std::complex<float>* behind = out.samples.row(int(j));
    for (int i = 0; i < out.grid.nx; ++i)
      behind[i] = sample[i] * std::complex<float>(scale * carriers.x[size_t(i)] * carriers.y[size_t(j)]);
  });
  tell_power(power(field), power(out), observer);
  return out;
}

OrderStopCost order_stop_cost(const Grid& grid, const SpectralFilter& filter, int margin) {
  const Stop stop(grid, filter, margin);
  const double nx = stop.x.n, ny = stop.y.n;
  OrderStopCost cost;
  cost.work.fft_operations = 2 * (ny * fft_operations(nx) + nx * fft_operations(ny));
  cost.work.samples = 4 * nx * ny;
  cost.memory = sample_bytes * (nx * ny + double(stop.window.pixels()));
  return cost;
}

DeviceUse forecast_order_stop(const Device& device, const Grid& grid, const SpectralFilter& filter, int margin) {
  Device counter(device.info(), device.memory());
  Field head;
  head.grid = grid;
  const DeviceField field = make_device_field(counter, head);
  behind_stop(field, filter, margin, {});
  return counter.use();
}

DeviceField apply_order_stop(const DeviceField& field, const SpectralFilter& filter, int margin,
                             const Observer& observer) {
  const auto lock = field.device->lock();
  const DeviceUse use = forecast_order_stop(*field.device, field.head.grid, filter, margin);
  make_room(*field.device, double(use.most_released()));
  return behind_stop(field, filter, margin, observer);
}

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
