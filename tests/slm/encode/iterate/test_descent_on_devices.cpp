// Where gradient descent computes, what goes to a device and comes back, and what happens if the device fails.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/slm/encode/encode.h"
#include "slm/encode/iterate/descents_on_devices.h"
#include "support/build_paths.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

using test::are_same;
using test::DescentCase;

class DescentDevices : public test::DescentsOnDevices {
 protected:
  DescentDevices() {
    one_.params.iterations = 3;
    one_.params.target_distances = {0.006};
  }
  using DescentsOnDevices::automatic;
  EncodeParams automatic() const { return automatic(one_.params); }

  DescentCase one_{"one"};
};

HOLOTRACE_FOR_ALL_DEVICES(DescentDevices);

// Of an update, two sums and an error of each row; the same for every update.
TEST_P(DescentDevices, ReturnTheRowSumsOnly) {
  const auto returned = [&](int iterations) {
    one_.params.iterations = iterations;
    const size_t before = device_.use().bytes_out;
    found(one_, on_device(one_.params));
    return device_.use().bytes_out - before;
  };
  const size_t rows = size_t(one_.slm.grid.ny);
  EXPECT_EQ(returned(4) - returned(3), rows * 3 * sizeof(float));
  // Judged at the end, and the levels.
  EXPECT_EQ(returned(3), (3 * 3 + 2) * rows * sizeof(float) + size_t(one_.slm.grid.pixels()) * sizeof(float));
}

TEST_P(DescentDevices, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  one_.slm = make_panel(51, 38);  // not whole groups
  for (const int frames : {1, 4}) {
    one_.frames = frames;
    found(one_, on_device(one_.params));
  }
  one_.has_views = true;
  found(one_, on_device(one_.params));
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

// The state in the middle, as it is kept, is all that the rest needs.
TEST_P(DescentDevices, GoOnFromACheckpoint) {
  one_.frames = 2;
  one_.params.iterations = 6;
  std::optional<IterationState> kept;
  int updates = 0;
  Checkpoint checkpoint{.load = [&](const IterationState&) { return kept; },
                        .save = [&](const IterationState& now) { kept = now; },
                        .is_due = [] { return false; },
                        .is_stopping = [&] { return ++updates == 4; }};
  const EncodeParams params = on_device(one_.params);
  const std::vector<Hologram> whole = found(one_, params);
  EXPECT_EQ(error_of([&] { found(one_, params, {}, checkpoint); }),
            "stopped after 4 of 6 iterations, which the checkpoint keeps; give the same command again to go on");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->updates, 4);
  EXPECT_TRUE(are_same(found(one_, params, {}, checkpoint), whole));
  // Under `auto`, a stop is no fault of the device.
  kept.reset();
  updates = 0;
  make_device_fast(1e15);
  Heard heard;
  EXPECT_EQ(error_of([&] { found(one_, automatic(), heard.observer(), checkpoint); }).substr(0, 13), "stopped after");
  EXPECT_TRUE(heard.warnings.empty());
}

#if HOLOTRACE_HAS_OPENCL
// Every 50th call fails: memory, transfers, kernels and waits of all parts of a descent.
TEST_P(DescentDevices, ReleaseTheirMemoryAfterAnyFault) {
  one_.params.iterations = 1;
  one_.has_views = true;
  found(one_, on_device(one_.params));  // compiles the kernels
  EXPECT_GT(test::fail_every(50, [&] { found(one_, on_device(one_.params)); }), 5);
}

// Under `auto` the processor takes over whichever call fails, those that keep the state between updates included. It goes
// on from the state that was kept, so its levels differ by the rounding of the device until then.
TEST_P(DescentDevices, GiveWayToTheProcessorAfterAnyFault) {
  one_.frames = 2;
  one_.params.iterations = 2;
  make_device_fast(1e15);
  found(one_, automatic());  // compiles the kernels
  int faults = 0;
  for (int failed = 0;; failed += 31) {
    std::optional<IterationState> kept;
    const Checkpoint checkpoint{.load = [&](const IterationState&) { return kept; },
                                .save = [&](const IterationState& now) { kept = now; },
                                .is_due = [] { return true; },
                                .is_stopping = {}};
    test::FaultyApi api;
    api.failing = failed;
    Heard heard;
    EXPECT_EQ(error_of([&] { found(one_, automatic(), heard.observer(), checkpoint); }), "no error") << failed;
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->updates, 2);
    if (api.calls <= failed) break;
    EXPECT_EQ(heard.warnings.size(), 1u) << failed;
    ++faults;
  }
  EXPECT_GT(faults, 5);
}
#endif

TEST(ErrorDiffusion, RefusesADevice) {
  const DescentCase one{"one"};
  Field field(one.slm.grid, 532e-9, 0);
  field.samples.values[0] = 1;
  EncodeParams params{.method = Encoding::error_diffusion};
  params.device = {DeviceKind::opencl, 0};
  EXPECT_EQ(
      error_of([&] { encode(field, one.slm, params); }),
      "expected an encoding whose pixels can be found at once on an OpenCL device, got \"error-diffusion\", which "
      "passes errors from pixel to pixel; use another one, such as \"double-phase\", or the device cpu");
  params.device.kind = DeviceKind::automatic;
  EXPECT_EQ(error_of([&] { encode(field, one.slm, params); }), "no error");
}

}  // namespace
}  // namespace holotrace
