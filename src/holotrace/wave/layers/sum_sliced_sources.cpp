// Layers of waves: sum_layers and make_layers for Sources.

#include <algorithm>
#include <cmath>
#include <utility>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/wave/layers/layer_spectrum.h"
#include "holotrace/wave/layers/points_on_slice.h"
#include "holotrace/wave/layers/slice.h"
#include "holotrace/wave/layers/sum_layers.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

// Shares of the tolerance: moving the depths causes most of the error.
constexpr double slicing_share = 0.8, spread_share = 0.1;

// Everything that is computed before the first slice is summed.
struct Plan {
  SlicedSources sliced;
  std::vector<PlannedSlice> slices;
  LayerWindow window;
  SpreadKernel kernel;
  double steepness = 0;
};

void check_input(const Sources& sources, const Grid& grid, const SynthesizeParams& params) {
  check_grid(grid);
  check_sources(sources);
  require(!has_astigmatic(sources), "expected spherical waves for layers, got astigmatic ones; synthesize takes both");
  check_ranges(params);
  require(sources.tiles.columns == 0,
          "expected waves of one amplitude for the whole panel for the method layers, got amplitudes for {} × "
          "{} tiles; use the strategy shared, or the method tiled",
          sources.tiles.columns, sources.tiles.rows);
  require(!params.has_silhouettes || 2 * grid.pitch > sources.wavelength,
          "expected a pitch above half a wavelength for silhouettes, got {} at {}", format_length(grid.pitch),
          format_length(sources.wavelength));
}

std::vector<PlannedSlice> plan_slices(const DepthSlices& depth, const Sources& sources, const Grid& grid,
                                      double steepness, bool is_carried) {
  std::vector<PlannedSlice> planned;
  double most_x = grid.width() / 2, most_y = grid.height() / 2;
  for (const DepthSlice& slice : depth.slices) {
    PlannedSlice s{slice.depth, 0, 0, {}, {}};
    for (const uint32_t i : slice.members) {
      s.span_x = std::max(s.span_x, std::abs(sources.waves[i].origin.x - grid.centre_x));
      s.span_y = std::max(s.span_y, std::abs(sources.waves[i].origin.y - grid.centre_y));
    }
    if (is_carried) most_x = std::max(most_x, s.span_x), most_y = std::max(most_y, s.span_y);
    planned.push_back(s);
  }
  for (PlannedSlice& s : planned) {
    s.span_x += most_x, s.span_y += most_y;
    const double distance = std::abs(s.depth),
                 radius = box_radius(distance, sources.acceptance_wavelength(), grid.pitch);
    s.x = taper_of_points({distance, sources.wavelength, grid.pitch, s.span_x, radius, steepness, is_carried});
    s.y = taper_of_points({distance, sources.wavelength, grid.pitch, s.span_y, radius, steepness, is_carried});
  }
  return planned;
}

void check_memory(const Plan& plan, const Grid& panel, size_t waves, bool is_carried) {
  const LayerWindow& w = plan.window;
  const double fine = 8.0 * spread_length(w.reach_x, plan.kernel) * spread_length(w.reach_y, plan.kernel);
  const double half = 8 * (2.0 * w.reach_x + 1) * (is_carried ? w.ny : panel.ny);
  const double whole = is_carried ? (8.0 + 4.0) * w.nx * w.ny : 0;
  require_memory(layer_spectrum_bytes(w.reach_x, w.reach_y) + std::max(fine, half + whole) +
                     8.0 * double(panel.pixels()) + double(waves) * (sizeof(PointOnSlice) + 40.0),
                 fmt::format("{} waves in slices on a window of {} × {} samples", waves, w.nx, w.ny));
}

Plan make_plan(const Sources& sources, const Grid& grid, const SynthesizeParams& params, bool keeps_band,
               const Observer& observer) {
  Plan plan;
  plan.sliced = slice_sources(sources, grid, params.slices, slicing_share * params.tolerance);
  const std::vector<DepthSlice>& slices = plan.sliced.depth.slices;
  observer.fact("slices", slices.size());
  observer.fact("slice_thickness_m", plan.sliced.depth.thickness);
  observer.fact("expected_depth_error", plan.sliced.expected_error);
  observer.fact("waves_cut", plan.sliced.cut_waves);
  if (slices.empty()) return plan;
  plan.steepness = taper_steepness(params.tolerance);
  plan.kernel = make_spread_kernel(spread_share * params.tolerance);
  plan.slices = plan_slices(plan.sliced.depth, sources, grid, plan.steepness, keeps_band);
  plan.window = plan_window(plan.slices, grid, sources.wavelength);
  observer.fact("window", fmt::format("{}x{}", plan.window.nx, plan.window.ny));
  check_memory(plan, grid, sources.waves.size(), keeps_band);
  if (params.slices == 0 && slices.size() > many_slices)
    observer.warn(
        fmt::format("a tolerance of {:.1e} needs {} slices, one transform each; set slices to fewer, use a larger "
                    "tolerance, or the method tiled",
                    params.tolerance, slices.size()));
  if (params.slices > 0 && plan.sliced.expected_error > params.tolerance)
    observer.warn(fmt::format(
        "with slices = {}, depths are rounded by up to {}: expected error {:.1e}, tolerance {:.1e}; use more "
        "slices, or 0 for as many as needed",
        slices.size(), format_length(plan.sliced.depth.thickness / 2), plan.sliced.expected_error, params.tolerance));
  return plan;
}

// The waves of a slice as points of strength ±i·a·exp(i(k·d + φ)), which holds the phase at the panel on the axis: + behind the panel,
// − in front of it, where waves converge.
std::vector<PointOnSlice> points_of(const DepthSlice& slice, const Sources& sources, const Grid& grid) {
  std::vector<PointOnSlice> points;
  points.reserve(slice.members.size());
  for (const uint32_t i : slice.members) {
    const Source& s = sources.waves[i];
    const double cycles =
        cycle_fraction(-s.origin.z, sources.wavelength) + s.phase / (2 * pi) + (s.origin.z < 0 ? 0.25 : -0.25);
    points.push_back({(s.origin.x - grid.x(0)) / grid.pitch, (grid.y(0) - s.origin.y) / grid.pitch,
                      Complex(double(s.amplitude) * cis_cycles(cycles))});
  }
  return points;
}

// Radii of the hiding discs of all waves, per slice, in the order of the slice's members.
std::vector<std::vector<double>> radii_of(const DepthSlices& depth, const Sources& sources, const Grid& grid) {
  std::vector<PointOnSlice> points;
  std::vector<double> depths;
  for (const DepthSlice& slice : depth.slices) {
    const std::vector<PointOnSlice> of_slice = points_of(slice, sources, grid);
    points.insert(points.end(), of_slice.begin(), of_slice.end());
    for (const uint32_t i : slice.members) depths.push_back(-sources.waves[i].origin.z / grid.pitch);
  }
  const std::vector<double> all = silhouette_radii(points, depths);
  std::vector<std::vector<double>> radii;
  auto next = all.begin();
  for (const DepthSlice& slice : depth.slices) {
    radii.emplace_back(next, next + int64_t(slice.members.size()));
    next += int64_t(slice.members.size());
  }
  return radii;
}

// Weights of the frequencies of spread points along one axis, and the samples that the points are spread over.
struct SpreadAxis {
  AxisWeights weights;
  int samples = 0;
};

SpreadAxis spread_axis(const Taper& taper, double depth, double wavelength, double side, const Plan& plan, int reach) {
  SpreadAxis axis{taper_weights(taper, depth, wavelength, side, plan.steepness, reach + 1)};
  const int band = int(axis.weights.size()) - 1;
  axis.samples = spread_length(band, plan.kernel);
  const std::vector<double> correction = spread_correction(plan.kernel, axis.samples, band);
  for (size_t k = 0; k < axis.weights.size(); ++k) axis.weights[k] = float(axis.weights[k] * correction[k]);
  return axis;
}

// Adds a slice of points; its light travels `distance` to the plane of the spectrum.
void add_points(LayerSpectrum& spectrum, const std::vector<PointOnSlice>& points, const PlannedSlice& slice,
                const Plan& plan, double distance) {
  const double pitch = spectrum.panel.pitch, width = spectrum.nx * pitch, height = spectrum.ny * pitch;
  const SpreadAxis x = spread_axis(slice.x, slice.depth, spectrum.wavelength, width, plan, spectrum.reach_x);
  const SpreadAxis y = spread_axis(slice.y, slice.depth, spectrum.wavelength, height, plan, spectrum.reach_y);
  add_light(spectrum, spread_points(points, plan.kernel, spectrum.nx, spectrum.ny, x.samples, y.samples), x.weights,
            y.weights, {distance, spectrum.wavelength * std::abs(slice.depth) / (width * height), true});
}

}  // namespace

size_t slice_count(const Sources& sources, const Grid& grid, const SynthesizeParams& params) {
  return slice_sources(sources, grid, params.slices, slicing_share * params.tolerance).depth.slices.size();
}

Field sum_layers(const Sources& sources, const Grid& grid, const SynthesizeParams& params, const Observer& observer) {
  check_input(sources, grid, params);
  const bool is_carried = params.has_silhouettes;
  const Plan plan = make_plan(sources, grid, params, is_carried, observer);
  Field field(grid, sources.wavelength);
  field.label = sources.label;
  if (plan.slices.empty()) return field;
  const LayerWindow& w = plan.window;
  LayerSpectrum spectrum = make_layer_spectrum(grid, sources.wavelength, w.nx, w.ny, w.reach_x, w.reach_y);
  std::vector<std::vector<double>> radii;
  if (is_carried) radii = radii_of(plan.sliced.depth, sources, grid);
  for (size_t m = 0; m < plan.slices.size(); ++m) {
    const PlannedSlice& slice = plan.slices[m];
    const std::vector<PointOnSlice> points = points_of(plan.sliced.depth.slices[m], sources, grid);
    if (is_carried && m > 0) {
      carry(spectrum, plan.slices[m - 1].depth - slice.depth);
      const auto weights = [&](const Taper& taper, int n, int reach) {
        return taper_weights(taper, slice.depth, sources.wavelength, n * grid.pitch, plan.steepness, reach + 1);
      };
      hide(spectrum, silhouette_of(points, radii[m], w.nx, w.ny), 0, 0, weights(slice.x, w.nx, w.reach_x),
           weights(slice.y, w.ny, w.reach_y));
    }
    add_points(spectrum, points, slice, plan, is_carried ? 0 : slice.depth);
    observer.progress(double(m + 1) / double(plan.slices.size() + 1));
  }
  if (is_carried) carry(spectrum, plan.slices.back().depth);
  field.samples = samples_of(spectrum, grid.nx, grid.ny);
  observer.progress(1);
  return field;
}

Layers make_layers(const Sources& sources, const Grid& grid, const SynthesizeParams& params, const Observer& observer) {
  check_input(sources, grid, params);
  const Plan plan = make_plan(sources, grid, params, true, observer);
  const LayerWindow& w = plan.window;
  const double samples = double(w.nx) * w.ny;
  require_memory(double(plan.slices.size()) * samples * (params.has_silhouettes ? 12 : 8),
                 fmt::format("{} slices of {} × {} samples", plan.slices.size(), w.nx, w.ny));
  // The window as a raster around the panel: samples (0, 0) to (nx − 1, ny − 1); what lies left or above wraps around.
  const int left = (w.nx - grid.nx) / 2, top = (w.ny - grid.ny) / 2;
  Grid raster{w.nx, w.ny, grid.pitch};
  raster.centre_x = grid.x(0) + ((w.nx - 1) / 2.0 - left) * grid.pitch;
  raster.centre_y = grid.y(0) - ((w.ny - 1) / 2.0 - top) * grid.pitch;
  const auto turned = [&](const auto& values) {
    auto out = values;
    for (int j = 0; j < w.ny; ++j)
      for (int i = 0; i < w.nx; ++i) out(j, i) = values((j - top + w.ny) % w.ny, (i - left + w.nx) % w.nx);
    return out;
  };
  Layers layers{sources.wavelength, {}};
  std::vector<std::vector<double>> radii;
  if (params.has_silhouettes) radii = radii_of(plan.sliced.depth, sources, grid);
  for (size_t m = 0; m < plan.slices.size(); ++m) {
    LayerSpectrum spectrum = make_layer_spectrum(grid, sources.wavelength, w.nx, w.ny, w.reach_x, w.reach_y);
    const std::vector<PointOnSlice> points = points_of(plan.sliced.depth.slices[m], sources, grid);
    const double depth = plan.slices[m].depth;
    add_points(spectrum, points, plan.slices[m], plan, 0);
    Slice slice{Field(raster, sources.wavelength, -depth), {}};
    slice.light.samples = turned(samples_of(spectrum, w.nx, w.ny));
    const Complex axial(cis_cycles(-cycle_fraction(depth, sources.wavelength)));
    for (Complex& u : slice.light.samples.values) u *= axial;
    if (params.has_silhouettes) slice.mask = turned(silhouette_of(points, radii[m], w.nx, w.ny));
    layers.slices.push_back(std::move(slice));
    observer.progress(double(m + 1) / double(plan.slices.size()));
  }
  return layers;
}

}  // namespace holotrace
