#pragma once

#include <gtest/gtest.h>

#include <limits>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "support/devices.h"

namespace holotrace::test {

using namespace literals;

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

// Floats, as the processor's: about ten roundings of 3e-8 in quadrature in each of four transforms, and 1e-6 of the smooth
// edges of kernels between two pitches. The processor's tests have the same bound.
inline constexpr double propagation_rounding = 2e-6;

/// Windows for a field of 66 x 49 samples of 8 µm.
inline const PropagateParams all_kinds_of_windows[] = {
    {},                                                                // on the axis: an even transfer function
    {PropagationMethod::automatic, 75, 58, 0, 24.3_um, -16_um},        // other sizes
    {PropagationMethod::automatic, 64, 47, 0, 120_um, -64_um},         // shifted
    {PropagationMethod::automatic, 80, 61, 0, 3.7_um, -51.3_um},       // by parts of a sample
    {PropagationMethod::automatic, 40, 40, 0, 300_um, 0.25_mm},        // beside the input
    {PropagationMethod::automatic, 31, 40, 16_um, 0, 0},               // plain transforms
    {PropagationMethod::automatic, 44, 51, 12_um, -33_um, 7_um},       // the same
    {PropagationMethod::automatic, 101, 64, 5.3217_um, 40_um, -90_um}  // chirps
};

/// A field, and a device where no propagator is kept. Rates and limits are reset at the end.
class PropagationOnDevices : public OnEveryDevice {
 protected:
  PropagationOnDevices() {
    drop_device_propagators();
    start_ = device_.use().bytes_held;
    params_.device = {DeviceKind::opencl, device_.info().number};
    CounterRandom random(11, 0, 0);
    for (auto& u : field_.samples.values) u = {float(random.uniform()) - 0.5F, float(random.uniform()) - 0.5F};
  }
  ~PropagationOnDevices() override {
    device_.limit_memory(0);
    limit_device_propagators(unlimited);
    drop_device_propagators();
    set_summation_rates({});
    set_device_rates({});
  }

  Field there(double distance) const { return propagate(field_, distance, params_); }
  size_t sent_for(double distance) const {
    const size_t before = device_.use().bytes_in;
    there(distance);
    return device_.use().bytes_in - before;
  }
  size_t held() const { return device_.use().bytes_held - start_; }
  Propagator<float> plan(double distance, const PropagateParams& params = {}) const {
    return plan_propagator<float>(field_.grid, field_.wavelength, distance, params);
  }
  DeviceUse forecast(double distance, const PropagateParams& params = {}) const {
    return forecast_propagation(device_, plan(distance, params));
  }
  // 80 % of the memory are used; 1 byte for the rounding of that product.
  void leave_memory(double bytes) { device_.limit_memory((double(device_.use().bytes_held) + bytes) / 0.8 + 1); }

  Field field_{{66, 49, 8_um}, 532_nm};
  PropagateParams params_;
  size_t start_ = 0;
};

}  // namespace holotrace::test
