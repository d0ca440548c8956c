#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "holotrace/base/cycles.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/astigmatic_wave.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// The pixels within a distance from a place, along each axis.
inline PixelBox pixels_around(Vec3 place, double reach_x, double reach_y, const Grid& grid) {
  const auto clamp = [](double value, int limit) { return int(std::clamp(value, 0.0, double(limit))); };
  const double column = (place.x - grid.centre_x) / grid.pitch + (grid.nx - 1) / 2.0;
  const double row = (grid.ny - 1) / 2.0 - (place.y - grid.centre_y) / grid.pitch;
  const double across = reach_x / grid.pitch, down = reach_y / grid.pitch;
  return {clamp(std::ceil(column - across), grid.nx), clamp(std::floor(column + across) + 1, grid.nx),
          clamp(std::ceil(row - down), grid.ny), clamp(std::floor(row + down) + 1, grid.ny)};
}

/// The pixels that a source lights: |x − xₒ| ≤ R and |y − yₒ| ≤ R, R = d₀·tangent (Eq. 14). The tangent is that of the
/// cone that the waves keep to, tan(asin(λ/2p)) for λ = Sources::acceptance_wavelength.
inline PixelBox lit_box(const Source& source, const Grid& grid, double tangent) {
  const double radius = std::abs(source.origin.z) * tangent;
  if (!std::isfinite(radius)) return {0, grid.nx, 0, grid.ny};
  return pixels_around(source.origin, radius, radius, grid);
}

/// An astigmatic wave, and the part of the panel's plane that it lights.
struct LitAstigmaticWave {
  AstigmaticWave wave;
  AstigmaticWave::Lit lit;

  /// Wave i of the sources.
  LitAstigmaticWave(const Sources& sources, size_t i, double tangent)
      : wave(sources.waves[i].origin, sources.second_foci[i]), lit(wave.lit(tangent)) {}

  /// The pixels around what it lights.
  PixelBox box(const Grid& grid) const {
    if (!std::isfinite(lit.reach_x) || !std::isfinite(lit.reach_y)) return {0, grid.nx, 0, grid.ny};
    return pixels_around(lit.foot, lit.reach_x, lit.reach_y, grid);
  }
};

/// The pixels that wave i lights, or those around them.
inline PixelBox lit_box(const Sources& sources, size_t i, const Grid& grid, double tangent) {
  if (!is_astigmatic(sources, i)) return lit_box(sources.waves[i], grid, tangent);
  return LitAstigmaticWave(sources, i, tangent).box(grid);
}

/// r − d for r = √(ρ² + d²) without the cancellation of the difference: ρ²/(r + d).
inline double path_beyond_depth(double rho2, double depth) { return rho2 / (std::sqrt(rho2 + depth * depth) + depth); }

/// A source prepared for summation: r/λ is split into d₀/λ, reduced once, and (r − d₀)/λ, which is
/// a few hundred cycles and therefore exact to 1e-13 of a cycle in double.
struct PreparedWave {
  double x, y, depth;
  double start_cycles;  ///< d₀/λ + φ₀/2π, reduced; φ₀/2π of an astigmatic wave
  double amplitude;
  PixelBox box;
  /// Of an astigmatic wave: its box has pixels that it does not light (lit_columns).
  std::shared_ptr<const LitAstigmaticWave> astigmatic{};
};

/// Some waves that are prepared.
using PreparedWaves = std::span<const PreparedWave>;

/// @param tangent  of the cone that the wave keeps to
inline PreparedWave prepare_wave(const Source& source, const Grid& grid, double wavelength, double tangent) {
  const double depth = -source.origin.z;
  return {source.origin.x,
          source.origin.y,
          depth,
          cycle_fraction(depth, wavelength) + source.phase / (2 * pi),
          source.amplitude,
          lit_box(source, grid, tangent)};
}

/// The same within the panel's acceptance.
inline PreparedWave prepare_wave(const Source& source, const Grid& grid, double wavelength) {
  return prepare_wave(source, grid, wavelength, acceptance_tangent(wavelength, grid.pitch));
}

/// Wave i of the sources.
inline PreparedWave prepare_wave(const Sources& sources, size_t i, const Grid& grid, double tangent) {
  const Source& source = sources.waves[i];
  if (!is_astigmatic(sources, i)) return prepare_wave(source, grid, sources.wavelength, tangent);
  const auto wave = std::make_shared<const LitAstigmaticWave>(sources, i, tangent);
  return {source.origin.x,
          source.origin.y,
          -source.origin.z,
          source.phase / (2 * pi),
          source.amplitude,
          wave->box(grid),
          wave};
}

/// The columns of a row that the wave lights: from and to; from ≥ to: none.
inline std::pair<int, int> lit_columns(const PreparedWave& wave, const Grid& grid, int row) {
  if (!wave.astigmatic) return {wave.box.x0, wave.box.x1};
  const AstigmaticWave::Lit& lit = wave.astigmatic->lit;
  const auto [from, to] = lit.along_x(grid.y(double(row)) - lit.foot.y);
  const double zero = (lit.foot.x - grid.centre_x) / grid.pitch + (grid.nx - 1) / 2.0;
  const auto column = [&](double x) { return std::clamp(zero + x / grid.pitch, -1.0, double(grid.nx)); };
  return {std::max(wave.box.x0, int(std::ceil(column(from)))), std::min(wave.box.x1, int(std::floor(column(to))) + 1)};
}

/// The sources prepared for summation, without those that light no pixel of the grid. Tile amplitudes are
/// not used: for these see the other prepare_waves.
inline std::vector<PreparedWave> prepare_waves(const Sources& sources, const Grid& grid) {
  std::vector<PreparedWave> waves(sources.waves.size());
  const double tangent = acceptance_tangent(sources.acceptance_wavelength(), grid.pitch);
  parallel_for(0, int64_t(waves.size()),
               [&](int64_t i) { waves[size_t(i)] = prepare_wave(sources, size_t(i), grid, tangent); });
  std::erase_if(waves, [](const PreparedWave& wave) { return wave.box.is_empty(); });
  return waves;
}

/// Number of parts of the panel with separate amplitudes of the waves: 1 without tile amplitudes.
inline int panel_parts(const Sources& sources) {
  return sources.tiles.columns > 0 ? sources.tiles.columns * sources.tiles.rows : 1;
}

/// The pixels of part `part` of panel_parts: a tile of TileAmplitudes, or the whole panel.
inline PixelBox panel_part(const Sources& sources, const Grid& grid, int part) {
  if (sources.tiles.columns == 0) return {0, grid.nx, 0, grid.ny};
  return tile_box(grid, sources.tiles.columns, sources.tiles.rows, part);
}

/// The amplitude of a wave in that part [√(W/m²)].
inline float amplitude_in(const Sources& sources, size_t wave, int part) {
  if (sources.tiles.columns == 0) return sources.waves[wave].amplitude;
  return sources.tiles.values[size_t(part) * sources.waves.size() + wave];
}

/// The waves for one part of the panel: its amplitudes, boxes cut at its edges, and no waves without light there.
inline std::vector<PreparedWave> prepare_waves(const Sources& sources, const Grid& grid, int part) {
  if (sources.tiles.columns == 0) return prepare_waves(sources, grid);
  const PixelBox bounds = panel_part(sources, grid, part);
  const double tangent = acceptance_tangent(sources.acceptance_wavelength(), grid.pitch);
  std::vector<PreparedWave> waves;
  for (size_t i = 0; i < sources.waves.size(); ++i) {
    const float amplitude = amplitude_in(sources, i, part);
    if (amplitude == 0) continue;
    PreparedWave wave = prepare_wave(sources, i, grid, tangent);
    wave.amplitude = amplitude;
    wave.box = intersect(wave.box, bounds);
    if (!wave.box.is_empty()) waves.push_back(wave);
  }
  return waves;
}

/// U = a·(d₀/r)·exp(2πi·(r/λ + φ₀/2π)) at the point (x, y) of the panel (Eq. 5, 6); for an astigmatic wave that of AstigmaticWave.
inline std::complex<double> wave_at(const PreparedWave& wave, double x, double y, double wavelength) {
  if (wave.astigmatic) {
    const auto [path, modulus, direction] = wave.astigmatic->wave.at({x, y, 0});
    return cis_cycles(wave.start_cycles + cycle_fraction(path, wavelength)) * (wave.amplitude * modulus);
  }
  const double dx = x - wave.x, dy = y - wave.y;
  const double beyond = path_beyond_depth(dx * dx + dy * dy, wave.depth);
  const double cycles = wave.start_cycles + beyond / wavelength;
  const double modulus = wave.amplitude * wave.depth / (wave.depth + beyond);
  return cis_cycles(cycles) * modulus;
}

}  // namespace holotrace
