#pragma once

#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/descent_loops.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"

namespace holotrace {

/// A frame of a gradient descent on a device; complex panels have moduli.
struct DeviceFrame {
  DeviceDrive level, modulus;
};

/// A DrivenPanel on a device: phase panels without effects, of one sample per pixel.
class DeviceDrivenPanel {
 public:
  DeviceDrivenPanel(Device& device, const DrivenPanel& panel) : device_(device), panel_(panel) {}

  /// Writes the light that leaves the panel, for the frame's rounded levels, to `u`.
  void leave(const DeviceFrame& frame, const DeviceBuffer& u) const;

  /// Adds factor·∂f/∂level to the frame's slope, given g = ∂f/∂Re u + i·∂f/∂Im u (DrivenPanel::add_slope).
  void add_slope(const DeviceFrame& frame, const DeviceBuffer& u, const DeviceBuffer& g, double factor,
                 const PanelDetail& detail) const;

 private:
  Device& device_;
  const DrivenPanel& panel_;
};

}  // namespace holotrace
