#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/data/params/device.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/shared/cost_model.h"

// Tests of stages run on the processor and on every OpenCL device of the machine. scripts/setup installs PoCL, so that
// there is at least one.

namespace holotrace::test {

/// The numbers of all OpenCL devices; none in a build or on a machine without OpenCL.
inline std::vector<int> device_numbers() {
  std::vector<int> numbers;
  try {
    for (const DeviceInfo& info : list_devices()) numbers.push_back(info.number);
  } catch (const Error&) {
    // No OpenCL here.
  }
  return numbers;
}

inline std::vector<DeviceChoice> processor_and_devices() {
  std::vector<DeviceChoice> choices{{DeviceKind::cpu}};
  for (const int number : device_numbers()) choices.push_back({DeviceKind::opencl, number});
  return choices;
}

/// "cpu", "opencl1": a name for a test.
inline std::string device_name(const DeviceChoice& choice) {
  return choice.kind == DeviceKind::cpu ? "cpu" : "opencl" + std::to_string(choice.number);
}

inline std::string device_name_of(const ::testing::TestParamInfo<DeviceChoice>& info) {
  return device_name(info.param);
}

/// Whatever processor runs the test, forecasts take it for one that has these rates with all of its threads together.
inline void set_processor_rates(SummationRates rates) {
  for (const SummationTerm& term : summation_terms) rates.*term.rate /= processor_threads();
  set_summation_rates([rates] { return rates; });
}

/// Tests with a parameter int, the number of a device. What they change of it is undone at the end, also if they fail.
class OnEveryDevice : public ::testing::TestWithParam<int> {
 protected:
  ~OnEveryDevice() override {
    device_.limit_memory(0);
    device_.guard_buffers(false);
    device_.limit_groups(0);
  }
  Device& device_ = open_device(GetParam());
};

}  // namespace holotrace::test

/// Instantiates a fixture derived from OnEveryDevice for all devices of this machine, which may be none.
#define HOLOTRACE_FOR_ALL_DEVICES(Fixture)                                                            \
  GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Fixture);                                             \
  INSTANTIATE_TEST_SUITE_P(OpenCl, Fixture, ::testing::ValuesIn(::holotrace::test::device_numbers()), \
                           [](const auto& info) { return "device" + std::to_string(info.param); })
