#include "holotrace/slm/encode/iterate/device_driven_panel.h"

#include <algorithm>

#include "holotrace/base/cycles.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

const DeviceBuffer* moduli_of(const DeviceFrame& frame, const DeviceBuffer DeviceDrive::*values) {
  return (frame.modulus.*values).bytes() > 0 ? &(frame.modulus.*values) : nullptr;
}

DevicePattern pattern_of(const DeviceFrame& frame, bool is_halfway) {
  return {frame.level.rounded, moduli_of(frame, &DeviceDrive::rounded), is_halfway};
}

}  // namespace

DeviceDrivenPanel::DeviceDrivenPanel(Device& device, const DrivenPanel& panel) : device_(device), panel_(panel) {
  if (const PanelModel* model = panel.model(PixelDetail::as_shown)) model_.emplace(device, *model);
  if (!panel.has_crosstalk()) return;
  coarse_.emplace(device, *panel.model(PixelDetail::coarse));
  mean_.emplace(device, *panel.model(PixelDetail::mean));
}

double DeviceDrivenPanel::bytes_of_memory() const {
  double bytes = 0;
  for (const std::optional<DevicePanel>* panel : {&model_, &coarse_, &mean_})
    if (*panel) bytes = std::max(bytes, (*panel)->bytes_of_memory());
  return bytes;
}

DevicePanel* DeviceDrivenPanel::model(PixelDetail detail) {
  if (panel_.has_crosstalk() && detail != PixelDetail::as_shown)
    return detail == PixelDetail::coarse ? &*coarse_ : &*mean_;
  return model_ ? &*model_ : nullptr;
}

void DeviceDrivenPanel::leave(const DeviceFrame& frame, const PanelDetail& detail, const DevicePanelLight& u) {
  if (DevicePanel* const there = model(detail.light))
    return there->leave(pattern_of(frame, false), u.samples, u.memory);
  leave_phases(device_, float(panel_.cycles_per_level()), frame.level.rounded, u.samples);
}

void DeviceDrivenPanel::add_slope(const DeviceFrame& frame, const PanelDetail& detail, const DeviceBuffer& u,
                                  const DevicePanelLight& g, double factor) {
  const bool is_halfway = panel_.takes_middle(detail);
  if (DevicePanel* const there = model(detail.slopes)) {
    const DeviceSlopes to{frame.level.slope, moduli_of(frame, &DeviceDrive::slope), factor};
    return there->add_slopes(pattern_of(frame, is_halfway), g.samples, to, g.memory);
  }
  const double cycles = panel_.cycles_per_level();
  add_phase_slopes(device_, {float(factor * 2 * pi * cycles), is_halfway, std::complex<float>(cis_cycles(cycles / 2))},
                   g.samples, u, frame.level.slope);
}

}  // namespace holotrace
