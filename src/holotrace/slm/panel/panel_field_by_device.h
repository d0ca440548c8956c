#pragma once

#include <optional>
#include <variant>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/device.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// A pattern on the panel, as PanelModel::leave takes it.
struct PanelPattern {
  const Array2D<float>& drive;
  const Array2D<float>* modulus = nullptr;
};

/// The field that leaves a panel (PanelModel::leave), on the device that `choice` names, in single precision (DevicePanel).
///
/// The device `auto` is the one that is expected to be the fastest, by the rates of device_rates.h: the transforms of the
/// panel count, and the transfers of levels and field, for each band. If it fails, a warning says why.
///
/// A panel that does not fit in the device's memory is done in bands (BandedPanel); the field is the same.
///
/// Fact: `device`, its name. Transfers: 4 bytes per pixel (8 for a complex modulation), and the panel's effects, once for each band
/// of columns; 8 bytes per sample come back.
/// @return        nothing if the processor should do it
/// @throws Error  for a device that is not there, and as PanelModel::leave and Device do
std::optional<Field> panel_field_by_device(const PanelModel& panel, const PanelPattern& pattern,
                                           const DeviceChoice& choice, const Observer& observer = {});

/// A field that left a panel, on the device that has computed it or, if it does not fit there, on the processor; and its
/// power [W].
struct PanelField {
  std::variant<DeviceField, Field> field;
  double power = 0;
};

/// The same, but the field stays on the device if that has memory for it.
std::optional<PanelField> panel_field_on_device(const PanelModel& panel, const PanelPattern& pattern,
                                                const DeviceChoice& choice, const Observer& observer = {});

}  // namespace holotrace
