#include "holotrace/slm/encode/banded_samples.h"

#include <algorithm>

#include "holotrace/slm/encode/device_moments.h"
#include "holotrace/slm/encode/frequency_band.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/stop.h"

namespace holotrace {

namespace {

constexpr double sample_bytes = sizeof(std::complex<float>), level_bytes = sizeof(uint16_t);

// What rows and columns take on a device, and the part of its memory that they may have.
struct BandBytes {
  double tables = 0, row = 0, column = 0, part = 1;
  double columns = 1;  // that pass the stop
};

BandBytes band_bytes(const EncodeParams& params, const Grid& grid, double wavelength) {
  BandBytes bytes;
  const auto stop = stop_of(params, grid, wavelength);
  bytes.tables = encode_table_bytes(params, grid, wavelength);
  bytes.row = bytes_of_row_sums + (sample_bytes + level_bytes) * grid.nx;
  if (!stop) return bytes;
  bytes.part = 0.5;
  bytes.columns = pass_band(grid, *stop).x.count;
  bytes.row = std::max(bytes.row, bytes_of_row_sums + sample_bytes * (grid.nx + bytes.columns));
  bytes.column = bytes_of_row_sums + 2 * sample_bytes * grid.ny;
  return bytes;
}

}  // namespace

double encode_table_bytes(const EncodeParams& params, const Grid& grid, double wavelength) {
  if (!stop_of(params, grid, wavelength)) return 0;
  const double counts = params.method == Encoding::double_phase ? sizeof(uint32_t) * (modulus_steps + 1) : 0;
  return counts + sample_bytes * (2.0 * (grid.nx + grid.ny) + 2.0 * std::max(grid.nx, grid.ny));
}

EncodeBands encode_bands(const EncodeParams& params, const Grid& grid, double wavelength, double memory,
                         double largest) {
  const BandBytes bytes = band_bytes(params, grid, wavelength);
  const double space = bytes.part * memory - bytes.tables;
  const auto at_most = [](double a, double b, double all) { return int(std::clamp(std::min(a, b), 0.0, all)); };
  EncodeBands bands;
  bands.rows = at_most(space / bytes.row, largest / (sample_bytes * grid.nx), grid.ny);
  if (bands.rows < grid.ny) bands.rows -= bands.rows % 2;
  bands.columns =
      bytes.column > 0 ? at_most(space / bytes.column, largest / (sample_bytes * grid.ny), bytes.columns) : 1;
  return bands;
}

double least_encode_memory(const EncodeParams& params, const Grid& grid, double wavelength) {
  const BandBytes bytes = band_bytes(params, grid, wavelength);
  return (bytes.tables + std::max(std::min(2, grid.ny) * bytes.row, bytes.column)) / bytes.part;
}

void for_each_band(const BandedSamples& field, const std::function<void(DeviceField& band, int first)>& work) {
  const auto lock = field.device->lock();
  const int ny = field.field->grid.ny;
  for (int first = 0; first < ny; first += field.bands.rows) {
    Field head = head_of(*field.field);
    head.grid.ny = std::min(field.bands.rows, ny - first);
    DeviceField band = make_device_field(*field.device, std::move(head), "rows of a field");
    field.device->write(band.samples, field.field->samples.row(first), band.samples.bytes());
    if (field.top) clip_moduli(band, *field.top);
    work(band, first);
  }
}

}  // namespace holotrace
