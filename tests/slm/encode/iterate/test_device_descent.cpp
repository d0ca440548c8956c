// Gradient descent on every OpenCL device: its arithmetic against the processor's, and what it takes and gives back.

#include <gtest/gtest.h>

#include "holotrace/slm/encode/iterate/device_arrays.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"
#include "slm/encode/iterate/descent_gradients.h"

namespace holotrace {
namespace {

using test::descent_cases;
using test::DescentCase;
using test::Gradient;
using test::gradient_of;
using test::relative;

class DeviceDescents : public test::DescentsOnDevices {};

HOLOTRACE_FOR_ALL_DEVICES(DeviceDescents);

// Propagations agree to 1e-6 of their norm; sums of 2000 positive terms agree better, and slopes, which are differences
// of light, worse.
TEST_P(DeviceDescents, HaveTheSumsAndSlopesOfTheProcessor) {
  for (const DescentCase& one : descent_cases())
    for (const PanelDetail& detail :
         {PanelDetail{}, {.is_hard = false, .light = PixelDetail::coarse, .slopes = PixelDetail::mean}}) {
      const std::vector<Hologram> start = one.start();
      ProcessorFrames on_processor(one.slm, one.params, start);
      DeviceFrames there({&device_}, one.slm, one.params, start);
      const Gradient expected = gradient_of(one, on_processor, detail), found = gradient_of(one, there, detail);
      ASSERT_EQ(found.numbers.size(), expected.numbers.size());
      for (size_t i = 0; i < found.numbers.size(); ++i)
        EXPECT_NEAR(found.numbers[i], expected.numbers[i], 2e-6 * std::abs(expected.numbers[i])) << one.name << i;
      ASSERT_EQ(found.slopes.size(), expected.slopes.size());
      for (size_t m = 0; m < found.slopes.size(); ++m)
        EXPECT_LT(relative(found.slopes[m], expected.slopes[m]), 1e-5) << one.name;
    }
}

// With crosstalk there are three panels, which share the arrays of a call; each has its own factors of transforms.
TEST_P(DeviceDescents, KeepTheMemoryOfAPanelThatIsCounted) {
  const auto lock = device_.lock();
  for (const bool has_crosstalk : {false, true}) {
    Slm slm = make_panel(48, 36, 200, 0.9);
    slm.effects.crosstalk = has_crosstalk ? 0.3 : 0;
    const Hologram hologram = make_hologram(slm, Modulation::phase, [](int) { return 0; });
    const DrivenPanel panel(slm, hologram, test_wavelength, 3);
    DeviceDrivenPanel there(device_, panel);
    const size_t samples = 9 * size_t(slm.grid.pixels());
    DeviceFrame frame;
    frame.level.rounded = device_.make_buffer(samples * 4, "a test");
    frame.level.slope = device_.make_buffer(samples * 4, "a test");
    const DeviceBuffer u = device_.make_buffer(samples * 8, "a test");
    const size_t before = device_.use().bytes_held;
    DevicePanel::Memory memory;
    for (const PixelDetail detail : {PixelDetail::mean, PixelDetail::coarse, PixelDetail::as_shown}) {
      there.leave(frame, {.light = detail, .slopes = detail}, {u, memory});
      there.add_slope(frame, {.light = detail, .slopes = detail}, u, {u, memory}, 1);
    }
    EXPECT_EQ(double(device_.use().bytes_held - before), DeviceDrivenPanel::bytes_kept(device_, panel));
    EXPECT_GE(DeviceDrivenPanel::bytes_kept(device_, panel), 8.0 * double(samples) * 2) << "light along both axes";
  }
}

// Adam scales up slopes near 0, whose rounding differs, so levels part from the processor's. The loss does not.
TEST_P(DeviceDescents, ReachTheLossOfTheProcessor) {
  for (DescentCase one : descent_cases())
    for (const int iterations : {1, 20}) {
      if (iterations > 1 && one.frames < 3 && one.levels > 2 && !one.has_two_colours)
        continue;  // the others have the same updates
      one.params.iterations = iterations;
      Heard expected, heard;
      found(one, one.params, expected.observer());
      found(one, on_device(one.params), heard.observer());
      const double bound = iterations == 1 ? 1e-4 : 0.02;
      for (const char* fact : {"loss_first", "loss_last", "target_efficiency"})
        EXPECT_NEAR(heard.number(fact), expected.number(fact), bound * expected.number(fact)) << one.name << fact;
    }
}

}  // namespace
}  // namespace holotrace
