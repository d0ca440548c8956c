// Propagation on every OpenCL device, against the processor's in double.

#include <gtest/gtest.h>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "support/devices.h"
#include "support/fields.h"
#include "wave/propagate/propagation_on_devices.h"

namespace holotrace {
namespace {

using namespace literals;
using test::relative_error;

class DevicePropagation : public test::OnEveryDevice {
 protected:
  static FieldDouble white_noise(const Grid& grid) {
    FieldDouble field(grid, 532_nm);
    CounterRandom random(7, 0, 0);
    for (auto& u : field.samples.values) u = {random.uniform() - 0.5, random.uniform() - 0.5};
    return field;
  }

  double error_for(double distance, const PropagateParams& params) {
    const FieldDouble field = white_noise(grid_);
    const auto expected = propagate(field, make_propagator<double>(grid_, field.wavelength, distance, params));
    DevicePropagator propagator(device_, make_propagator<float>(grid_, field.wavelength, distance, params));
    return relative_error(propagator(convert<float>(field)), expected);
  }

  Grid grid_{66, 49, 8_um, 24.3_um, -16_um};
};

HOLOTRACE_FOR_ALL_DEVICES(DevicePropagation);

TEST_P(DevicePropagation, AgreesWithTheProcessorForAllWindowsAndMethods) {
  for (const double distance : {0.03_m, -0.05_m, 2_mm})
    for (PropagateParams params : test::all_kinds_of_windows) {
      EXPECT_LT(error_for(distance, params), test::propagation_rounding) << distance << ", " << params.columns;
      params.method = PropagationMethod::fresnel;
      EXPECT_LT(error_for(distance, params), test::propagation_rounding)
          << "Fresnel, " << distance << ", " << params.columns;
    }
}

// 66 = 2·3·11 and 49 = 7²: periods with other factors than 2, 3 and 5.
TEST_P(DevicePropagation, AgreesWithTheProcessorForPeriodicWindows) {
  PropagateParams params;
  params.is_periodic = true;
  EXPECT_LT(error_for(0.3_m, params), test::propagation_rounding);
  params.columns = 100;
  params.centre_x = 40_um;
  EXPECT_LT(error_for(-0.01_m, params), test::propagation_rounding);
}

// A padded period of 2 · 4320 samples: lines in global memory.
TEST_P(DevicePropagation, AgreesWithTheProcessorForLongLines) {
  grid_ = {4200, 6, 8_um};
  EXPECT_LT(error_for(0.02_m, {PropagationMethod::fresnel}), test::propagation_rounding);
}

TEST_P(DevicePropagation, TransfersTheFieldsAndKeepsTheRest) {
  const Field field = convert<float>(white_noise(grid_));
  const PropagateParams params{PropagationMethod::automatic, 40, 30};
  const DeviceUse start = device_.use();
  {
    DevicePropagator propagator(device_, make_propagator<float>(grid_, field.wavelength, 0.03_m, params));
    const Field first = propagator(field);
    const DeviceUse before = device_.use();
    const Field second = propagator(field);
    const DeviceUse after = device_.use();
    EXPECT_EQ(after.bytes_in - before.bytes_in, 8u * 66 * 49);
    EXPECT_EQ(after.bytes_out - before.bytes_out, 8u * 40 * 30);
    EXPECT_EQ(after.bytes_held, before.bytes_held);
    EXPECT_EQ(second.samples.values, first.samples.values);
    EXPECT_EQ(second.z, field.z + 0.03);
  }
  EXPECT_EQ(device_.use().bytes_held, start.bytes_held);
}

TEST_P(DevicePropagation, SaysThatMemoryIsShortBeforeItStarts) {
  const Field field = convert<float>(white_noise(grid_));
  DevicePropagator propagator(device_, make_propagator<float>(grid_, field.wavelength, 0.03_m));
  const DeviceUse before = device_.use();
  device_.limit_memory(double(before.bytes_held) * 1.25 + 80e3);  // of which 80 % may be used: 64 kB more
  std::string error;
  try {
    propagator(field);
  } catch (const Error& e) {
    error = e.what();
  }
  device_.limit_memory(0);
  EXPECT_NE(error.find("of memory for a propagation on the device " + device_.info().name), std::string::npos) << error;
  EXPECT_EQ(device_.use().kernels, before.kernels);
  EXPECT_EQ(device_.use().bytes_held, before.bytes_held);
}

TEST_P(DevicePropagation, RefusesFieldsOfAnotherGrid) {
  DevicePropagator propagator(device_, make_propagator<float>(grid_, 532_nm, 0.03_m));
  EXPECT_THROW(propagator(Field({66, 50, 8_um}, 532_nm)), Error);
}

TEST_P(DevicePropagation, WritesNothingPastItsBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  for (const PropagateParams& params : test::all_kinds_of_windows) error_for(0.03_m, params);
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

}  // namespace
}  // namespace holotrace
