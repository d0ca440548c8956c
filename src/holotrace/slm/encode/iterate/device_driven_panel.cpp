#include "holotrace/slm/encode/iterate/device_driven_panel.h"

#include "holotrace/base/cycles.h"
#include "holotrace/base/units.h"

namespace holotrace {

void DeviceDrivenPanel::leave(const DeviceFrame& frame, const DeviceBuffer& u) const {
  leave_phases(device_, float(panel_.cycles_per_level()), frame.level.rounded, u);
}

void DeviceDrivenPanel::add_slope(const DeviceFrame& frame, const DeviceBuffer& u, const DeviceBuffer& g, double factor,
                                  const PanelDetail& detail) const {
  const double cycles = panel_.cycles_per_level();
  add_phase_slopes(
      device_,
      {float(factor * 2 * pi * cycles), panel_.takes_middle(detail), std::complex<float>(cis_cycles(cycles / 2))}, g, u,
      frame.level.slope);
}

}  // namespace holotrace
