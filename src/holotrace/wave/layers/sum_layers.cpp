#include "holotrace/wave/layers/sum_layers.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/layers/layer_spectrum.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

constexpr double raster_tolerance = 1e-6;  // of the angles left out: the precision of floats

// Position of a slice's sample (0, 0) on the panel's raster.
struct Corner {
  int column = 0, row = 0;
};

Corner corner_on(const Grid& panel, const Grid& slice, size_t index) {
  const double column = (slice.x(0) - panel.x(0)) / panel.pitch, row = (panel.y(0) - slice.y(0)) / panel.pitch;
  require(std::abs(slice.pitch / panel.pitch - 1) < 1e-9 && std::abs(column - std::round(column)) < 1e-3 &&
              std::abs(row - std::round(row)) < 1e-3,
          "expected slice {} on the panel's raster, of its pitch {} and whole samples from it, got a pitch of {} and "
          "{:.3f} × {:.3f} samples",
          index, format_length(panel.pitch), format_length(slice.pitch), column, row);
  return {int(std::lround(column)), int(std::lround(row))};
}

// The samples of a slice in the window, with the axial phase of the way to the panel.
SliceSamples on_window(const Field& light, Corner corner, int nx, int ny) {
  SliceSamples s{nx, ny, {}, {}};
  std::vector<int> place(size_t(ny), -1);
  for (int j = 0; j < light.grid.ny; ++j) {
    int& at = place[size_t(wrapped(corner.row + j, ny))];
    if (at >= 0) continue;
    at = int(s.rows.size());
    s.rows.push_back(wrapped(corner.row + j, ny));
  }
  s.values = Array2D<Complex>(int(s.rows.size()), nx);
  const Complex axial(cis_cycles(cycle_fraction(-light.z, light.wavelength)));
  for (int j = 0; j < light.grid.ny; ++j) {
    Complex* row = s.values.row(place[size_t(wrapped(corner.row + j, ny))]);
    for (int i = 0; i < light.grid.nx; ++i) row[wrapped(corner.column + i, nx)] += axial * light.samples(j, i);
  }
  return s;
}

double farthest(const Grid& panel, const Grid& slice, bool along_y) {
  const double offset = along_y ? slice.centre_y - panel.centre_y : slice.centre_x - panel.centre_x;
  return std::abs(offset) + (along_y ? slice.height() : slice.width()) / 2;
}

std::vector<PlannedSlice> plan_rasters(const SliceStack& stack, const Grid& panel) {
  double most_x = panel.width() / 2, most_y = panel.height() / 2;  // of all that the light meets on its way
  if (stack.has_masks)
    for (const Grid& grid : stack.grids) {
      most_x = std::max(most_x, farthest(panel, grid, false));
      most_y = std::max(most_y, farthest(panel, grid, true));
    }
  std::vector<PlannedSlice> planned;
  const double steepness = taper_steepness(raster_tolerance);
  const double cone = stack.cone_wavelength > 0 ? stack.cone_wavelength : stack.wavelength;
  for (size_t m = 0; m < stack.depths.size(); ++m) {
    const double distance = std::abs(stack.depths[m]), radius = box_radius(distance, cone, panel.pitch);
    PlannedSlice s{stack.depths[m],
                   farthest(panel, stack.grids[m], false) + most_x,
                   farthest(panel, stack.grids[m], true) + most_y,
                   {},
                   {}};
    s.x = taper_of_raster({distance, stack.wavelength, panel.pitch, s.span_x, radius, steepness, stack.has_masks});
    s.y = taper_of_raster({distance, stack.wavelength, panel.pitch, s.span_y, radius, steepness, stack.has_masks});
    planned.push_back(s);
  }
  return planned;
}

void check_memory(const LayerWindow& w, const Grid& panel, double slice_samples, bool is_carried) {
  const double half = 8 * (2.0 * w.reach_x + 1) * (is_carried ? w.ny : panel.ny);
  const double whole = is_carried ? 8.0 * w.nx * w.ny : 0;
  require_memory(
      layer_spectrum_bytes(w.reach_x, w.reach_y) + half + whole + 8 * slice_samples + 8.0 * double(panel.pixels()),
      fmt::format("slices of space on a window of {} × {} samples", w.nx, w.ny));
}

}  // namespace

Field sum_layers(const SliceStack& stack, const Grid& grid, const Observer& observer) {
  check_grid(grid);
  check_wavelength(stack.wavelength, grid);
  check_cone(stack.cone_wavelength, stack.wavelength);
  require(!stack.depths.empty() && stack.grids.size() == stack.depths.size(),
          "expected at least one slice, with a grid for each, got {} depths and {} grids", stack.depths.size(),
          stack.grids.size());
  require(!stack.has_masks || 2 * grid.pitch > stack.wavelength,
          "expected a pitch above half a wavelength for silhouettes, got {} at {}", format_length(grid.pitch),
          format_length(stack.wavelength));
  const std::vector<PlannedSlice> planned = plan_rasters(stack, grid);
  const LayerWindow window = plan_window(planned, grid, stack.wavelength);
  double samples = 0;
  for (const Grid& g : stack.grids) samples = std::max(samples, double(g.pixels()) + double(g.ny) * window.nx);
  check_memory(window, grid, samples, stack.has_masks);
  observer.fact("slices", stack.depths.size());
  observer.fact("window", fmt::format("{}x{}", window.nx, window.ny));

  LayerSpectrum spectrum =
      make_layer_spectrum(grid, stack.wavelength, window.nx, window.ny, window.reach_x, window.reach_y);
  const double steepness = taper_steepness(raster_tolerance), scale = stack.scale / (double(window.nx) * window.ny);
  const auto weights = [&](const Taper& taper, double depth, int n, int reach) {
    return taper_weights(taper, depth, stack.wavelength, n * grid.pitch, steepness, std::min(n / 2, reach) + 1);
  };
  for (size_t m = 0; m < stack.depths.size(); ++m) {
    const Slice slice = stack.make(m);
    const Corner corner = corner_on(grid, slice.light.grid, m);
    const PlannedSlice& p = planned[m];
    const AxisWeights x = weights(p.x, p.depth, window.nx, window.reach_x);
    const AxisWeights y = weights(p.y, p.depth, window.ny, window.reach_y);
    if (stack.has_masks && m > 0) {
      carry(spectrum, stack.depths[m - 1] - stack.depths[m]);
      if (std::any_of(slice.mask.values.begin(), slice.mask.values.end(), [](float v) { return v > 0; }))
        hide(spectrum, slice.mask, corner.column, corner.row, x, y);
    }
    add_light(spectrum, on_window(slice.light, corner, window.nx, window.ny), x, y,
              {stack.has_masks ? 0 : p.depth, scale, false});
    observer.progress(double(m + 1) / double(stack.depths.size() + 1));
  }
  if (stack.has_masks) carry(spectrum, stack.depths.back());
  Field field(grid, stack.wavelength);
  field.label.cone_wavelength = stack.cone_wavelength;
  field.samples = samples_of(spectrum, grid.nx, grid.ny);
  observer.progress(1);
  return field;
}

Field sum_layers(const Layers& layers, const Grid& grid, const Observer& observer) {
  check_layers(layers);
  SliceStack stack{
      .wavelength = layers.wavelength, .depths = {}, .grids = {}, .make = [&](size_t m) { return layers.slices[m]; }};
  for (const Slice& slice : layers.slices) {
    stack.depths.push_back(slice.depth());
    stack.grids.push_back(slice.light.grid);
    stack.has_masks = stack.has_masks || slice.mask.size() > 0;
  }
  return sum_layers(stack, grid, observer);
}

}  // namespace holotrace
