#include "holotrace/slm/encode/banded_field.h"

#include <algorithm>

#include "holotrace/slm/encode/device_moments.h"
#include "holotrace/slm/encode/frequency_band.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/stop.h"

namespace holotrace {

EncodeBands encode_bands(const EncodeParams& params, const Grid& grid, double wavelength, double memory,
                         double largest) {
  constexpr double sample = sizeof(std::complex<float>), level = sizeof(uint16_t);
  const double nx = grid.nx, ny = grid.ny, sums = 16;  // of a row
  const auto stop = stop_of(params, grid, wavelength);
  const double passing = stop ? pass_band(grid, *stop).x.count : 0;
  // Scales or a reference wave, and roots of unity along both axes; counts of moduli.
  const double counts = params.method == Encoding::double_phase ? sizeof(uint32_t) * (modulus_steps + 1) : 0,
               tables = stop ? sample * 2 * (nx + ny) + counts : 0;
  const double space = (stop ? 0.5 : 1) * memory - tables;
  const auto at_most = [](double a, double b, double all) { return int(std::clamp(std::min(a, b), 0.0, all)); };
  EncodeBands bands;
  bands.rows =
      at_most(space / (sample * nx + std::max(level * nx, sample * passing) + sums), largest / (sample * nx), ny);
  if (bands.rows < grid.ny) bands.rows -= bands.rows % 2;
  bands.columns = stop ? at_most(space / (2 * sample * ny + sums), largest / (sample * ny), passing) : 1;
  return bands;
}

void for_each_band(const BandedField& field, const std::function<void(DeviceField& band, int first)>& work) {
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
