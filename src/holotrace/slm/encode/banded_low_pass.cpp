#include "holotrace/slm/encode/banded_low_pass.h"

#include <algorithm>
#include <complex>
#include <memory>
#include <utility>
#include <vector>

#include "holotrace/slm/encode/low_pass_lines.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

// The spectrum of a field's rows within a stop, times `unit`: row by row, on the processor.
struct RowSpectra {
  const Grid grid;
  const PassBand pass;
  float unit = 1;
  Array2D<Complex> rows;
};

RowSpectra spectra_of_rows(const ShownPixels<BandedSamples>& shown, const SpectralFilter& stop, LineTransforms& lines) {
  Device& device = *shown.field.device;
  const Grid& grid = grid_of(shown.field);
  RowSpectra spectra{grid, pass_band(grid, stop), unit_for(shown.moments.largest), {}};
  spectra.rows = Array2D<Complex>(grid.ny, spectra.pass.x.count);
  const DeviceBuffer scales = device.upload(std::vector<Complex>(size_t(grid.nx), spectra.unit), "a stop");
  for_each_band(shown.field, [&](const DeviceField& band, int first) {
    const int rows = band.head.grid.ny;
    const DeviceBuffer there = device.make_buffer(size_t(rows) * size_t(spectra.rows.nx) * sizeof(Complex), "a stop");
    lines.run(rows_to_spectrum(grid, spectra.pass, scales), rows, band.samples, there);
    device.read(there, spectra.rows.row(first), there.bytes());
  });
  return spectra;
}

// Copies columns of a matrix into a matrix of their own, or back.
void take_columns(const Array2D<Complex>& from, int first, int count, std::vector<Complex>& to) {
  for (int j = 0; j < from.ny; ++j) std::copy_n(from.row(j) + first, count, to.begin() + int64_t(j) * count);
}
void put_columns(const std::vector<Complex>& from, int first, int count, Array2D<Complex>& to) {
  for (int j = 0; j < to.ny; ++j) std::copy_n(from.begin() + int64_t(j) * count, count, to.row(j) + first);
}

// Transforms the columns, as many at a time as fit: to their frequencies, of which those within the stop remain, and, if they
// are to return, back. Returns Σ|bin|² within the stop.
double pass_columns(const BandedSamples& field, LineTransforms& lines, bool return_them, RowSpectra& spectra) {
  Device& device = *field.device;
  const Grid& grid = spectra.grid;
  const PassBand& pass = spectra.pass;
  const int most = field.bands.columns;
  const auto make = [&] { return device.make_buffer(size_t(most) * size_t(grid.ny) * sizeof(Complex), "a stop"); };
  DeviceField bins{&device, {}, make()};
  const DeviceBuffer turned = make();
  std::vector<Complex> here;
  double inside = 0;
  for (int first = 0; first < pass.x.count; first += most) {
    const int count = std::min(most, pass.x.count - first);
    here.resize(size_t(count) * size_t(grid.ny));
    take_columns(spectra.rows, first, count, here);
    device.write(bins.samples, here.data(), here.size() * sizeof(Complex));
    lines.transpose(grid.ny, count, bins.samples, turned);
    lines.run(columns_to_spectrum(grid, pass), count, turned, bins.samples);
    bins.head.grid.nx = pass.y.count;
    bins.head.grid.ny = count;
    inside += energy(bins, {0, pass.y.count, 0, count});
    if (!return_them) continue;
    lines.run(columns_from_spectrum(grid, pass), count, bins.samples, turned);
    lines.transpose(count, grid.ny, turned, bins.samples);
    device.read(bins.samples, here.data(), here.size() * sizeof(Complex));
    put_columns(here, first, count, spectra.rows);
  }
  return inside;
}

}  // namespace

Scaled<BandedSamples> within_stop(const ShownPixels<BandedSamples>& shown, const SpectralFilter& stop,
                                  const Observer& observer) {
  Device& device = *shown.field.device;
  const auto lock = device.lock();
  LineTransforms lines(device);
  RowSpectra spectra = spectra_of_rows(shown, stop, lines);
  const Grid& grid = spectra.grid;
  const double unit = double(spectra.unit), inside = pass_columns(shown.field, lines, true, spectra);
  observer.fact("band_power", Fact(part_of_power(inside, shown.moments, unit, grid)));
  const auto light = std::make_shared<Field>(head_of(*shown.field.field));
  light->samples = Array2D<Complex>(grid.ny, grid.nx);
  for (int first = 0; first < grid.ny; first += shown.field.bands.rows) {
    const size_t rows = size_t(std::min(shown.field.bands.rows, grid.ny - first));
    const DeviceBuffer from = device.make_buffer(rows * size_t(spectra.rows.nx) * sizeof(Complex), "a stop"),
                       to = device.make_buffer(rows * size_t(grid.nx) * sizeof(Complex), "rows of a field");
    device.write(from, spectra.rows.row(first), from.bytes());
    lines.run(rows_from_spectrum(grid, spectra.pass), int(rows), from, to);
    device.read(to, light->samples.row(first), to.bytes());
  }
  return {{&device, light, shown.field.bands}, unit * double(grid.pixels())};
}

double power_inside(const ShownPixels<BandedSamples>& shown, const SpectralFilter& filter) {
  const auto lock = shown.field.device->lock();
  LineTransforms lines(*shown.field.device);
  RowSpectra spectra = spectra_of_rows(shown, filter, lines);
  const double inside = pass_columns(shown.field, lines, false, spectra);
  return part_of_power(inside, shown.moments, double(spectra.unit), spectra.grid);
}

}  // namespace holotrace
