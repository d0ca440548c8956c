// What a panel has for each of its pixels and for each sample of its light, on a device.

#include <algorithm>
#include <complex>
#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/slm/panel/device_panel.h"
#include "holotrace/slm/panel/panel_parts.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

// The levels of the dead pixels of some rows and their halo, of a panel that is taken as periodic; −1 for all others.
void write_stuck_levels(const std::vector<StuckPixel>& stuck, const Grid& pixels, const PixelRows& rows, double scale,
                        float* levels) {
  const int64_t nx = pixels.nx, ny = pixels.ny, count = rows.count + 2 * rows.halo;
  std::fill_n(levels, nx * count, -1.0F);
  for (const StuckPixel& one : stuck) {
    // Its places in the rows from `first − halo` on: more than one if these are more than the panel has.
    int64_t row = (one.pixel / nx - (rows.first - rows.halo)) % ny;
    if (row < 0) row += ny;
    for (; row < count; row += ny) levels[row * nx + one.pixel % nx] = float(one.level * scale);
  }
}

// A box of an array that has values.
DeviceBuffer upload_box(Device& device, const Array2D<Complex>& values, const PixelBox& box) {
  if (values.size() == 0) return {};
  return device.upload<Complex>(size_t(box.pixels()), "a panel", [&](Complex* to) {
    for (int j = box.y0; j < box.y1; ++j) to = std::copy(values.row(j) + box.x0, values.row(j) + box.x1, to);
  });
}

}  // namespace

PixelMaps DevicePanel::pixel_maps(Device& device, const PanelModel& model, const PixelRows& rows) {
  const PanelModel::Parts& parts = *model.parts_;
  const double of_phase = double(parts.levels) / parts.slm.levels,
               of_amplitude = (parts.levels - 1.0) / (parts.slm.levels - 1.0);
  const bool is_amplitude = parts.modulation == Modulation::amplitude;
  PixelMaps maps;
  const auto stuck = [&](double scale) {
    const size_t count = size_t(parts.nx()) * size_t(rows.count + 2 * rows.halo);
    return device.upload<float>(
        count, "a panel", [&](float* levels) { write_stuck_levels(parts.stuck, parts.slm.grid, rows, scale, levels); });
  };
  if (!parts.stuck.empty()) {
    maps.stuck = stuck(is_amplitude ? of_amplitude : of_phase);
    if (parts.modulation == Modulation::complex) maps.stuck_moduli = stuck(of_amplitude);
  }
  maps.static_errors = upload_box(device, parts.static_errors, {0, parts.nx(), rows.first, rows.first + rows.count});
  return maps;
}

SampleMaps DevicePanel::sample_maps(Device& device, const PanelModel& model, const SampleColumns& columns) {
  const PanelModel::Parts& parts = *model.parts_;
  const PixelBox box{columns.first, columns.first + columns.count, 0, parts.out.ny};
  return {upload_box(device, parts.gap_field, box), upload_box(device, parts.light.samples, box)};
}

}  // namespace holotrace
