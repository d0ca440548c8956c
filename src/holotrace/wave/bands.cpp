#include "holotrace/wave/bands.h"

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {
namespace {

constexpr int unit_rows = 128, least_bands = 64, exact_rows = 32;

// The constants of band_memory. Program and libraries: 20 MB measured, 32 MB with MPI.
constexpr double program_bytes = 50e6, wave_bytes = 340, wave_tile_bytes = 16, counted_threads = 16;

// The row of panel tiles that a row of pixels lies in.
int tile_row_of(const TileAmplitudes& tiles, const Grid& panel, int row) {
  int tile = 0;
  while (tile + 1 < tiles.rows && tile_start(tile + 1, tiles.rows, panel.ny) <= row) ++tile;
  return tile;
}

// The waves that light pixels of the band, with the amplitudes of its tiles.
Sources sources_of_band(const Sources& all, const Grid& panel, const Grid& grid, int first_row) {
  Sources some{.wavelength = all.wavelength, .label = all.label};
  const int columns = all.tiles.columns;
  const size_t count = all.waves.size();
  const size_t first_tile = columns > 0 ? size_t(tile_row_of(all.tiles, panel, first_row)) * size_t(columns) : 0;
  const auto amplitude = [&](size_t tile, size_t i) { return all.tiles.values[(first_tile + tile) * count + i]; };
  const double tangent = acceptance_tangent(all.acceptance_wavelength(), panel.pitch);
  std::vector<size_t> chosen;
  for (size_t i = 0; i < count; ++i) {
    bool has_light = columns == 0;
    for (int tile = 0; tile < columns; ++tile) has_light = has_light || amplitude(size_t(tile), i) != 0;
    if (has_light && !lit_box(all, i, grid, tangent).is_empty()) chosen.push_back(i);
  }
  some.waves.reserve(chosen.size());
  for (const size_t i : chosen) some.waves.push_back(all.waves[i]);
  if (!all.second_foci.empty())
    for (const size_t i : chosen) some.second_foci.push_back(all.second_foci[i]);
  if (columns == 0) return some;
  some.tiles = {columns, 1, {}};
  some.tiles.values.reserve(size_t(columns) * chosen.size());
  for (int tile = 0; tile < columns; ++tile)
    for (const size_t i : chosen) some.tiles.values.push_back(amplitude(size_t(tile), i));
  return some;
}

// The exact field of the band, summed in double a few rows at a time and stored in single precision.
Field exact_band(const Sources& sources, const Grid& grid, const Observer& observer) {
  Field field(grid, sources.wavelength);
  const int parts = (grid.ny + exact_rows - 1) / exact_rows;
  for (int part = 0; part < parts; ++part) {
    const int row = part * exact_rows, end = std::min(row + exact_rows, grid.ny);
    const FieldDouble rows = sum_exact(sources, band_of(grid, row, end), part_of(observer, part, parts));
    std::transform(rows.samples.values.begin(), rows.samples.values.end(), field.samples.row(row),
                   [](std::complex<double> u) { return std::complex<float>(u); });
  }
  return field;
}

}  // namespace

Grid band_of(const Grid& panel, int first_row, int end_row) {
  Grid band = panel;
  band.ny = end_row - first_row;
  band.centre_y = panel.y((first_row + end_row - 1) / 2.0);
  return band;
}

void check_band_method(const SynthesizeParams& params) {
  using enum SynthesisMethod;
  require(
      params.method != layers && params.method != triangles,
      "expected the method auto, exact, tiled or planes for a field made in bands, got {}; choose one of them, or make "
      "the field whole, without --memory and without mpirun",
      method_name(params.method));
}

double band_memory(const std::vector<Sources>& sets, const Grid& panel, const SynthesizeParams& params, int rows) {
  using enum SynthesisMethod;
  const bool is_on_devices = params.device.kind != DeviceKind::cpu && params.method != exact;
  const Approach approach = params.method == tiled ? Approach::tiled : Approach::cheapest;
  const double each = wave_bytes + host_bytes_per_wave(is_on_devices, approach) - host_bytes_per_wave(false, approach);
  double waves = 0;
  bool has_kinds = false;  // summed one after the other, from copies
  for (const Sources& set : sets) {
    const bool has_more = !are_from_behind(set);
    has_kinds = has_kinds || has_more;
    waves += double(set.waves.size()) * ((has_more ? 2 * (sizeof(Source) + sizeof(SecondFocus)) : 0) + each +
                                         wave_tile_bytes * set.tiles.columns * set.tiles.rows);
  }
  const double samples = double(panel.nx) * rows * ((params.method == automatic ? 24 : 8) + (has_kinds ? 8 : 0));
  const double strip = params.method == exact ? double(panel.nx) * exact_rows * sizeof(std::complex<double>) : 0;
  const bool may_use_planes = params.method == automatic || params.method == planes;
  const double threads = may_use_planes ? counted_threads * host_bytes_per_thread() : 0;
  return program_bytes + waves + samples + strip + threads;
}

std::vector<Band> plan_bands(const std::vector<Sources>& sets, const Grid& panel, const SynthesizeParams& params,
                             double memory) {
  check_grid(panel);
  const double needed = band_memory(sets, panel, params, std::min(unit_rows, panel.ny));
  require(memory >= needed,
          "expected --memory of {} or more, for {} rows of {} pixels and the waves, got {}; give more, or fewer waves",
          format_bytes(needed), std::min(unit_rows, panel.ny), panel.nx, format_bytes(memory));
  const int wanted = (panel.ny + least_bands * unit_rows - 1) / (least_bands * unit_rows) * unit_rows;
  int height = wanted;
  while (height > unit_rows && band_memory(sets, panel, params, height) > memory) height -= unit_rows;
  std::vector<Band> bands;
  for (size_t set = 0; set < sets.size(); ++set) {
    const TileAmplitudes& tiles = sets[set].tiles;
    for (int row = 0; row < panel.ny;) {
      int end = std::min(row + height, panel.ny);
      if (tiles.rows > 0) end = std::min(end, tile_start(tile_row_of(tiles, panel, row) + 1, tiles.rows, panel.ny));
      bands.push_back({int(set), row, end});
      row = end;
    }
  }
  return bands;
}

int64_t missed_waves(const Sources& sources, const Grid& panel) {
  const double tangent = acceptance_tangent(sources.acceptance_wavelength(), panel.pitch);
  int64_t missed = 0;
  for (size_t i = 0; i < sources.waves.size(); ++i) missed += lit_box(sources, i, panel, tangent).is_empty();
  return missed;
}

std::vector<double> band_shares(const std::vector<Sources>& sets, const Grid& panel, const std::vector<Band>& bands) {
  std::vector<std::vector<double>> work;  // [set][row]: work of all rows above this one
  for (const Sources& set : sets) {
    std::vector<double> change(size_t(panel.ny) + 1, 0.0);
    const double tangent = acceptance_tangent(set.acceptance_wavelength(), panel.pitch);
    for (size_t i = 0; i < set.waves.size(); ++i) {
      const PixelBox box = lit_box(set, i, panel, tangent);
      if (box.is_empty()) continue;
      change[size_t(box.y0)] += box.x1 - box.x0;
      change[size_t(box.y1)] -= box.x1 - box.x0;
    }
    std::vector<double>& sums = work.emplace_back(1, 0.0);
    double lit = 0;
    for (int row = 0; row < panel.ny; ++row) {
      lit += change[size_t(row)];
      sums.push_back(sums.back() + lit + 300.0 * panel.nx);
    }
  }
  std::vector<double> shares;
  double sum = 0;
  for (const Band& band : bands) {
    const std::vector<double>& sums = work[size_t(band.set)];
    shares.push_back(sums[size_t(band.end_row)] - sums[size_t(band.first_row)]);
    sum += shares.back();
  }
  for (double& share : shares) share /= sum;
  return shares;
}

Field synthesize_band(const Sources& sources, const Grid& panel, const Band& band, const SynthesizeParams& params,
                      const Observer& observer) {
  check_band_method(params);
  const Grid grid = band_of(panel, band.first_row, band.end_row);
  const Sources waves = sources_of_band(sources, panel, grid, band.first_row);
  if (waves.waves.empty()) return Field(grid, sources.wavelength);
  if (params.method == SynthesisMethod::exact) return exact_band(waves, grid, observer);
  return synthesize(waves, grid, params, observer);
}

}  // namespace holotrace
