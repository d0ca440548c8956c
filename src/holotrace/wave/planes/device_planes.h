#pragma once

#include <atomic>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/planes/device_plane_tables.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

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
