// Pictures with depths as slices of depth.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/wave/layers/depth_layers.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;
using test::relative_error;

DepthImage make_depth_image(int nx, int ny, double depth, int channels = 1) {
  DepthImage image{Image(ny, nx, channels), Array2D<float>(ny, nx, float(depth))};
  for (size_t i = 0; i < image.picture.values.size(); ++i) image.picture.values[i] = float(i % 7) / 7;
  return image;
}

DepthImageParams constant_phase() {
  DepthImageParams params;
  params.phase = SourcePhase::constant;
  return params;
}

SynthesizeParams slices(int count, bool has_silhouettes = false) {
  SynthesizeParams params;
  params.slices = count;
  params.has_silhouettes = has_silhouettes;
  return params;
}

// Pixels as large as the panel's are samples, of amplitude √L to a few roundings of a float; the field is free space
// over the depth. Light up to the raster's Nyquist frequency ends at its box: 0.03 m·tan = 1 mm. The panel's half side
// is 0.25 mm, and the light's window is as large. Ringing beyond the box, 1/(√2·π·v) with v = 0.5 mm·√(2/(λ·0.03 m)) =
// 5.6, may therefore differ by 4 % at its edge between propagators, and by far less in the sum.
TEST(DepthLayers, OfPixelsLikeThePanelsAreFreeSpace) {
  const Grid panel{64, 48, 8_um};
  const DepthImage image = make_depth_image(64, 48, 0.03_m);
  const SliceStack stack = slice_depth_image(image, panel, green, constant_phase(), {});
  ASSERT_EQ(stack.depths.size(), 1U);
  const Slice slice = stack.make(0);
  ASSERT_EQ(slice.light.grid, panel);
  for (size_t i = 0; i < slice.light.samples.size(); ++i)
    EXPECT_NEAR(std::abs(slice.light.samples.values[i] - std::sqrt(image.picture.values[i])), 0, 5e-7) << i;
  const Field field = sum_depth_image(image, panel, green, constant_phase(), {});
  EXPECT_EQ(field.z, 0);
  EXPECT_LT(relative_error(field, propagate(slice.light, 0.03_m)), 0.02);
}

TEST(DepthLayers, PutEachPixelIntoTheSliceOfItsDepth) {
  DepthImage image = make_depth_image(60, 40, 0.2_m);
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 60; ++i) {
      image.picture(j, i) = 1;
      image.depth(j, i) = i < 20 ? 0.0F : i < 40 ? 0.19F : 0.21F;  // nothing, near, far
    }
  const Grid panel{60, 40, 8_um};
  const SliceStack stack = slice_depth_image(image, panel, green, {}, slices(2, true));
  ASSERT_EQ(stack.depths.size(), 2U);
  EXPECT_FLOAT_EQ(float(stack.depths[0]), 0.21F);
  EXPECT_FLOAT_EQ(float(stack.depths[1]), 0.19F);
  const Slice far = stack.make(0), near = stack.make(1);
  for (int i = 0; i < 60; ++i) {
    EXPECT_NEAR(std::abs(far.light.samples(17, i)), i >= 40, 1e-6);
    EXPECT_NEAR(std::abs(near.light.samples(17, i)), i >= 20 && i < 40, 1e-6);
    EXPECT_EQ(near.mask(17, i), float(i >= 20 && i < 40));
  }
  EXPECT_EQ(slice_depth_image(image, panel, green, {}, slices(1)).depths.size(), 1U);
  for (float& light : image.picture.values) light = 0;  // dark pixels hide too
  EXPECT_EQ(slice_depth_image(image, panel, green, {}, slices(2, true)).make(1).mask(17, 30), 1);
}

// Slices as thick as the depth of focus λ/NA². Through 1920 pixels of 8 µm at 0.2 m the cone of the pixels is the narrower
// one, NA = λ/2p: 4p²/λ = 481 µm at 532 nm, so 10 mm need 21 slices. Small panels see the depth of their aperture: 1.024 mm
// at 0.2 m, λ/NA² = 81 mm.
TEST(DepthLayers, AreAsManyAsTheDepthOfFocusNeeds) {
  DepthImage image = make_depth_image(1000, 2, 0.2_m);
  for (int i = 0; i < 1000; ++i) image.depth(0, i) = image.depth(1, i) = float(0.195 + 0.01 * i / 999);
  const Grid large{1920, 8, 8_um}, small{128, 100, 8_um};
  EXPECT_NEAR(depth_of_focus(0.2, large, green), 4 * 8e-6 * 8e-6 / green, 1e-9);
  EXPECT_NEAR(depth_of_focus(0.2, small, green), 4 * green * 0.2 * 0.2 / (1.024e-3 * 1.024e-3), 1e-5);
  EXPECT_EQ(slice_depth_image(image, large, green, {}, slices(0)).depths.size(), 21U);
  EXPECT_EQ(slice_depth_image(image, small, green, {}, slices(0)).depths.size(), 1U);
  // In front of the panel there are as many as behind it: the fewest that cover the depths, whichever end they start from.
  for (int i = 0; i < 1000; ++i) image.depth(0, i) = image.depth(1, i) = float(0.02 + 0.2 * i / 999);
  const size_t behind = slice_depth_image(image, small, green, {}, slices(0)).depths.size();
  for (float& depth : image.depth.values) depth = -depth;
  EXPECT_GT(behind, 20U);
  EXPECT_EQ(slice_depth_image(image, small, green, {}, slices(0)).depths.size(), behind);
  for (int i = 0; i < 1000; ++i) image.depth(0, i) = image.depth(1, i) = float(0.195 + 0.01 * i / 999);
  SynthesizeParams coarse;
  coarse.tolerance = 0.9;  // allows fewer
  Heard heard;
  const SliceStack stack = slice_depth_image(image, large, green, {}, coarse, 0, heard.observer());
  EXPECT_LE(heard.number("largest_depth_error"), std::max(0.8 * 0.9, 1.0));
  EXPECT_LE(stack.depths.size(), 21U);
}

// A bright pixel off the axis appears at its place: as a slide at the same place at every depth, in perspective on its
// ray.
TEST(DepthLayers, PlacePixelsByTheirProjection) {
  const Grid panel{201, 151, 8_um};
  for (const double depth : {0.02_m, 0.04_m}) {
    DepthImage image = make_depth_image(41, 31, depth);
    for (float& light : image.picture.values) light = 0;
    image.picture(5, 30) = 1;  // 10 pixels right of the middle, 10 above
    const auto middle_of_light = [&](const DepthImageParams& params) {
      const Slice slice = slice_depth_image(image, panel, green, params, {}).make(0);
      Vec2 sum{0, 0};
      double weight = 0;
      for (int j = 0; j < slice.light.grid.ny; ++j)
        for (int i = 0; i < slice.light.grid.nx; ++i) {
          const double light = std::norm(std::complex<double>(slice.light.samples(j, i)));
          sum.x += light * slice.light.grid.x(i), sum.y += light * slice.light.grid.y(j);
          weight += light;
        }
      return Vec2{sum.x / weight, sum.y / weight};
    };
    DepthImageParams params = constant_phase();
    params.width = 41 * 32_um;
    // A triangle of light 2 pixels wide on samples of a quarter pixel: its middle is exact to a fraction of a sample.
    Vec2 at = middle_of_light(params);
    EXPECT_NEAR(at.x, 320_um, 2_um);
    EXPECT_NEAR(at.y, 320_um, 2_um);
    params.width = 0;
    params.projection = Projection::perspective;
    params.field_of_view = 0.02;
    at = middle_of_light(params);
    const double pixel = 2 * depth * std::tan(0.02) / 41;
    EXPECT_NEAR(at.x, 10 * pixel, 2_um);
    EXPECT_NEAR(at.y, 10 * pixel, 2_um);
  }
}

TEST(DepthLayers, AverageWhatIsFinerThanSamples) {
  DepthImage image = make_depth_image(40, 40, 0.1_m);
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i) image.picture(j, i) = float(i % 2);  // fine stripes: half the light
  const Grid panel{20, 20, 8_um};
  const Slice slice = slice_depth_image(image, panel, green, constant_phase(), {}).make(0);
  for (const auto& u : slice.light.samples.values) EXPECT_NEAR(std::norm(u), 0.5, 1e-6);
}

// If pixels are four samples wide, the light between their middles is bilinear.
TEST(DepthLayers, AreSmoothBetweenPixelsThatAreCoarserThanSamples) {
  const Grid panel{32, 24, 8_um};
  const DepthImage image = make_depth_image(8, 6, 0.03_m);
  DepthImageParams params = constant_phase();
  params.projection = Projection::orthographic;
  params.width = panel.width();
  const Slice slice = slice_depth_image(image, panel, green, params, {}).make(0);
  ASSERT_EQ(slice.light.grid, panel);
  for (int j = 2; j < 22; ++j)  // half a pixel from the picture's edges, where it has no neighbours
    for (int i = 2; i < 30; ++i) {
      const double x = (i + 0.5) / 4 - 0.5, y = (j + 0.5) / 4 - 0.5;
      const int k = int(x), l = int(y);
      const double s = x - k, t = y - l;
      const auto pixel = [&](int row, int column) { return double(image.picture(row, column)); };
      const double light = (1 - t) * ((1 - s) * pixel(l, k) + s * pixel(l, k + 1)) +
                           t * ((1 - s) * pixel(l + 1, k) + s * pixel(l + 1, k + 1));
      EXPECT_NEAR(std::norm(std::complex<double>(slice.light.samples(j, i))), light, 1e-6) << j << " " << i;  // floats
    }
}

TEST(DepthLayers, HaveRandomPhasesOfTheSeedAndTheFrame) {
  const Grid panel{100, 80, 8_um};
  DepthImage image = make_depth_image(100, 80, 0.1_m);
  for (float& light : image.picture.values) light = 1;
  const auto light = [&](int64_t seed, uint32_t frame) {
    DepthImageParams params;
    params.seed = seed;
    return slice_depth_image(image, panel, green, params, {}, frame).make(0).light.samples.values;
  };
  const auto first = light(1, 0);
  EXPECT_EQ(first, light(1, 0));
  EXPECT_NE(first, light(2, 0));
  EXPECT_NE(first, light(1, 1));
  std::complex<double> sum = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    EXPECT_NEAR(std::abs(first[i]), 1, 1e-6);
    sum += std::complex<double>(first[i]);
  }
  EXPECT_LT(std::abs(sum), 4 * std::sqrt(double(first.size())));  // a random walk; probability exp(−16) to be farther
}

TEST(DepthLayers, TakeTheLightOfTheirWavelength) {
  DepthImage image = make_depth_image(4, 4, 0.1_m, 3);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      image.picture(j, i, 0) = 0.9F, image.picture(j, i, 1) = 0.4F, image.picture(j, i, 2) = 0.1F;
  const Grid panel{4, 4, 8_um};
  const auto light = [&](double wavelength) {
    return std::norm(slice_depth_image(image, panel, wavelength, constant_phase(), {}).make(0).light.samples(1, 2));
  };
  EXPECT_NEAR(light(630_nm), 0.9, 1e-6);
  EXPECT_NEAR(light(532_nm), 0.4, 1e-6);
  EXPECT_NEAR(light(460_nm), 0.1, 1e-6);
  EXPECT_NEAR(light(581_nm), 0.65, 1e-6);  // half way between red and green
}

// Two shapes at two depths. Light propagated back to a depth is in focus where the shape of that depth is. In focus
// a shape's samples hold its light, and the dark samples beside it hold none.
TEST(DepthLayers, FocusAtTheirDepths) {
  const Grid panel{256, 192, 8_um};
  DepthImage image = make_depth_image(256, 192, 0);
  for (float& light : image.picture.values) light = 0;
  const auto stripe = [&](int from, float depth) {  // a stripe of fine bars, 4 samples wide
    for (int j = 60; j < 132; ++j)
      for (int i = from; i < from + 64; ++i) {
        image.picture(j, i) = float(i / 4 % 2);
        image.depth(j, i) = depth;
      }
  };
  for (const double side : {1.0, -1.0}) {  // the first stripe lies behind the panel, then in front of it
    stripe(40, float(side * 0.03));
    stripe(150, 0.05F);
    const Field field = sum_depth_image(image, panel, green, {}, {});
    const auto contrast = [&](int from, double depth) {  // light of the bars over light between them
      const Field back = propagate(field, -depth);
      double bright = 0, dark = 0;
      for (int j = 60; j < 132; ++j)
        for (int i = from; i < from + 64; ++i) (i / 4 % 2 ? bright : dark) += std::norm(back.samples(j, i));
      return bright / dark;
    };
    // A panel of 2 × 1.5 mm resolves λd/S = 8 … 18 µm, the bars are 32 µm; 20 mm out of focus they spread over 1.3 mm.
    EXPECT_GT(contrast(40, side * 0.03), 4);
    EXPECT_GT(contrast(150, 0.05), 3);
    EXPECT_LT(contrast(40, 0.05), 1.2);
    EXPECT_LT(contrast(150, side * 0.03), 1.2);
    EXPECT_GT(contrast(40, side * 0.03), 2 * contrast(40, side * 0.0305));  // depth of focus 2λd²/S² = 0.24 mm
  }
}

// An even picture that reaches beyond all that the panel sees: its irradiance arrives, whatever cone its light keeps to.
// Speckle of a band that is a part c = 450/638 of the samples' along each axis has 64²·c² independent values in the
// mean: 2.2 %. 4 σ: 9 %.
TEST(DepthLayers, BringTheirLightThroughACommonConeToo) {
  const Grid panel{64, 64, 8_um};
  DepthImage image = make_depth_image(128, 128, 2_mm);  // light goes 10 pixels sideways over 2 mm
  std::fill(image.picture.values.begin(), image.picture.values.end(), 0.8F);
  DepthImageParams params;
  params.projection = Projection::orthographic;
  params.width = 128 * 8_um;
  for (const auto& [cone, depth] :
       {std::pair{0.0, 2_mm}, {450_nm, 2_mm}, {450_nm, 1e-9}, {450_nm, 0.1_mm}, {450_nm, -0.1_mm}}) {
    for (float& pixel : image.depth.values) pixel = float(depth);
    const Field field = sum_depth_image(image, panel, {638_nm, cone}, params, {});
    double sum = 0;
    for (const auto& u : field.samples.values) sum += double(std::norm(u));
    EXPECT_NEAR(sum / double(panel.pixels()), 0.8, 0.09 * 0.8) << cone << " " << depth;
  }
}

// In front of the panel the field of a picture of constant phase is the conjugate of that of its mirror image behind it; in the panel
// it is the picture itself.
TEST(DepthLayers, LieOnBothSidesOfThePanelAndInIt) {
  const Grid panel{64, 48, 8_um};
  const auto field_at = [&](double depth) {
    return sum_depth_image(make_depth_image(64, 48, depth), panel, green, constant_phase(), {});
  };
  const Field behind = field_at(30_mm), in_front = field_at(-30_mm), within = field_at(1e-9);
  Field mirrored = behind;
  for (auto& u : mirrored.samples.values) u = std::conj(u);
  EXPECT_LT(relative_error(in_front, mirrored), 1e-6);
  EXPECT_GT(relative_error(in_front, behind), 0.1);
  const DepthImage image = make_depth_image(64, 48, 1);
  for (size_t i = 0; i < within.samples.size(); ++i)
    EXPECT_NEAR(std::norm(within.samples.values[i]), image.picture.values[i], 1e-5) << i;

  // A ramp through the panel keeps its light on each side of it: 41 columns from −20 to 20 mm, the middle one in the panel.
  DepthImage ramp = make_depth_image(41, 8, 0);
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 41; ++i) ramp.depth(j, i) = i == 20 ? 1e-9F : float((i - 20) * 1_mm), ramp.picture(j, i) = 1;
  const Grid wide{41, 8, 8_um};
  const SliceStack stack = slice_depth_image(ramp, wide, green, constant_phase(), slices(9));
  ASSERT_LE(stack.depths.size(), 9U);
  int lit = 0;
  for (size_t m = 0; m < stack.depths.size(); ++m) {
    const Slice slice = stack.make(m);
    for (int i = 0; i < 41; ++i) {
      if (std::abs(slice.light.samples(4, i)) == 0.F) continue;
      ++lit;
      EXPECT_NEAR(stack.depths[m], (i - 20) * 1_mm, 2.5_mm) << i;  // 40 mm in nine slices or eight
    }
  }
  EXPECT_EQ(lit, 41);
}

TEST(DepthLayers, RefuseWhatIsNoPictureWithDepths) {
  const Grid panel{16, 12, 8_um};
  DepthImage image = make_depth_image(8, 6, 0.1_m);
  const auto error = [&](DepthImageParams params, SynthesizeParams synthesis = {}) {
    return error_of([&] { sum_depth_image(image, panel, green, params, synthesis); });
  };
  DepthImageParams params;
  EXPECT_EQ(error(params), "no error");
  params.phase = SourcePhase::path;
  EXPECT_EQ(error(params), "expected the phase random or constant for a picture with depth");
  params = {};
  params.width = -1_mm;
  EXPECT_EQ(error(params), "expected a length of 0 m or more for \"width\", got -1 mm");
  params = {};
  params.field_of_view = 0.1;
  EXPECT_EQ(error(params).rfind("expected no field of view with the projection orthographic", 0), 0U);
  params.projection = Projection::perspective;
  params.width = 1_mm;
  EXPECT_EQ(error(params).rfind("expected no width with the projection perspective, got 1 mm", 0), 0U);
  EXPECT_EQ(error({}, slices(-1)), "expected a whole number of 0 or more for \"slices\", got -1");
  image.depth(2, 3) = -0.1F;
  params.width = 0;
  EXPECT_EQ(error(params).rfind("expected depths behind the panel with the projection perspective", 0), 0U);
  image.depth(2, 3) = NAN;
  EXPECT_EQ(error({}).rfind("expected finite depths, or 0 m (nothing there), got nan m at row 2, column 3", 0), 0U);
  for (float& depth : image.depth.values) depth = 0;
  EXPECT_EQ(error({}), "expected a pixel with a depth other than 0 m (nothing there), got none");
  image.depth = Array2D<float>(6, 7);
  EXPECT_EQ(error({}), "expected a depth for each of 8 × 6 pixels, got 7 × 6; make both pictures one size");
  image = make_depth_image(8, 6, 0.1_m);
  image.picture(1, 2) = -1;
  EXPECT_EQ(error({}), "expected light of 0 or more in a picture, got -1 at row 1, column 2");
}

}  // namespace
}  // namespace holotrace
