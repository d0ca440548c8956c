// Gradient descent whose frames are shared among several processes. Here they are threads; tests/end_to_end/test_frame_ranks.cpp
// has ranks of mpirun.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "holotrace/base/archive.h"
#include "holotrace/data/members.h"
#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "holotrace/slm/encode/iterate/iteration_devices.h"
#include "holotrace/slm/encode/iterate/shared_frames.h"
#include "slm/encode/iterate/descent_gradients.h"
#include "slm/encode/iterate/thread_links.h"

namespace holotrace {
namespace {

using test::are_same;
using test::descent_cases;
using test::DescentCase;
using test::Gradient;
using test::gradient_of;
using test::ThreadLinks;

std::vector<Hologram> found(const DescentCase& one, ThreadLinks* links, const Observer& observer = {},
                            const Checkpoint& checkpoint = {}) {
  std::vector<Hologram> frames = one.start();
  descend(one.targets(), one.slm, one.params, observer, frames, checkpoint, links);
  return frames;
}

TEST(RangesOfFrames, AreAsEqualAsCanBeAndNeverEmpty) {
  const auto counts = [](size_t frames, int processes) {
    std::vector<size_t> counts;
    size_t next = 0;
    for (const FrameRange& range : ranges_of_frames(frames, processes)) {
      EXPECT_EQ(range.first, next);
      next = range.last;
      counts.push_back(range.count());
    }
    EXPECT_EQ(next, frames);
    return counts;
  };
  EXPECT_EQ(counts(8, 4), (std::vector<size_t>{2, 2, 2, 2}));
  EXPECT_EQ(counts(7, 3), (std::vector<size_t>{2, 2, 3}));
  EXPECT_EQ(counts(2, 5), (std::vector<size_t>{1, 1}));
}

std::shared_ptr<const Array2D<float>> even_map(const DescentCase& one, float value) {
  return std::make_shared<const Array2D<float>>(one.slm.grid.ny, one.slm.grid.nx, value);
}

DescentCase with_all_effects() {
  DescentCase one{"all effects", 2};
  one.slm.levels = 4;
  one.levels = 4;
  one.slm.fill_x = 0.8;
  one.slm.fill_y = 0.9;
  one.slm.design_wavelength = 633e-9;
  one.slm.phase_range = 5;
  one.slm.grid.centre_x = 1e-5;
  SlmEffects& effects = one.slm.effects;
  effects.calibration = {{0, 1}, {1, 0.9}, {2, 0.8}, {3, 0.7}};
  effects.crosstalk = 0.3;
  effects.gap_amplitude = 0.2;
  effects.gap_phase = 0.1;
  effects.flicker = 0.05;
  effects.aberration = {{2, 0, 0.4}};
  effects.phase_map = even_map(one, 0.5F);
  effects.light_map = even_map(one, 0.6F);
  effects.dead_fraction = 0.01;
  effects.dead_seed = 7;
  effects.dead_pixels = {{1, 2, 3}};
  one.slm.modulation = Modulation::complex;
  one.params.stop = 0.7;
  one.params.subpixels = 3;
  one.params.planes_per_update = 2;
  one.params.device = {DeviceKind::opencl, 5};
  return one;
}

FrameJob job_of(const DescentCase& one) { return {one.slm, one.params, one.start(), 9}; }

// What another process makes of a job.
FrameJob heard_by_another(const FrameJob& sent) {
  FrameJob heard = job_from(job_message(sent));
  for (size_t m = 0; m < heard.frames.size(); ++m) from_message(frame_message(sent.frames[m]), heard.frames[m]);
  return heard;
}

// The fingerprint has what a result depends on. Each property alone changes it, so that it would also tell one that is lost
// on the way.
TEST(FrameJobs, CarryAllThatTheLightDependsOn) {
  const std::map<std::string, std::function<void(DescentCase&)>> changes{
      {"nothing", [](DescentCase&) {}},
      {"pitch", [](DescentCase& one) { one.slm.grid.pitch *= 2; }},
      {"centre_x", [](DescentCase& one) { one.slm.grid.centre_x = 2e-5; }},
      {"centre_y", [](DescentCase& one) { one.slm.grid.centre_y = 2e-5; }},
      {"modulation", [](DescentCase& one) { one.slm.modulation = Modulation::phase; }},
      {"fill_x", [](DescentCase& one) { one.slm.fill_x = 0.7; }},
      {"fill_y", [](DescentCase& one) { one.slm.fill_y = 0.7; }},
      {"design_wavelength", [](DescentCase& one) { one.slm.design_wavelength = 600e-9; }},
      {"phase_range", [](DescentCase& one) { one.slm.phase_range = 6; }},
      {"phase of a level", [](DescentCase& one) { one.slm.effects.calibration[2].phase = 2.5; }},
      {"amplitude of a level", [](DescentCase& one) { one.slm.effects.calibration[2].amplitude = 0.5; }},
      {"crosstalk", [](DescentCase& one) { one.slm.effects.crosstalk = 0.4; }},
      {"gap_amplitude", [](DescentCase& one) { one.slm.effects.gap_amplitude = 0.3; }},
      {"gap_phase", [](DescentCase& one) { one.slm.effects.gap_phase = 0.2; }},
      {"flicker", [](DescentCase& one) { one.slm.effects.flicker = 0.1; }},
      {"aberration",
       [](DescentCase& one) {
         one.slm.effects.aberration = {{2, 2, 0.4}};
       }},
      {"phase_map", [](DescentCase& one) { one.slm.effects.phase_map = even_map(one, 0.6F); }},
      {"light_map", [](DescentCase& one) { one.slm.effects.light_map = even_map(one, 0.7F); }},
      {"dead_fraction", [](DescentCase& one) { one.slm.effects.dead_fraction = 0.02; }},
      {"dead_seed", [](DescentCase& one) { one.slm.effects.dead_seed = 8; }},
      {"dead_pixels",
       [](DescentCase& one) {
         one.slm.effects.dead_pixels = {{1, 2, 2}};
       }},
      {"stop", [](DescentCase& one) { one.params.stop = 0.8; }},
      {"subpixels", [](DescentCase& one) { one.params.subpixels = 5; }},
      {"planes_per_update", [](DescentCase& one) { one.params.planes_per_update = 1; }},
      {"levels of frames", [](DescentCase& one) { one.levels = 3; }}};
  std::map<uint64_t, std::string> fingerprints;
  for (const auto& [name, change] : changes) {
    DescentCase one = with_all_effects();
    change(one);
    const FrameJob sent = job_of(one), heard = heard_by_another(sent);
    ASSERT_EQ(heard.frames.size(), sent.frames.size());
    const auto fingerprint = [&](const FrameJob& job) {
      EncodeParams params = one.params;  // with those that only process 0 needs
      params.method = job.params.method;
      params.stop = job.params.stop;
      params.subpixels = job.params.subpixels;
      params.planes_per_update = job.params.planes_per_update;
      return descent_job(one.targets(), {job.slm, params}, job.frames).job;
    };
    EXPECT_EQ(fingerprint(heard), fingerprint(sent)) << name;
    const auto [other, is_new] = fingerprints.emplace(fingerprint(sent), name);
    EXPECT_TRUE(is_new) << name << " has the fingerprint of " << other->second;
    EXPECT_EQ(heard.frames_of_all, 9u);
    EXPECT_EQ(heard.params.device, sent.params.device);
  }
}

// What several processes compute of the first update, each with devices of its own or, without, on the processor.
Gradient gradient_of_shared(const DescentCase& one, int processes, const DeviceChoice& device) {
  ThreadLinks links(processes, optimise_frames_for_first_process);
  SharedFrames frames(
      links, {one.slm, one.params}, device, one.start(),
      [&](const std::vector<Hologram>& own, const OtherFrames& others, size_t fixed) -> std::unique_ptr<FrameArrays> {
        const auto devices = devices_of_process(device, links.here(), own.size());
        if (devices.empty()) return std::make_unique<ProcessorFrames>(one.slm, one.params, own, others, fixed);
        return std::make_unique<DeviceFrames>(devices, one.slm, one.params, own, others, fixed);
      });
  Gradient gradient = gradient_of(one, frames, {});
  frames.finish();
  return gradient;
}

TEST(SharedFrames, HaveTheSumsAndSlopesOfOneProcess) {
  for (DescentCase one : descent_cases()) {
    one.frames = std::max(one.frames, 2);
    ProcessorFrames alone(one.slm, one.params, one.start());
    const Gradient expected = gradient_of(one, alone, {});
    for (const int processes : {2, 3})
      test::expect_near(gradient_of_shared(one, processes, {}), expected, one.name + std::to_string(processes));
  }
}

class SharedFramesOnDevices : public test::DescentsOnDevices {};
HOLOTRACE_FOR_ALL_DEVICES(SharedFramesOnDevices);

TEST_P(SharedFramesOnDevices, HaveTheSumsAndSlopesOfOneProcess) {
  for (DescentCase one : descent_cases()) {
    one.frames = std::max(one.frames, 3);
    ProcessorFrames alone(one.slm, one.params, one.start());
    test::expect_near(gradient_of_shared(one, 2, on_device(one.params).device), gradient_of(one, alone, {}), one.name);
  }
}

// Three processes of a machine take its equal devices in turn.
TEST_P(SharedFramesOnDevices, ShareTheMemoryOfADevice) {
  const DeviceChoice choice{DeviceKind::opencl, device_.info().number};
  const size_t equals = equal_devices(list_devices(), choice.number).size();
  for (const int count : {1, 3}) {
    Device& device = *devices_of_process(choice, {0, count}, 1).at(0);
    const double sharing = std::ceil(double(count) / double(equals));
    EXPECT_NEAR(device.memory(), 0.8 * device.info().memory / sharing, 1);
    device.limit_memory(0);
  }
}

// The mean that processes exchange takes time on the way to a device and back: for one plane 7 kB there and back, twice in each of
// 200 updates, 5.5 MB. Without it a device only gets a transfer function and a target, some 0.1 MB.
TEST_P(SharedFramesOnDevices, CountTheirExchangeForAuto) {
  DescentCase one{"frames"};
  one.params.target_distances = {0.006};
  one.params.iterations = 200;
  const DescentSetup setup{one.slm, automatic(one.params)};
  test::set_processor_rates({.fft_operations = 1e6, .samples = 1e6});
  const auto takes_device = [&](double bytes, const SharedCount& frames) {
    set_device_rates([=](Device&) { return DeviceRates{0, bytes, 1e15}; });
    return common_device(one.targets().planes, setup, frames, {}).kind == DeviceKind::opencl;
  };
  double slow_bus = 1, fast_bus = 1e15;
  ASSERT_TRUE(takes_device(fast_bus, {2, 2}));
  ASSERT_FALSE(takes_device(slow_bus, {2, 2}));
  while (fast_bus > 1.1 * slow_bus) {
    const double middle = std::sqrt(slow_bus * fast_bus);
    (takes_device(middle, {2, 2}) ? fast_bus : slow_bus) = middle;
  }
  EXPECT_FALSE(takes_device(5 * fast_bus, {4, 2}));
  EXPECT_TRUE(takes_device(1000 * fast_bus, {4, 2}));
}

TEST(SharedFrames, NeedTheMemoryOfAllProcessesOfAMachine) {
  const DescentCase one{"one"};
  EXPECT_EQ(error_of([&] { require_memory_for_descent(1, one.slm, one.params, one.start()); }), "no error");
  // 1728 pixels of more than 50 bytes: 86 TB.
  const std::string error =
      error_of([&] { require_memory_for_descent(1, one.slm, one.params, one.start(), 1'000'000'000); });
  EXPECT_NE(error.find(" in each of 1000000000 processes"), std::string::npos) << error;
}

// Frames differ by the rounding of their mean; of the loss that is less than 0.1 dB (2 %).
TEST(SharedFrames, ReachTheLossOfOneProcessAndTheSameBytesEachTime) {
  DescentCase one{"five frames", 5};
  one.params.iterations = 12;
  Heard of_one, of_three;
  found(one, nullptr, of_one.observer());
  ThreadLinks links(3, optimise_frames_for_first_process);
  const std::vector<Hologram> levels = found(one, &links, of_three.observer());
  for (const char* fact : {"loss_first", "loss_last", "target_efficiency"})
    EXPECT_NEAR(of_three.number(fact), of_one.number(fact), 0.02 * of_one.number(fact)) << fact;
  EXPECT_EQ(std::get<int64_t>(of_three.facts.at("processes")), 3);
  EXPECT_EQ(of_one.facts.count("processes"), 0u);
  EXPECT_TRUE(are_same(levels, found(one, &links))) << "the next job of the same processes";
  EXPECT_FALSE(are_same(levels, one.start()));
}

// Without exchange a single frame is found, and processes that are left over have nothing to do.
TEST(SharedFrames, MayBeFewerThanTheProcesses) {
  DescentCase one{"one frame"}, two{"two frames", 2};
  one.params.iterations = two.params.iterations = 3;
  ThreadLinks links(4, optimise_frames_for_first_process), pair(2, optimise_frames_for_first_process);
  EXPECT_TRUE(are_same(found(one, &links), found(one, nullptr)));
  EXPECT_EQ(links.bytes_out(), 0u);
  EXPECT_TRUE(are_same(found(two, &links), found(two, &pair)));
}

// Of an update with one plane: a part of the mean comes back, a factor and five orders go out. Vectors have their length before.
TEST(SharedFrames, ExchangeTheLightOfThePlanesOnly) {
  DescentCase one{"four frames", 4};
  one.params.target_distances = {0.006};
  const auto exchanged = [&](int iterations) {
    one.params.iterations = iterations;
    ThreadLinks links(2, optimise_frames_for_first_process);
    found(one, &links);
    return std::pair{links.bytes_out(), links.bytes_in()};
  };
  const auto four = exchanged(4), three = exchanged(3);
  const size_t plane = size_t(one.slm.grid.pixels()) * sizeof(float) + sizeof(uint64_t);
  EXPECT_EQ(four.first - three.first, plane + 5 * sizeof(FrameOrderMessage));
  EXPECT_EQ(four.second - three.second, plane);
}

// Each colour is a light of its own in all processes; a complex panel has two arrays of levels. After one step levels differ where
// rounding of the mean moves a drive over the middle between two: in few of the pixels.
TEST(SharedFrames, MoveTheLevelsOfTwoColoursAndOfComplexPanels) {
  for (DescentCase one : descent_cases()) {
    if (one.name != "two colours" && one.name != "phases and amplitudes") continue;
    SCOPED_TRACE(one.name);
    one.frames = 3;
    one.params.iterations = 1;
    Heard of_one, of_two;
    const std::vector<Hologram> expected = found(one, nullptr, of_one.observer());
    ThreadLinks links(2, optimise_frames_for_first_process);
    const std::vector<Hologram> levels = found(one, &links, of_two.observer());
    EXPECT_NEAR(of_two.number("loss_first"), of_one.number("loss_first"), 1e-5 * of_one.number("loss_first"));
    for (size_t m = 0; m < expected.size(); ++m) {
      const auto differing = [](const Array2D<uint16_t>& a, const Array2D<uint16_t>& b) {
        size_t count = 0;
        for (size_t i = 0; i < b.size(); ++i) count += a.values[i] != b.values[i];
        return count;
      };
      const size_t few = expected[m].level.size() / 50;
      EXPECT_LE(differing(levels[m].level, expected[m].level), few) << m;
      ASSERT_EQ(levels[m].modulus_level.size(), expected[m].modulus_level.size());
      EXPECT_LE(differing(levels[m].modulus_level, expected[m].modulus_level), few) << m;
      EXPECT_GT(differing(levels[m].level, one.start()[m].level), expected[m].level.size() / 4) << "they moved";
    }
  }
}

// The state is that of all frames: any number of processes goes on from it.
void go_on_from_a_checkpoint(DescentCase one) {
  SCOPED_TRACE(one.name);
  one.params.iterations = 6;
  std::optional<IterationState> kept;
  int updates = 0;
  const Checkpoint checkpoint{.load = [&](const IterationState&) { return kept; },
                              .save = [&](const IterationState& now) { kept = now; },
                              .is_due = [] { return false; },
                              .is_stopping = [&] { return ++updates == 4; }};
  {
    ThreadLinks stopped(2, optimise_frames_for_first_process);
    EXPECT_EQ(error_of([&] { found(one, &stopped, {}, checkpoint); }).substr(0, 13), "stopped after");
  }
  const IterationState at_stop = *kept;
  ThreadLinks links(2, optimise_frames_for_first_process);
  EXPECT_TRUE(are_same(found(one, &links, {}, checkpoint), found(one, &links)));

  kept = at_stop;
  Heard alone, whole;
  found(one, nullptr, alone.observer(), checkpoint);
  found(one, &links, whole.observer());
  EXPECT_NEAR(alone.number("loss_last"), whole.number("loss_last"), 0.02 * whole.number("loss_last"));
}

TEST(SharedFrames, GoOnFromACheckpoint) {
  DescentCase one{"three frames", 3}, complex{"three frames of a complex panel", 3, 256};
  complex.slm.modulation = Modulation::complex;
  go_on_from_a_checkpoint(one);
  go_on_from_a_checkpoint(complex);
}

TEST(SharedFrames, StopWithTheErrorOfAnother) {
  DescentCase one{"two frames", 2};
  int orders = 0;
  ThreadLinks links(2, [&](ProcessLinks& there) {
    job_from(there.receive(0));
    while (++orders < 4) there.receive(0);
    fail("expected this process to work, but it does not");
  });
  EXPECT_EQ(error_of([&] { found(one, &links); }), "expected this process to work, but it does not");
}

// Devices of a machine are divided among its processes. A machine with one device has two of them with HOLOTRACE_SPLIT_DEVICES=2.
class SeveralProcessDevices : public ::testing::Test {
 protected:
  void SetUp() override {
    if (test::device_numbers().empty()) GTEST_SKIP() << "no OpenCL device here";
    numbers_ = equal_devices(list_devices(), 0);
    if (numbers_.size() != 2) GTEST_SKIP() << "one device of its kind, or more than two";
  }
  std::vector<int> numbers_;
};

TEST_F(SeveralProcessDevices, AreDividedAmongTheProcessesOfAMachine) {
  const auto taken = [](DeviceChoice choice, PlaceOnMachine place, size_t frames) {
    std::vector<int> numbers;
    for (const Device* device : devices_of_process(choice, place, frames)) numbers.push_back(device->info().number);
    return numbers;
  };
  using Numbers = std::vector<int>;
  EXPECT_EQ(taken({}, {0, 1}, 4), Numbers{});
  for (const DeviceChoice choice : {DeviceChoice{DeviceKind::opencl, numbers_[0]}, DeviceChoice{DeviceKind::all}}) {
    EXPECT_EQ(taken(choice, {0, 2}, 4), Numbers{numbers_[0]});
    EXPECT_EQ(taken(choice, {1, 2}, 4), Numbers{numbers_[1]});
    EXPECT_EQ(taken(choice, {2, 3}, 4), Numbers{numbers_[0]}) << "in turn";
  }
  EXPECT_EQ(taken({DeviceKind::opencl, numbers_[1]}, {1, 2}, 4), Numbers{numbers_[0]});
  EXPECT_EQ(taken({DeviceKind::all}, {0, 1}, 4), numbers_);
  EXPECT_EQ(taken({DeviceKind::all}, {0, 1}, 1), Numbers{numbers_[0]});
}

// Two processes with one device each, and one process with both: the same parts in the same order.
TEST_F(SeveralProcessDevices, HaveTheSumsAndSlopesOfTheProcessor) {
  DescentCase one{"three frames", 3};
  ProcessorFrames alone(one.slm, one.params, one.start());
  test::expect_near(gradient_of_shared(one, 2, {DeviceKind::all}), gradient_of(one, alone, {}), one.name);
}

}  // namespace
}  // namespace holotrace
