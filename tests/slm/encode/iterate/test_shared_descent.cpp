// Gradient descent whose frames are shared among several equal devices, or come and go because they do not fit in a device's
// memory. A machine with one device has two of them with HOLOTRACE_SPLIT_DEVICES=2 in the environment, by which ctest runs
// the tests of several devices once more.

#include <gtest/gtest.h>

#include <set>

#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/iterate/iteration_devices.h"
#include "holotrace/wave/propagate/propagate.h"
#include "slm/encode/iterate/descent_gradients.h"

namespace holotrace {
namespace {

using test::are_same;
using test::descent_cases;
using test::DescentCase;
using test::expect_near;
using test::Gradient;
using test::gradient_of;

std::vector<Hologram> found(const DescentCase& one, const EncodeParams& params, const Observer& observer = {}) {
  std::vector<Hologram> frames = one.start();
  descend(one.targets(), one.slm, params, observer, frames);
  return frames;
}

EncodeParams on(EncodeParams params, const DeviceChoice& device) {
  params.device = device;
  return params;
}

void expect_equal(const Gradient& found, const Gradient& expected, const std::string& name) {
  EXPECT_EQ(found.numbers, expected.numbers) << name;
  ASSERT_EQ(found.slopes.size(), expected.slopes.size()) << name;
  for (size_t m = 0; m < found.slopes.size(); ++m) EXPECT_EQ(found.slopes[m].values, expected.slopes[m].values) << name;
}

class SeveralDescentDevices : public ::testing::Test {
 protected:
  void SetUp() override {
    if (test::device_numbers().empty()) GTEST_SKIP() << "no OpenCL device here";
    devices_ = open_equal_devices(0, 2);
    if (devices_.size() < 2) GTEST_SKIP() << "one device of its kind";
  }
  void TearDown() override {
    for (Device* const device : devices_) {
      device->limit_memory(0);
      EXPECT_EQ(device->use().buffers, 0u) << "all memory is released";
    }
    set_summation_rates({});
    set_device_rates({});
  }

  static constexpr DeviceChoice all{DeviceKind::all}, first{DeviceKind::opencl};
  std::vector<Device*> devices_;
};

TEST_F(SeveralDescentDevices, HaveTheSumsAndSlopesOfTheProcessor) {
  const std::set<std::string> names{"three frames",          "views alone", "two colours", "crosstalk",
                                    "phases and amplitudes", "views",       "an odd size"};
  for (DescentCase one : descent_cases()) {
    if (names.count(one.name) == 0) continue;
    one.frames = std::max(one.frames, 3);  // one for the first device, two for the second
    const std::vector<Hologram> start = one.start();
    ProcessorFrames on_processor(one.slm, one.params, start);
    DeviceFrames there(devices_, one.slm, one.params, start);
    ASSERT_EQ(there.shares().size(), 2u);
    EXPECT_EQ(there.shares()[0]->frames() + there.shares()[1]->frames(), start.size());
    expect_near(gradient_of(one, there, {}), gradient_of(one, on_processor, {}), one.name);
  }
}

// The mean of the frames is added up in another order, so levels differ by rounding, and the loss by less than 0.1 dB (2 %), as that
// of one device does from the processor's.
TEST_F(SeveralDescentDevices, ReachTheLossOfOne) {
  DescentCase one{"three frames", 3};
  one.params.iterations = 12;
  Heard of_one, of_all;
  found(one, on(one.params, first), of_one.observer());
  const std::vector<size_t> before{devices_[0]->use().kernels, devices_[1]->use().kernels};
  const std::vector<Hologram> levels = found(one, on(one.params, all), of_all.observer());
  for (size_t i = 0; i < 2; ++i) EXPECT_GT(devices_[i]->use().kernels, before[i]) << i;
  for (const char* fact : {"loss_first", "loss_last", "target_efficiency"})
    EXPECT_NEAR(of_all.number(fact), of_one.number(fact), 0.02 * of_one.number(fact)) << fact;
  EXPECT_EQ(std::get<int64_t>(of_all.facts.at("devices")), 2);
  EXPECT_EQ(of_one.facts.count("devices"), 0u);
  EXPECT_TRUE(are_same(levels, found(one, on(one.params, all)))) << "same input and devices, same bytes";
}

// Those that are left over have nothing to do.
TEST_F(SeveralDescentDevices, MayBeMoreThanTheFrames) {
  DescentCase one{"one frame"};
  one.params.iterations = 3;
  const std::vector<Hologram> expected = found(one, on(one.params, first));
  const size_t before = devices_[1]->use().kernels;
  EXPECT_TRUE(are_same(found(one, on(one.params, all)), expected));
  EXPECT_EQ(devices_[1]->use().kernels, before);
}

// Of an update with one plane: a part of the mean leaves the second device and arrives at the first, and a factor goes back; row
// sums leave the first.
TEST_F(SeveralDescentDevices, ExchangeTheLightOfThePlanesOnly) {
  DescentCase one{"two frames", 2};
  one.params.target_distances = {0.006};
  const auto use = [&](int iterations) {
    one.params.iterations = iterations;
    std::vector<size_t> counts;
    for (const Device* const device : devices_)
      counts.insert(counts.end(), {device->use().bytes_in, device->use().bytes_out});
    found(one, on(one.params, all));
    for (size_t i = 0; i < 2; ++i) {
      counts[2 * i] = devices_[i]->use().bytes_in - counts[2 * i];
      counts[2 * i + 1] = devices_[i]->use().bytes_out - counts[2 * i + 1];
    }
    return counts;
  };
  const std::vector<size_t> four = use(4), three = use(3);
  const size_t plane = size_t(one.slm.grid.pixels()) * sizeof(float), rows = size_t(one.slm.grid.ny) * sizeof(float);
  EXPECT_EQ(four[0] - three[0], plane);
  EXPECT_EQ(four[1] - three[1], plane + 3 * rows);
  EXPECT_EQ(four[2] - three[2], plane);
  EXPECT_EQ(four[3] - three[3], plane);
}

TEST_F(SeveralDescentDevices, GoOnFromACheckpoint) {
  DescentCase one{"three frames", 3};
  one.params.iterations = 6;
  std::optional<IterationState> kept;
  int updates = 0;
  const Checkpoint checkpoint{.load = [&](const IterationState&) { return kept; },
                              .save = [&](const IterationState& now) { kept = now; },
                              .is_due = [] { return false; },
                              .is_stopping = [&] { return ++updates == 4; }};
  const EncodeParams params = on(one.params, all);
  const auto descended = [&] {
    std::vector<Hologram> frames = one.start();
    descend(one.targets(), one.slm, params, {}, frames, checkpoint);
    return frames;
  };
  EXPECT_EQ(error_of([&] { descended(); }).substr(0, 13), "stopped after");
  EXPECT_TRUE(are_same(descended(), found(one, params)));
}

// One device has too little memory for its share: its frames come and go, and the bytes are the same.
TEST_F(SeveralDescentDevices, GiveTheSameBytesIfOneHasLittleMemory) {
  DescentCase one{"eight frames", 8};
  one.params.iterations = 3;
  one.params.target_distances = {0.006};
  const std::vector<Hologram> expected = found(one, on(one.params, all));
  const size_t before = devices_[1]->use().bytes_out;
  devices_[1]->limit_memory(350e3 / 0.8);  // four frames that stay take 450 kB
  EXPECT_TRUE(are_same(found(one, on(one.params, all)), expected));
  EXPECT_GT(devices_[1]->use().bytes_out - before, 3u * 4 * 4 * 4 * size_t(one.slm.grid.pixels()))
      << "four arrays of each of its frames return in each update";
}

TEST_F(SeveralDescentDevices, StopIfOneOfThemFails) {
  DescentCase one{"two frames", 2};
  one.params.iterations = 1;
  devices_[1]->limit_memory(1e3);
  const std::string error = error_of([&] { found(one, on(one.params, all)); });
  EXPECT_EQ(error.rfind("expected ", 0), 0U) << error;
  EXPECT_NE(error.find("of memory"), std::string::npos) << error;
}

// Under `auto` the processor does all of it, with one warning.
TEST_F(SeveralDescentDevices, GiveWayToTheProcessorIfOneOfThemFails) {
  DescentCase one{"eight frames", 8};
  one.params.iterations = 1;
  test::set_processor_rates({.samples = 2e4});
  set_device_rates([=](Device&) { return DeviceRates{0, 1e12, 1e9}; });
  const EncodeParams automatic = on(one.params, {DeviceKind::automatic});
  ASSERT_EQ(devices_for_descent(one.targets().planes, {one.slm, automatic}, 8).size(), 2u);
  devices_[1]->limit_memory(1e3);
  const std::string error = error_of([&] { found(one, on(one.params, all)); });
  Heard heard;
  EXPECT_TRUE(are_same(found(one, automatic, heard.observer()), found(one, one.params)));
  ASSERT_EQ(heard.warnings.size(), 1u);
  EXPECT_EQ(heard.warnings[0], "the device auto: the processor took over, because " + error);
}

// Rates for which one device takes 10 ms for 8 frames. A slow bus makes the exchange cost more than it saves.
TEST_F(SeveralDescentDevices, AreTakenByAutoIfTheirExchangePays) {
  const DescentCase one{"eight frames", 8};
  test::set_processor_rates({.samples = 2e4});
  const auto chosen = [&](double bus, size_t frames) {
    set_device_rates([=](Device&) { return DeviceRates{0, bus, 1e9}; });
    const EncodeParams params = on(one.params, {DeviceKind::automatic});
    return devices_for_descent(one.targets().planes, {one.slm, params}, frames).size();
  };
  EXPECT_EQ(chosen(1e12, 8), 2u);
  EXPECT_EQ(chosen(1e6, 8), 1u);
  EXPECT_EQ(chosen(1e12, 1), 1u);
}

class StreamedDescents : public test::DescentsOnDevices {
 protected:
  void leave_memory(double bytes) { device_.limit_memory((double(device_.use().bytes_held) + bytes) / 0.8); }
};

HOLOTRACE_FOR_ALL_DEVICES(StreamedDescents);

// Light of frames that come and go is computed again, in the same way. A need of more memory than the device has makes them
// come and go.
TEST_P(StreamedDescents, HaveTheSumsAndSlopesOfFramesThatStay) {
  for (const DescentCase& one : descent_cases()) {
    const std::vector<Hologram> start = one.start();
    Gradient expected;
    {
      DeviceFrames stay({&device_}, one.slm, one.params, start);
      expected = gradient_of(one, stay, {});
      EXPECT_FALSE(stay.shares().front()->are_streamed());
    }
    DeviceFrames come_and_go({&device_}, one.slm, one.params, start);
    FramesOnDevice& share = *come_and_go.shares().front();
    share.needs({.of_frame = 0, .beside = device_.memory_left() + 1});
    expect_equal(gradient_of(one, come_and_go, {}), expected, one.name);
    EXPECT_TRUE(share.are_streamed());
  }
}

// Least memory for which the frames stay, by bisection: with 40 kB less they come and go, and the bytes are the same. Far less
// does not suffice for a single frame.
TEST_P(StreamedDescents, AreMadeByTheLimitOfMemory) {
  DescentCase one{"eight frames", 8};
  one.params.iterations = 3;
  one.params.target_distances = {0.006};
  const size_t start = device_.use().bytes_in;
  const std::vector<Hologram> expected = found(one, on_device(one.params));
  const size_t sent = device_.use().bytes_in - start;
  const auto sent_with = [&](double bytes) {
    leave_memory(bytes);
    const size_t before = device_.use().bytes_in;
    EXPECT_TRUE(are_same(found(one, on_device(one.params)), expected)) << bytes;
    return device_.use().bytes_in - before;
  };
  double streamed = 600e3, staying = 2e6;
  ASSERT_GT(sent_with(streamed), sent);
  ASSERT_EQ(sent_with(staying), sent);
  while (staying - streamed > 40e3) {
    const double middle = (streamed + staying) / 2;
    (sent_with(middle) > sent ? streamed : staying) = middle;
  }
  // Of each frame 20 bytes of levels, the light that leaves and two samples of the plane, per pixel.
  const double of_frames = 8 * (20 + 8 + 2 * 8) * double(one.slm.grid.pixels());
  EXPECT_GT(staying, of_frames);
  EXPECT_LT(staying, 2 * of_frames);
  // 16 bytes per pixel come for each plane of an update, 16 for the step, and 4 for the judgement.
  const size_t pixels = size_t(one.slm.grid.pixels());
  EXPECT_EQ(sent_with(streamed), sent - 8 * 8 * pixels + 8 * pixels * (3 * (12 + 16) + 4));
  leave_memory(100e3);
  const std::string error = error_of([&] { found(one, on_device(one.params)); });
  EXPECT_NE(error.find("of memory for "), std::string::npos) << error;
}

TEST_P(StreamedDescents, TakeTheMemoryOfKeptTransferFunctions) {
  DescentCase one{"eight frames", 8};
  Field field(one.slm.grid, 532e-9, 0);
  field.samples.values.assign(field.samples.size(), 1);
  propagate(field, 0.01, on_device(PropagateParams{}));
  ASSERT_GT(device_.use().bytes_held, 0u);
  devices_for_descent(one.targets().planes, {one.slm, on_device(one.params)}, 8);
  EXPECT_EQ(device_.use().bytes_held, 0u);
}

TEST_P(StreamedDescents, CountForAuto) {
  DescentCase one{"eight frames", 8};
  one.params.target_distances = {0.006};
  test::set_processor_rates({.samples = 2e6});
  const auto is_taken = [&](double bus) {
    set_device_rates([=](Device&) { return DeviceRates{0, bus, 1e12}; });
    return !devices_for_descent(one.targets().planes, {one.slm, automatic(one.params)}, 8).empty();
  };
  EXPECT_TRUE(is_taken(3e5));
  leave_memory(600e3);
  EXPECT_TRUE(is_taken(1e12)) << "frames may come and go";
  EXPECT_FALSE(is_taken(3e5)) << "but that takes time";
  leave_memory(100e3);
  EXPECT_FALSE(is_taken(1e12)) << "not a single frame fits";
}

TEST(SeveralDevicesForOtherMethods, AreRefused) {
  const DescentCase one{"one"};
  Field field(one.slm.grid, 532e-9, 0);
  field.samples.values[0] = 1;
  for (const Encoding method : {Encoding::gerchberg_saxton, Encoding::phase}) {
    EncodeParams params{.method = method};
    params.device = {DeviceKind::all};
    EXPECT_EQ(
        error_of([&] { encode(field, one.slm, params); }),
        "expected one device for this method, got opencl:all; only the sum of waves and the method sgd run on all "
        "devices at once; use opencl or opencl:N");
  }
}

}  // namespace
}  // namespace holotrace
