// Charts of sweeps.

#include <gtest/gtest.h>

#include <limits>

#include "holotrace/run/view_holograms.h"
#include "support/error_of.h"

namespace holotrace::test {
namespace {

// A picture of stripes: half of its pixels have the value `high`, the others `low`.
Image stripes(float low, float high, int channels) {
  Image image(6, 8, channels);
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i)
      for (int c = 0; c < channels; ++c) image(j, i, c) = i % 2 == 0 ? low : high;
  return image;
}

std::vector<Viewpoint> sweep_through(Sweep kind, const std::vector<double>& positions) {
  std::vector<Viewpoint> from(1);  // a view that is none of the sweep's
  for (const double position : positions) {
    Viewpoint view{ViewKind::sweep, "sweep", position, position, {}};
    view.camera.sweep = kind;
    from.push_back(view);
  }
  return from;
}

// The list of views alone would take gigabytes.
TEST(Viewpoints, OfASweepAreTenThousandAtMost) {
  CameraParams camera;
  camera.sweep = Sweep::focus;
  camera.sweep_from = 0.1;
  camera.sweep_to = 0.2;
  camera.sweep_views = 10000;
  EXPECT_EQ(viewpoints(camera, {}).size(), 10001U);  // and the one at `distances`
  camera.sweep_views = std::numeric_limits<int>::max();
  EXPECT_EQ(error_of([&] { viewpoints(camera, {}); }),
            "expected a whole number from 2 to 10000 for \"sweep_views\", got 2147483647");
}

// With the two values m ± d the variance over the squared mean is (d/m)², whatever the brightness; 0 for even pictures
// and for dark ones. Grey in three channels has the luminance of one.
TEST(SweepChart, OfFocusShowsTheSharpnessWhateverTheBrightness) {
  const ViewSeries sweep{{stripes(1, 3, 1), stripes(10, 30, 1), stripes(1, 3, 3), stripes(5, 5, 1), stripes(0, 0, 1)},
                         1};
  const Chart chart = sweep_chart(sweep_through(Sweep::focus, {0.1, 0.2, 0.3, 0.4, 0.5}), sweep);
  ASSERT_EQ(chart.series.size(), 1u);
  const std::vector<double> expected{0.25, 0.25, 0.25, 0, 0};
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(chart.series[0].y[i], expected[i], 1e-6) << i;  // floats
    EXPECT_DOUBLE_EQ(chart.series[0].x[i], 100 * double(i + 1)) << "millimetres";
  }
}

TEST(SweepChart, OfParallaxShowsTheMean) {
  const ViewSeries sweep{{stripes(1, 3, 1), stripes(10, 30, 3)}, 1};
  const Chart chart = sweep_chart(sweep_through(Sweep::parallax, {-2e-3, 2e-3}), sweep);
  ASSERT_EQ(chart.series.size(), 1u);
  EXPECT_NEAR(chart.series[0].y[0], 2, 1e-6);  // floats
  EXPECT_NEAR(chart.series[0].y[1], 20, 1e-5);
  EXPECT_DOUBLE_EQ(chart.series[0].x[0], -2);
}

}  // namespace
}  // namespace holotrace::test
