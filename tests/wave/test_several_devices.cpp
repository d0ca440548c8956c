// The sum of waves on several equal devices at once. A machine with one device has them with HOLOTRACE_SPLIT_DEVICES=2 in the
// environment, by which ctest runs these tests once more.

#include <gtest/gtest.h>

#include <algorithm>

#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/tiles/device_tiles.h"
#include "support/devices.h"
#include "support/error_of.h"
#include "support/fields.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;

class SeveralDevices : public ::testing::Test {
 protected:
  void SetUp() override {
    if (test::device_numbers().empty()) GTEST_SKIP() << "no OpenCL device here";
    devices_ = open_equal_devices(0);
    if (devices_.size() < 2) GTEST_SKIP() << "one device of its kind";
  }
  void TearDown() override {
    for (Device* const device : devices_) EXPECT_EQ(device->use().buffers, 0u);
  }
  static Field sum_on(const DeviceChoice& device, SynthesisMethod method) {
    SynthesizeParams params{method, 1e-3};
    params.device = device;
    return synthesize(sources(), panel, params);
  }
  static Sources sources() { return make_random_sources(300, panel, green, 0.19_m, 0.21_m, 0.5); }

  static constexpr Grid panel{310, 250, 8e-6};
  std::vector<Device*> devices_;
};

// Tiles and packets are the same, wherever a band is computed. All devices work: about half of the samples come from each.
TEST_F(SeveralDevices, GiveTheBytesOfOne) {
  for (const SynthesisMethod method : {SynthesisMethod::tiled, SynthesisMethod::planes}) {
    const Field one = sum_on({DeviceKind::opencl}, method);
    std::vector<size_t> before;
    for (const Device* const device : devices_) before.push_back(device->use().bytes_out);
    EXPECT_EQ(sum_on({DeviceKind::all}, method).samples.values, one.samples.values) << method_name(method);
    size_t all = 0;
    for (size_t i = 0; i < devices_.size(); ++i) {
      const size_t fetched = devices_[i]->use().bytes_out - before[i];
      EXPECT_GT(fetched, 0u) << i;
      all += fetched;
    }
    EXPECT_EQ(all, 8u * size_t(panel.pixels()));
  }
}

// Devices of 20 units want 160 groups: the 80 tiles of the whole panel are summed in two slices of the waves, on any number of
// devices.
TEST_F(SeveralDevices, GiveTheBytesOfOneInSlicesOfTheWaves) {
  const auto with_many_units = [&](size_t i) {
    DeviceInfo info = devices_[i]->info();
    info.compute_units = 20;
    return info;
  };
  Device first(with_many_units(0)), second(with_many_units(1));
  const Sources many = make_random_sources(3000, panel, green, 0.19_m, 0.21_m);
  const auto sum = [&](const std::vector<Device*>& devices) {
    Field field(panel, green);
    sum_tiles_on_devices(devices, prepare_waves(many, panel), {panel, green}, {32, 32}, {0, panel.nx, 0, panel.ny},
                         field.samples, {});
    return field.samples.values;
  };
  const auto one = sum({&first});
  EXPECT_EQ(sum({&first, &second}), one);
  EXPECT_NE(sum({devices_[0]}), one) << "without slices";
}

// A device with less memory than the other computes its rows in more bands.
TEST_F(SeveralDevices, GiveTheSameBytesIfOneHasLittleMemory) {
  const Field one = sum_on({DeviceKind::opencl}, SynthesisMethod::tiled);
  devices_[1]->limit_memory(400e3);  // its half of the field takes 320 kB
  EXPECT_EQ(sum_on({DeviceKind::all}, SynthesisMethod::tiled).samples.values, one.samples.values);
  devices_[1]->limit_memory(0);
}

TEST_F(SeveralDevices, StopIfOneOfThemFails) {
  devices_[1]->limit_memory(1e3);
  const std::string error = error_of([] { sum_on({DeviceKind::all}, SynthesisMethod::tiled); });
  devices_[1]->limit_memory(0);
  EXPECT_EQ(error.rfind("expected ", 0), 0U) << error;
  EXPECT_NE(error.find("of memory"), std::string::npos) << error;
}

TEST_F(SeveralDevices, ReportProgressUpToTheWhole) {
  std::vector<double> fractions;
  Observer observer;
  observer.on_progress = [&](double fraction) { fractions.push_back(fraction); };
  SynthesizeParams params{SynthesisMethod::tiled, 1e-3};
  params.device = {DeviceKind::all};
  synthesize(sources(), panel, params, observer);
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_NEAR(fractions.back(), 1, 1e-12);
}

// More devices than rows of tiles: some have nothing to do.
TEST_F(SeveralDevices, MayBeMoreThanTheRowsOfTiles) {
  const Grid small{40, 3, 8_um};
  const Sources few = make_random_sources(5, small, green, 0.19_m, 0.21_m);
  SynthesizeParams params{SynthesisMethod::tiled, 1e-3};
  params.device = {DeviceKind::opencl};
  const Field one = synthesize(few, small, params);
  params.device = {DeviceKind::all};
  EXPECT_EQ(synthesize(few, small, params).samples.values, one.samples.values);
}

TEST(OneDevice, IsWhatAPropagationExpects) {
  PropagateParams params;
  params.device = {DeviceKind::all};
  const Field field({4, 4, 8_um}, green);
  const std::string expected = "expected one device for a propagation, got opencl:all";
  EXPECT_EQ(error_of([&] { propagate_on_device(field, 0.1, params); }).rfind(expected, 0), 0U);
  EXPECT_EQ(error_of([&] { refuse_device_for_double(params); }).rfind(expected, 0), 0U);
}

}  // namespace
}  // namespace holotrace
