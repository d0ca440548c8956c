#pragma once

#include <optional>

#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/device_loops.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/panel/device_panel.h"

namespace holotrace {

/// A frame of a gradient descent on a device; complex panels have moduli.
struct DeviceFrame {
  DeviceDrive level, modulus;
};

/// The light that leaves a frame's panel, or what comes back to it.
struct DevicePanelLight {
  const DeviceBuffer& samples;
  DevicePanel::Memory& memory;
};

/// A DrivenPanel on a device.
class DeviceDrivenPanel {
 public:
  /// @param panel  must outlive this object
  DeviceDrivenPanel(Device& device, const DrivenPanel& panel);

  /// Memory of a call, for the most detailed light [bytes].
  double bytes_of_memory() const;

  /// Writes the light that leaves the panel, for the frame's rounded levels.
  void leave(const DeviceFrame& frame, const PanelDetail& detail, const DevicePanelLight& u);

  /// Adds factor·∂f/∂level to the frame's slopes, given g = ∂f/∂Re u + i·∂f/∂Im u, with the detail of the slopes
  /// (DrivenPanel::add_slope).
  void add_slope(const DeviceFrame& frame, const PanelDetail& detail, const DeviceBuffer& u, const DevicePanelLight& g,
                 double factor);

 private:
  DevicePanel* model(PixelDetail detail);

  Device& device_;
  const DrivenPanel& panel_;
  std::optional<DevicePanel> model_, coarse_, mean_;  // for each PixelDetail
};

}  // namespace holotrace
