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

/// Common core of sum_tiled.h and sum_planes.h. For the panel (or for each of its tiles, if waves have tile amplitudes)
/// it chooses a plan whose measured error meets the tolerance, and sums. It then compares the energies: if the waves
/// cancel, their relative error grows, and the sum is repeated with a finer plan.
///
/// Facts: method, how (the plan of the part with the greatest error), expected_error, predicted_seconds (cost_model.h; on
/// a device device_rates.h, if it was measured).
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

}  // namespace holotrace
