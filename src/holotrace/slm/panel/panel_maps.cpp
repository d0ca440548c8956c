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
std::vector<float> stuck_levels(const std::vector<StuckPixel>& stuck, const Grid& pixels, const PixelRows& rows,
                                double scale) {
  const int64_t nx = pixels.nx, ny = pixels.ny, count = rows.count + 2 * rows.halo;
  std::vector<float> levels(size_t(nx * count), -1);
  for (const StuckPixel& one : stuck) {
    // Its places in the rows from `first − halo` on: more than one if these are more than the panel has.
    int64_t row = (one.pixel / nx - (rows.first - rows.halo)) % ny;
    if (row < 0) row += ny;
    for (; row < count; row += ny) levels[size_t(row * nx + one.pixel % nx)] = float(one.level * scale);
  }
  return levels;
}

// A box of an array that has values.
DeviceBuffer upload_box(Device& device, const Array2D<Complex>& values, const PixelBox& box) {
  if (values.size() == 0) return {};
  std::vector<Complex> part;
  part.reserve(size_t(box.pixels()));
  for (int j = box.y0; j < box.y1; ++j) part.insert(part.end(), values.row(j) + box.x0, values.row(j) + box.x1);
  return device.upload(part, "a panel");
}

}  // namespace

PixelMaps DevicePanel::pixel_maps(Device& device, const PanelModel& model, const PixelRows& rows) {
  const PanelModel::Parts& parts = *model.parts_;
  const double of_phase = double(parts.levels) / parts.slm.levels,
               of_amplitude = (parts.levels - 1.0) / (parts.slm.levels - 1.0);
  const bool is_amplitude = parts.modulation == Modulation::amplitude;
  PixelMaps maps;
  const auto stuck = [&](double scale) {
    return device.upload(stuck_levels(parts.stuck, parts.slm.grid, rows, scale), "a panel");
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

double DevicePanel::bytes_of_pixel_maps(const PanelModel& model) {
  const PanelModel::Parts& parts = *model.parts_;
  const double of_stuck = parts.stuck.empty() ? 0 : parts.modulation == Modulation::complex ? 8 : 4;
  return of_stuck + (parts.static_errors.size() > 0 ? 8 : 0);
}

double DevicePanel::bytes_of_sample_maps(const PanelModel& model) {
  const PanelModel::Parts& parts = *model.parts_;
  return (parts.gap_field.size() > 0 ? 8 : 0) + (parts.light.samples.size() > 0 ? 8 : 0);
}

}  // namespace holotrace
