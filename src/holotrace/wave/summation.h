#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// Which of the fast summations may be used: tiles alone; `planes`, with tiles for waves too near for it; or the
/// one that is expected to take less work.
enum class Approach { tiled, planes, cheapest };

/// The way in which waves are summed, and the devices that sum them.
struct SumWay {
  Approach approach;
  std::vector<Device*> devices;  ///< equal ones, which share the rows of the panel; none: the processor
  bool stays;                    ///< whether the field stays on the device, if there is one and its memory holds it

  SumWay(Approach approach, Device* device = nullptr, bool stays = false) : approach(approach), stays(stays) {
    if (device) devices.push_back(device);
  }
  SumWay(Approach approach, std::vector<Device*> devices, bool stays = false)
      : approach(approach), devices(std::move(devices)), stays(stays && this->devices.size() == 1) {}

  /// The device by which plans are made.
  Device* device() const { return devices.empty() ? nullptr : devices.front(); }
};

/// A sum of waves: on the processor, or on the device that summed it (`field` then has no samples).
struct SummedField {
  Field field;
  std::optional<DeviceField> there{};
};

/// Memory of this machine that a sum takes for each wave, at most [bytes]. On devices it is the same for any number of them.
double host_bytes_per_wave(bool is_on_devices, Approach approach);

/// Memory of this machine that a sum takes for each thread, at most [bytes].
double host_bytes_per_thread();

/// Common core of sum_tiled and sum_planes. For the panel (or for each of its tiles, if waves have tile amplitudes)
/// it chooses a plan whose measured error meets the tolerance, and sums. It then compares the energies: if the waves
/// cancel, their relative error grows, and the sum is repeated with a finer plan.
///
/// Facts: method, how (the plan of the part with the greatest error), expected_error, predicted_seconds (cost_model.h; on
/// a device stage_on_device.h, if it was measured).
/// @return  the field; none if no plan meets the tolerance, and `reachable` is then a tolerance that can be met
std::optional<SummedField> try_sum(const Sources& sources, const Grid& grid, double tolerance, const SumWay& way,
                                   double& reachable, const Observer& observer);

/// The same for one method. @throws Error  if no plan of this method meets the tolerance
SummedField sum_within(const Sources& sources, const Grid& grid, double tolerance, const SumWay& way,
                       const Observer& observer);

/// Forecast of try_sum without the sum: the plan of its first round.
struct SumForecast {
  double seconds = 0;  ///< by the cost model, without the time for planning; infinite for a device without rates
  std::string method;  ///< "tiled" or "planes"; "": no plan meets the tolerance
};

/// @throws Error  as try_sum does
SumForecast forecast_sum(const Sources& sources, const Grid& grid, double tolerance, const SumWay& way);

/// Field on the panel of a set of spherical waves, summed tile by tile.
///
///     U(p) = Σⱼ aⱼ·d₀ⱼ/rⱼ(p)·exp(i(2π·rⱼ(p)/λ + φⱼ)),   rⱼ = ‖p − oⱼ‖,  p inside the box of j   (Eq. 7, 13)
///
/// Inside a tile r is split as r₀ + Δr(column) + Δr(row). The wave is then one number times a column
/// times a row, and the sum over waves is a complex matrix product. The neglected phase, about
/// k·x₀·y₀·u·v/r₀³, is kept below `tolerance` by the choice of the tile's shape (tile_error.h). If the waves
/// partly cancel, their relative error grows; the sum is then repeated with smaller tiles.
///
/// With tile amplitudes (TileAmplitudes), aⱼ is the amplitude in the panel tile that p lies in. The sum is then made
/// for one panel tile after the other, each within the tolerance.
///
/// @param sources    spherical waves at z < 0 [m]
/// @param grid       panel pixels: nx, ny, pitch [m]
/// @param tolerance  bound on the relative L2 error against sum_exact, 1e-5 or more
/// @return           complex amplitude, shape (ny, nx) [√(W/m²)]; the same bytes on any number of threads
/// @throws Error     for a source not behind the panel, naming it, and for a tolerance that no tile can meet
///
/// Facts: those of try_sum.
///
/// Cost: 3 multiply-adds per wave and pixel in its box, and a sine and cosine per wave and per column
/// and row of the tiles it meets.
Field sum_tiled(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer = {});

/// Field on the panel of a set of spherical waves, by a non-uniform FFT in every tile of the
/// panel: the same sum as sum_exact.h, box for box.
///
/// In a tile, around its reference pixel at the distance r₀ and the position (x, y) from a wave's origin, the wave is
///
///     a·(d₀/r₀)·exp(2πi(r₀/λ + φ₀/2π + (x·u + y·v)/λr₀ + κ(u² + v²)/2)),   κ = (1 − ρ²/2r₀²)/λr₀
///
/// a plane wave of the frequency (x, y)/λr₀ times a curvature. Waves of similar depth form a slab. A slab has a few
/// nodes of fixed curvature (Chebyshev points), among which a wave is shared out by Lagrange weights. On each node's
/// grid the wave is added to the cells around its frequency by the gridding kernel of a non-uniform FFT; an FFT of the
/// grid then gives the tile.
/// Neglected are the phases ∝ u·v, u² − v² and of third order, and the slope of the modulus. They depend on frequency
/// and curvature alone; if the tolerance requires it, four more FFTs correct them to first order. A wave whose box cuts
/// a tile parallel to an axis is added in strips of 16 lines, exact across and gridded along. Waves are summed directly
/// in tiles that contain a corner of their box, and everywhere if their box is only a few tiles wide.
///
/// @param sources    spherical waves at z < 0 [m]
/// @param grid       panel pixels: nx, ny, pitch [m]
/// @param tolerance  bound on the relative L2 error against sum_exact, 1e-5 or more
/// @return           complex amplitude, shape (ny, nx) [√(W/m²)]; the same bytes on any number of threads
/// @throws Error     for a source not behind the panel, naming it, and for a tolerance that no plan can meet
///
/// Cost: about width²·nodes multiply-adds per wave and tile (not per pixel): tens of times less than sum_tiled for many
/// waves. Memory: the field, 340 bytes per wave, 27 MB per thread.
Field sum_planes(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer = {});

}  // namespace holotrace
