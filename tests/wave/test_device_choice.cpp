// How `auto` chooses between the processor and devices, with rates that are made up.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "holotrace/wave/synthesize.h"
#include "support/build_paths.h"
#include "support/devices.h"
#include "support/fields.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

using namespace literals;

constexpr Grid chosen_panel{256, 192, 8e-6};

class AutomaticDevice : public ::testing::Test {
 protected:
  void SetUp() override {
    if (test::device_numbers().empty()) GTEST_SKIP() << "no OpenCL device here";
    params_.device.kind = DeviceKind::automatic;
    params_.method = SynthesisMethod::tiled;
  }
  void TearDown() override {
    set_summation_rates({});
    set_device_rates({});
  }

  // The processor takes 50 waves · 49152 pixels · 3 multiply-adds / 1e6 = 7 s and more.
  static void slow_down_the_processor() {
    SummationRates rates;
    rates.multiply_adds = 1e6;
    set_summation_rates([rates] { return rates; });
  }
  static void give_devices(const DeviceRates& rates) {
    set_device_rates([rates](Device&) { return rates; });
  }
  DeviceKind chosen() const { return chosen_device(sources_, chosen_panel, params_).kind; }

  const Sources sources_ = test::make_random_sources(50, chosen_panel, 532_nm, 0.1_m, 0.2_m);
  SynthesizeParams params_;
};

TEST_F(AutomaticDevice, IsTheFasterOne) {
  slow_down_the_processor();
  give_devices({1e12, 1e10});
  EXPECT_EQ(chosen(), DeviceKind::opencl);
  give_devices({1e5, 1e10});  // 100 s
  EXPECT_EQ(chosen(), DeviceKind::cpu);
}

// 2 s for what kernels move, 3 s for what is transferred, and 0.3 ms for each of 4 transfers.
TEST(DeviceSeconds, AreThoseOfKernelsTransfersAndWaiting) {
  DeviceUse use;
  use.bytes_moved = 2'000'000;
  use.bytes_in = 1000;
  use.bytes_out = 2000;
  use.transfers = 4;
  EXPECT_DOUBLE_EQ(predict_seconds(use, DeviceRates{0, 1e3, 1e6}), 2 + 3 + 4 * 3e-4);
  EXPECT_EQ(predict_seconds(DeviceUse{}, DeviceRates{}), 0) << "rates that were not measured";
  EXPECT_TRUE(std::isinf(predict_seconds(use, DeviceRates{})));
}

TEST_F(AutomaticDevice, CountsTransfers) {
  slow_down_the_processor();
  give_devices({1e12, 1e4});  // 8 bytes a sample take 39 s
  EXPECT_EQ(chosen(), DeviceKind::cpu);
}

TEST_F(AutomaticDevice, IsTheProcessorForShortSumsAndDevicesThatWereNotMeasured) {
  give_devices({1e15, 1e15});
  EXPECT_EQ(chosen(), DeviceKind::cpu) << "a sum of a millisecond";
  slow_down_the_processor();
  set_device_rates({});
  EXPECT_EQ(chosen(), DeviceKind::cpu);
  give_devices({1e15, 1e15});
  params_.method = SynthesisMethod::exact;
  EXPECT_EQ(chosen(), DeviceKind::cpu) << "a method of the processor";
}

TEST_F(AutomaticDevice, LeavesOtherChoicesAlone) {
  params_.device = {DeviceKind::opencl, 3};
  EXPECT_EQ(chosen_device(sources_, chosen_panel, params_), params_.device);
}

// Opening takes 0.3 s. ctest runs each test in a process of its own, where no device is open.
TEST_F(AutomaticDevice, CountsItsOpeningOnce) {
  if (!open_devices().empty()) GTEST_SKIP() << "a device is open";
  const auto at_once = [](Device&) { return 0.0; };
  EXPECT_EQ(fastest_device(0.29, at_once), nullptr);
  EXPECT_EQ(fastest_device(0.31, [](Device&) { return 0.02; }), nullptr);
  for (const int number : test::device_numbers()) open_device(number);
  EXPECT_EQ(open_devices(), test::device_numbers());
  EXPECT_NE(fastest_device(0.29, at_once), nullptr);
  EXPECT_EQ(fastest_device(0.29, [](Device&) { return 0.29; }), nullptr);
}

TEST_F(AutomaticDevice, IsTheFastestOfThose) {
  const Device* const last = &open_device(test::device_numbers().back());
  EXPECT_EQ(fastest_device(1, [&](Device& device) { return &device == last ? 0.1 : 0.5; }), last);
  EXPECT_EQ(fastest_device(1, [](Device&) -> double { throw Error("a device that fails"); }), nullptr);
}

#if HOLOTRACE_HAS_OPENCL

TEST_F(AutomaticDevice, IsReplacedByTheProcessorIfItFails) {
  slow_down_the_processor();
  const Field expected = synthesize(sources_, chosen_panel, {SynthesisMethod::tiled});
  give_devices({1e12, 1e10});
  std::string warning;
  Observer observer;
  observer.on_warning = [&](const std::string& text) { warning = text; };
  test::FaultyApi api;
  api.failing = 0;
  EXPECT_EQ(synthesize(sources_, chosen_panel, params_, observer).samples.values, expected.samples.values);
  EXPECT_EQ(warning.rfind("the device auto: the processor took over, because expected ", 0), 0U) << warning;
  EXPECT_TRUE(api.held.empty());
}

#endif

}  // namespace
}  // namespace holotrace
