// Which part of a picture is lit, and the warning if nearly nothing is.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "holotrace/run/lit_part.h"

namespace holotrace::test {
namespace {

// A picture of 1000 pixels, black but for the first ones.
Image first_pixels(int lit, float value, int channels = 1) {
  Image image(20, 50, channels);
  for (int i = 0; i < lit; ++i) image.values[size_t(i * channels + channels - 1)] = value;
  return image;
}

struct Told {
  std::map<std::string, double> facts;
  std::vector<std::string> warnings;
};

Told told_of(const Image& render, const Image& view) {
  Told told;
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& value) { told.facts[name] = std::get<double>(value); };
  observer.on_warning = [&](const std::string& sentence) { told.warnings.push_back(sentence); };
  report_lit_render({render, 1}, {view, 1}, observer);
  return told;
}

TEST(LitPart, IsTheFractionOfPixelsFromTwoPercentOfWhiteOn) {
  Image image(1, 4, 1);
  image.values = {0, 0.0199F, 0.0201F, 1};
  EXPECT_EQ(lit_fraction({image, 1}), 0.5);
  EXPECT_EQ(lit_fraction({image, 60}), 0);  // as dark as its white makes it
  EXPECT_EQ(lit_fraction({image, 0.5}), 0.75);
  EXPECT_EQ(lit_fraction({first_pixels(250, 1, 3), 1}), 0.25);  // one channel is enough: deep blue is lit
  EXPECT_EQ(lit_fraction({Image(3, 3, 1), 1}), 0);
}

// Speckle of mean m has an exponential distribution: exp(−0.02/m) of its pixels are lit.
TEST(LitPart, OfSpeckleIsNearlyAll) {
  constexpr int n = 40000;
  Image image(200, n / 200, 1);
  for (int i = 0; i < n; ++i) image.values[size_t(i)] = float(-0.43 * std::log((i + 0.5) / n));  // its quantiles
  EXPECT_NEAR(lit_fraction({image, 1}), std::exp(-lit_level / 0.43), 1.0 / n);
}

// The threshold is 1 of 1000 pixels.
TEST(LitPart, ARenderThatIsNearlyBlackGetsAWarning) {
  const Told dot = told_of(first_pixels(0, 0), first_pixels(0, 0));
  EXPECT_TRUE(dot.warnings.empty());  // nothing to compare: the report has no metrics, and says why
  EXPECT_EQ(dot.facts.count("psnr_of_black_db"), 0u);
  Image render(40, 50, 1);
  render.values[7] = 0.8F;  // 0.05 %
  const Told nearly = told_of(render, Image(40, 50, 1));
  EXPECT_EQ(nearly.facts.at("lit_fraction_of_render"), 0.0005);
  EXPECT_NEAR(nearly.facts.at("psnr_of_black_db"), 10 * std::log10(2000), 1e-12);  // 33.0 dB for no light at all
  ASSERT_EQ(nearly.warnings.size(), 1u);
  EXPECT_NE(nearly.warnings[0].find("only 0.05 % of the render is lit, less than 0.1 %"), std::string::npos);
  EXPECT_NE(nearly.warnings[0].find("a black one has 33.0 dB"), std::string::npos);
  EXPECT_TRUE(told_of(first_pixels(1, 0.8F), first_pixels(1, 0.8F)).warnings.empty());  // 0.1 %
}

TEST(LitPart, AViewOfAFewBrightPixelsGetsAWarning) {
  Image dark = first_pixels(1000, 0.001F);
  const Told told = told_of(first_pixels(400, 0.5F), dark);
  ASSERT_EQ(told.warnings.size(), 1u);
  EXPECT_NE(told.warnings[0].find("only 0 % of the view is lit, but 40 % of the render"), std::string::npos);
  dark.values[0] = 1;
  EXPECT_TRUE(told_of(first_pixels(400, 0.5F), dark).warnings.empty());
}

}  // namespace
}  // namespace holotrace::test
