#include "holotrace/view/order_stop.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
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
Band band_of(int n, double side, double centre, double half) {
  Band band{n};
  for (int k = -(n / 2); k < (n + 1) / 2; ++k) {
    if (std::abs(k / side - centre) > half * (1 + 1e-9)) continue;
    if (band.count == 0) band.first = k;
    ++band.count;
  }
  return band;
}

// exp(−2πi·f·x) along one axis; the phase is reduced to a fraction of a cycle in double.
template <class Position>
std::vector<std::complex<double>> carrier(int n, double f, const Position& position) {
  std::vector<std::complex<double>> wave(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) wave[size_t(i)] = cis_cycles(-f * position(i));
  return wave;
}

// A stop and what it does to light on a grid.
struct Stop {
  Grid grid;                                           // with the margin on each side
  Band x, y;                                           // frequencies that pass, in the order of bins
  std::vector<std::complex<double>> along_x, along_y;  // carriers, by which the light is multiplied

  Stop(const Grid& shown, const SpectralFilter& filter, int margin) : grid(with_margin(shown, margin)) {
    check_grid(shown);
    check_filter(filter, shown);
    require(margin >= 0, "expected a margin of 0 samples or more beside a window, got {}", margin);
    x = band_of(grid.nx, grid.width(), filter.u0, filter.half_u);
    y = band_of(grid.ny, grid.height(), -filter.v0, filter.half_v);  // rows of the spectrum run against y
    along_x = carrier(grid.nx, filter.u0, [&](int i) { return grid.x(i); });
    along_y = carrier(grid.ny, filter.v0, [&](int j) { return grid.y(j); });
  }
  static Grid with_margin(Grid grid, int margin) {
    grid.nx += 2 * margin;
    grid.ny += 2 * margin;
    return grid;
  }
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

}  // namespace

int order_stop_margin(const SpectralFilter& filter, const Grid& grid) {
  const double width = 1 / (2 * std::min(filter.half_u, filter.half_v) * grid.pitch);
  return int(std::min(std::ceil(32 * width), double(largest_order_stop_margin(grid))));
}

Field apply_order_stop(const Field& field, const SpectralFilter& filter, int margin, const Observer& observer) {
  const Stop stop(field.grid, filter, margin);
  const Grid& grid = stop.grid;
  Field out = head_behind(field, grid);
  if (margin > 0) {
    out.samples = Array2D<std::complex<float>>(grid.ny, grid.nx);
    for (int j = 0; j < field.grid.ny; ++j)
      std::copy_n(field.samples.row(j), field.grid.nx, out.samples.row(j + margin) + margin);
  } else {
    out.samples = field.samples;
  }
  fft_2d(out.samples.values.data(), grid.ny, grid.nx, FftDirection::forward);
  parallel_for(0, grid.ny, [&](int64_t j) {
    std::complex<float>* sample = out.samples.row(int(j));
    for (int i = 0; i < grid.nx; ++i)
      if (!stop.y.holds(int(j)) || !stop.x.holds(i)) sample[i] = 0;
  });
  fft_2d(out.samples.values.data(), grid.ny, grid.nx, FftDirection::backward);
  const double scale = 1 / double(grid.pixels());
  parallel_for(0, grid.ny, [&](int64_t j) {
    std::complex<float>* sample = out.samples.row(int(j));
    for (int i = 0; i < grid.nx; ++i)
      sample[i] *= std::complex<float>(scale * stop.along_x[size_t(i)] * stop.along_y[size_t(j)]);
  });
  tell_power(power(field), power(out), observer);
  return out;
}

// Only the columns of the spectrum that pass are transformed.
DeviceField apply_order_stop(const DeviceField& field, const SpectralFilter& filter, int margin,
                             const Observer& observer) {
  const Stop stop(field.head.grid, filter, margin);
  const Grid &from = field.head.grid, &grid = stop.grid;
  Device& device = *field.device;
  const Field head = head_behind(field.head, grid);
  make_room(device, order_stop_cost(from, filter, margin).memory);
  if (stop.x.count == 0 || stop.y.count == 0) {
    Field dark = head;
    dark.samples = Array2D<std::complex<float>>(grid.ny, grid.nx);
    tell_power(1, 0, observer);
    return send(device, dark);
  }
  const auto lock = device.lock();
  DeviceField out = make_device_field(device, head);
  const auto factors = [&](const std::vector<std::complex<float>>& values) { return device.upload(values, "a stop"); };
  const DeviceBuffer along_x = factors(floats(stop.along_x, 1 / double(grid.pixels())));
  const DeviceBuffer along_y = factors(floats(stop.along_y, 1));
  std::vector<std::complex<float>> open(size_t(grid.ny));
  for (int j = 0; j < grid.ny; ++j) open[size_t(j)] = stop.y.holds(j) ? 1 : 0;
  const DeviceBuffer rows_open = factors(open);
  const int columns = stop.x.count;
  const auto make = [&](int rows) {
    return device.make_buffer(size_t(rows) * size_t(columns) * sizeof open[0], "a stop");
  };
  const DeviceBuffer rows = make(grid.ny), by_column = make(from.ny), filtered = make(grid.ny);
  LineTransforms lines(device);
  lines.run({grid.nx, FftDirection::forward, {from.nx, margin}, {columns, stop.x.first}}, from.ny, field.samples, rows);
  lines.transpose(from.ny, columns, rows, by_column);
  lines.run({grid.ny, FftDirection::forward, {from.ny, margin}, {grid.ny, 0, {&along_y}}, {&rows_open}}, columns,
            by_column, filtered);
  lines.transpose(columns, grid.ny, filtered, rows);
  lines.run({grid.nx, FftDirection::backward, {columns, stop.x.first}, {grid.nx, 0, {&along_x}}}, grid.ny, rows,
            out.samples);
  device.finish();
  tell_power(power(field), power(out), observer);
  return out;
}

OrderStopCost order_stop_cost(const Grid& shown, const SpectralFilter& filter, int margin) {
  const Stop stop(shown, filter, margin);
  const double nx = stop.grid.nx, ny = stop.grid.ny, columns = stop.x.count;
  OrderStopCost cost;
  cost.on_processor.fft_operations = 2 * (ny * fft_operations(nx) + nx * fft_operations(ny));
  cost.on_processor.samples = 4 * nx * ny;
  const double ends = double(shown.pixels()) + nx * ny;  // read or written by the transforms of rows
  cost.moved = sample_bytes * (ends + columns * (4.0 * shown.ny + 4 * ny));
  cost.memory = sample_bytes * (nx * ny + columns * (shown.ny + 2 * ny) + 4 * (nx + ny));
  return cost;
}

}  // namespace holotrace
