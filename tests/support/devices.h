#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/data/params/device.h"
#include "holotrace/opencl/device.h"

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

/// Tests with a parameter int, the number of a device.
class OnEveryDevice : public ::testing::TestWithParam<int> {
 protected:
  Device& device_ = open_device(GetParam());
};

}  // namespace holotrace::test

/// Instantiates a fixture derived from OnEveryDevice for all devices of this machine, which may be none.
#define HOLOTRACE_FOR_ALL_DEVICES(Fixture)                                                            \
  GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Fixture);                                             \
  INSTANTIATE_TEST_SUITE_P(OpenCl, Fixture, ::testing::ValuesIn(::holotrace::test::device_numbers()), \
                           [](const auto& info) { return "device" + std::to_string(info.param); })
