#pragma once

#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "support/devices.h"

namespace holotrace::test {

/// A device where no propagator is kept, and whose memory is released at the end. Rates are the defaults unless a test sets
/// them.
class StagesOnDevices : public OnEveryDevice {
 protected:
  StagesOnDevices() {
    drop_device_propagators();
    buffers_ = device_.use().buffers;
  }
  ~StagesOnDevices() override {
    drop_device_propagators();
    EXPECT_EQ(device_.use().buffers, buffers_) << "all memory is released";
    set_summation_rates({});
    set_device_rates({});
  }

  /// Parameters of a stage on this device, or on the one that is expected to be faster.
  template <class Params>
  Params on_device(Params params) const {
    params.device = {DeviceKind::opencl, device_.info().number};
    return params;
  }
  template <class Params>
  static Params automatic(Params params) {
    params.device.kind = DeviceKind::automatic;
    return params;
  }

  /// A processor that takes seconds for a propagation, and a device whose speed is this part of what keeps up with it.
  void make_device_fast(double moved_bytes) const {
    set_processor_rates({.samples = 2e4});
    const int number = device_.info().number;
    set_device_rates([=](Device& device) {
      return device.info().number == number ? DeviceRates{0, 1e15, moved_bytes} : DeviceRates();
    });
  }

  size_t buffers_ = 0;
};

}  // namespace holotrace::test
