// Views and renders of a run, exposed alike.

#include <gtest/gtest.h>

#include "holotrace/run/reference_metrics.h"

namespace holotrace::test {
namespace {

// A surface of that value in the middle of a picture.
Image surface(float value) {
  Image image(64, 64, 1);
  for (int j = 16; j < 48; ++j)
    for (int i = 16; i < 48; ++i) image(j, i) = value;
  return image;
}

// Every second pixel of a view is twice as bright, the others are dark: its mean is that of the surface.
Image striped(float value) {
  Image image = surface(2 * value);
  for (size_t i = 0; i < image.values.size(); i += 2) image.values[i] = 0;
  return image;
}

TEST(CommonExposure, GivesEqualLightTheSameGrey) {
  const Image render = surface(0.8f), view = surface(4), speckled = striped(4);
  for (const Image& seen : {view, speckled}) {
    const CommonExposure white = common_exposure({seen}, {{render}}, {render}, 0);
    EXPECT_NEAR(4 / white.view_white, 0.8 / white.render_white, 1e-6);  // floats
  }
  EXPECT_NEAR(common_exposure({view}, {{render}}, {render}, 0).render_white, 1.25 * 0.8, 1e-6);  // of the render alone
  // Above 0.9 times the bright stripes, 8, lies a tenth of their light: that is the larger white.
  EXPECT_NEAR(common_exposure({speckled}, {{render}}, {render}, 0).view_white, 7.2, 1e-5);
}

// A view that lacks the render's highlight is exposed by the render, so that the highlight is not clipped there. The
// light of the render is 768·0.8 + 256·2.4 = 1228.8 where that of the view is 1024·4: a ratio of 0.3.
TEST(CommonExposure, DarkensAViewForTheHighlightOfItsRender) {
  Image render = surface(0.8f);
  for (int j = 24; j < 40; ++j)
    for (int i = 24; i < 40; ++i) render(j, i) = 2.4f;
  const CommonExposure white = common_exposure({surface(4)}, {{render}}, {render}, 0);
  EXPECT_NEAR(white.render_white, 1.25 * 2.4, 1e-5);  // floats; of the render alone
  EXPECT_NEAR(white.view_white, 1.25 * 2.4 / 0.3, 1e-4);
}

TEST(CommonExposure, KeepsTheExposureThatIsGiven) {
  const CommonExposure white = common_exposure({surface(4)}, {{surface(0.8f)}}, {surface(0.8f)}, 10);
  EXPECT_EQ(white.view_white, 10);
  EXPECT_NEAR(white.render_white, 2, 1e-6);
}

TEST(CommonExposure, DoesNotDarkenARenderForAViewOfStrayLight) {
  Image stray = surface(1e-3f);
  for (int i = 0; i < 64; ++i) stray(0, i) = 100;  // beside the surface
  const CommonExposure white = common_exposure({stray}, {{surface(0.8f)}}, {surface(0.8f)}, 0);
  EXPECT_NEAR(white.render_white, 2 * 1.25 * 0.8, 1e-6);
}

// The ratio is that of all places above a tenth of the render's peak, also of dim ones (0.3 of it), and not of the
// background (0.05 of it), where the view has stray light.
TEST(CommonExposure, ComparesTheLightOfDimPlacesToo) {
  Image render(64, 64, 1), view(64, 64, 1);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      render(j, i) = i < 16 ? 0.8f : i < 32 ? 0.24f : 0.04f;
      view(j, i) = i < 16 ? 4.0f : i < 32 ? 0.5f : 7.0f;
    }
  const CommonExposure white = common_exposure({view}, {{render}}, {render}, 10);
  EXPECT_NEAR(white.render_white, 10 * (0.8 + 0.24) / (4 + 0.5), 1e-5);  // floats
}

TEST(CommonExposure, ExposesViewsAloneWithoutAReference) {
  const CommonExposure white = common_exposure({surface(4)}, {}, {}, 0);
  EXPECT_NEAR(white.view_white, 5, 1e-6);
  EXPECT_EQ(common_exposure({surface(4)}, {{surface(0)}}, {surface(0)}, 0).view_white, white.view_white);
}

}  // namespace
}  // namespace holotrace::test
