#pragma once

#include <atomic>
#include <complex>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/planes/plane_correction_kernel.h"
#include "holotrace/wave/planes/plane_spread.h"
#include "holotrace/wave/planes/plane_tile.h"
#include "holotrace/wave/planes/plane_wave_kernel.h"
#include "holotrace/wave/tiles/device_wave.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

/// The tiles of a plan, from the top left corner of `bounds` on.
struct PlaneTiles {
  Grid grid;
  PixelBox bounds;
  int side = 0;        ///< [pixels]
  double tangent = 0;  ///< of the panel's acceptance, with a margin (PlanesModel)

  int across() const { return (bounds.x1 - bounds.x0 + side - 1) / side; }
  int down() const { return (bounds.y1 - bounds.y0 + side - 1) / side; }
};

/// The tiles [x0, x1) × [y0, y1) that a wave lights wholly, and whose reference pixels it reaches within the panel's
/// acceptance, so that its frequency is on their grids. They are a rectangle, which may be empty.
PixelBox whole_tiles(const PreparedWave& wave, const PlaneTiles& tiles);

/// Appends the light of `some` waves in all other tiles to `waves`: for each up to four waves, with the boxes that are left
/// around whole_tiles.
void append_rest(PreparedWaves some, const PlaneTiles& tiles, std::vector<PreparedWave>& waves);

// What plane_sum.cl reads besides its grids: waves in packets, and the tables of a plan.

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

/// Waves and their packets as devices get them, made once for all devices of a sum.
struct PacketedWaves {
  struct Range {
    int first, end;
  };

  const SortedWaves& sorted;
  PlaneTiles tiles;
  std::vector<DeviceWave> waves{};
  std::vector<PlanePacket> packets{};
  std::vector<Range> slabs{};  ///< packets of each slab

  /// @param waves   sorted for the plan (sort_waves); they must outlive this object
  /// @param bounds  pixels to sum; tiles cover them from the top left corner on
  PacketedWaves(const SortedWaves& waves, const PlanesTables& tables, const Grid& grid, const PixelBox& bounds);
};

/// Waves by planes of fixed curvature on a device (plane_sum.cl), in the tiles that they light wholly. Their light in other
/// tiles is left to the sum in tiles (append_rest, device_tiles.h), so plans for a device have no strips.
///
/// Waves are sorted into packets of neighbours. A group of work items owns a block of cells of a tile's grids, and adds up
/// the packets that reach it in their order. No group writes to the cells of another: same device and waves, same bytes.
class DevicePlanes {
 public:
  /// Sends the tables of the plan, and the waves if a third of the device's free memory holds them. Otherwise `add` sends
  /// them in parts. The arguments must outlive this object.
  /// @throws Error  as Device does
  DevicePlanes(Device& device, const PacketedWaves& waves, const PlanesTables& tables);

  /// Adds the light to the samples of a band of rows of the bounds, with all of their columns. Tiles are computed some at a
  /// time, as memory allows; the samples do not depend on that.
  /// It ends between them once `is_stopped` is set: another device has failed.
  void add(const PixelBox& band, const DeviceBuffer& samples, const Observer& observer,
           const std::atomic<bool>& is_stopped);

  /// Memory that `add` needs at least [bytes].
  double least_memory() const { return tile_bytes() + part_bytes(); }

 private:
  using Packets = PacketedWaves::Range;
  struct Chunk;

  double tile_bytes() const;
  double part_bytes() const;
  int tiles_at_once() const;
  void send_part(size_t part);
  void spread(int slab, int first_tile, const Chunk& chunk);
  void transform(const Chunk& chunk);

  Device& device_;
  LineTransforms lines_;
  const PacketedWaves& waves_;
  const PlanesTables& tables_;
  std::vector<Packets> parts_;  // packets of waves that are sent at once
  size_t sent_ = 0;             // part that is on the device
  DeviceBuffer sent_waves_, sent_packets_, coefficients_, columns_, rows_, frequencies_, chirps_, moments_,
      corrections_;
};

/// Work of a plan on a device in the tiles that waves light wholly.
struct DevicePlanesWork {
  double multiply_adds = 0;  ///< or operations of the same cost
  double moved_bytes = 0;    ///< read and written in its memory by transforms and additions
};

/// @param whole  pairs of a wave and a tile that it lights wholly
/// @param tiles  tiles of the panel
DevicePlanesWork device_planes_work(const PlanesPlan& plan, double whole, double tiles);

}  // namespace holotrace
