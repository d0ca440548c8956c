#pragma once

#include <functional>
#include <optional>
#include <variant>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/device.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/panel/device_panel.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// The field that leaves a panel (PanelModel::leave), on the device that `choice` names, in single precision (DevicePanel).
///
/// The device `auto` is the one that is expected to be the fastest, by the rates of stage_on_device.h and what forecast_panel
/// counts. If it fails, a warning says why.
///
/// A panel that does not fit in the device's memory is done in parts (each_band_of_light); the field is the same.
///
/// Fact: `device`, its name. Transfers: 4 bytes per pixel (8 for a complex modulation), and the panel's effects, once for each
/// part; 8 bytes per sample come back.
/// @return        nothing if the processor should do it
/// @throws Error  for a device that is not there, and as PanelModel::leave and Device do
std::optional<Field> panel_field_by_device(const PanelModel& panel, const PanelModel::Pattern& pattern,
                                           const DeviceChoice& choice, const Observer& observer = {});

/// A field that left a panel, on the device that has computed it or, if it does not fit there, on the processor; and its
/// power [W].
struct PanelField {
  std::variant<DeviceField, Field> field;
  double power = 0;
};

/// The same, but the field stays on the device if it fits there at once, or takes at most half of the free memory.
std::optional<PanelField> panel_field_on_device(const PanelModel& panel, const PanelModel::Pattern& pattern,
                                                const DeviceChoice& choice, const Observer& observer = {});

/// Computes on a device the light that leaves a panel, in that number of parts of its rows and of its columns. Calls
/// take(columns, u) with one band of columns after the other, shape (n·ny, columns), until it returns false; it may take the buffer.
///
/// The transforms along the rows are done for one band of rows of pixels after the other, each with the rows beside it that
/// crosstalk reaches. Of their results the device keeps one band of columns, and does the transforms along these. Levels and the
/// panel's effects are thus sent once for each band of columns, and the transforms along the rows are done again, but nothing in
/// between leaves the device. Samples do not depend on the number of parts.
/// @throws Error  as Device does
void each_band_of_light(Device& device, const PanelModel& panel, const PanelModel::Pattern& pattern, int parts,
                        const std::function<bool(const SampleColumns& columns, DeviceBuffer& u)>& take);

/// What a device does that has so many bytes of memory left for a panel.
struct PanelForecast {
  int parts = 1;       ///< in which it must be done (each_band_of_light)
  bool stays = false;  ///< whether the field stays on the device
  DeviceUse use;       ///< of all parts, and of the field
  bool fits = false;   ///< otherwise not even the smallest parts do
};

/// The panel is run on a device that only counts, in 1, 2, 3, 5, 8, … parts, 315 at most, until they fit in nine tenths of the
/// memory.
/// @param may_stay  whether the field stays on the device if it can (panel_field_on_device)
PanelForecast forecast_panel(const Device& device, const PanelModel& panel, const PanelModel::Pattern& pattern,
                             bool may_stay, double memory);

}  // namespace holotrace
