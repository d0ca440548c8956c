#pragma once

#include <complex>
#include <vector>

#include "holotrace/wave/planes/plane_correction_kernel.h"
#include "holotrace/wave/planes/plane_tile.h"
#include "holotrace/wave/planes/plane_wave_kernel.h"
#include "holotrace/wave/planes/whole_tiles.h"
#include "holotrace/wave/tiles/device_wave.h"

// What plane_sum.cl reads besides its grids: waves in packets, and the tables of a plan.

namespace holotrace {

using tile_factor_kernel::PlaneSlab;

/// Waves [first, end) that are neighbours: the boxes of their origins [wavelengths] and of the tiles that they light
/// wholly. As plane_sum.cl declares it.
struct PlanePacket {
  float x0, x1, y0, y1, depth0, depth1;
  int32_t first, end, tiles_x0, tiles_x1, tiles_y0, tiles_y1;
};

/// Waves of a packet at most.
inline constexpr size_t packet_waves = 64;

/// A wave whose box is that of the tiles that it lights wholly.
DeviceWave device_plane_wave(const PreparedWave& wave, double wavelength, const PlaneTiles& tiles);

/// The packet of waves [first, end).
PlanePacket packet_of(const std::vector<DeviceWave>& waves, size_t first, size_t end);

PlaneSlab slab_on_device(const Slab& slab, const PlanesTables& tables);

/// f, f², −f² of the cells along an axis, one after the other [cycles/m, cycles²/m²].
std::vector<std::complex<float>> frequency_factors(const PlanesTables& tables);

/// plane_chirp of each slab's nodes, one after the other.
std::vector<std::complex<float>> all_chirps(const std::vector<Slab>& slabs, const PlanesTables& tables);

/// Corrections of each slab's nodes.
std::vector<Correction<float>> all_corrections(const std::vector<Slab>& slabs, const PlanesTables& tables);

/// The gridding kernel's first and second moment for each pixel along an axis.
std::vector<std::complex<float>> all_moments(const PlanesTables& tables);

/// The gridding kernel's polynomials, [power][cell].
std::vector<float> all_coefficients(const PlanesTables& tables);

/// Places of the tiles' reference pixels along both axes [wavelengths].
std::vector<FloatPair> column_references(const PlaneTiles& tiles, double wavelength);
std::vector<FloatPair> row_references(const PlaneTiles& tiles, double wavelength);

}  // namespace holotrace
