// Which part of a picture is lit, and the warning if nearly nothing is.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "holotrace/run/reference_metrics.h"

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

Told told_of(const Image& render) {
  Told told;
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& value) { told.facts[name] = std::get<double>(value); };
  observer.on_warning = [&](const std::string& sentence) { told.warnings.push_back(sentence); };
  report_lit_render(render, observer);
  return told;
}

// A tenth of the light lies above white (exposure_white); blocks of 8 × 8 pixels are darker here. For n equal pixels that
// hold nearly all light, white is 0.9 of their value.
TEST(LitPart, IsTheFractionOfPixelsFromTwoPercentOfWhiteOn) {
  Image image = first_pixels(10, 1);
  const float lit = 0.0185F, dark = 0.0175F;  // 0.02·0.9 = 0.018; all of them together hold 2 % of the light
  for (size_t i = 500; i < 505; ++i) image.values[i] = lit;
  for (size_t i = 600; i < 607; ++i) image.values[i] = dark;
  EXPECT_EQ(lit_fraction(image), 0.015);
  for (float& value : image.values) value *= 1000;
  EXPECT_EQ(lit_fraction(image), 0.015);                   // whatever the unit and the exposure
  EXPECT_EQ(lit_fraction(first_pixels(250, 1, 3)), 0.25);  // one channel is enough: deep blue is lit
  EXPECT_EQ(lit_fraction(Image(3, 3, 1)), 0);
  EXPECT_EQ(lit_fraction(Image()), 0);
}

// Speckle has an exponential distribution. A tenth of its light is above ln 10 of its mean: that is white, and exp(−0.02·ln 10)
// of its pixels are lit.
TEST(LitPart, OfSpeckleIsNearlyAll) {
  constexpr int n = 40000;
  Image image(200, n / 200, 1);
  for (int i = 0; i < n; ++i)  // its quantiles, in an order that leaves blocks of 8 × 8 pixels near the mean
    image.values[size_t(i) * 17923 % n] = float(-std::log((i + 0.5) / n));
  // Quantiles are wrong by half a step of 1/n; the largest holds ln(n)/n of the light, which moves white by as much.
  EXPECT_NEAR(lit_fraction(image), std::exp(-lit_level * std::log(10.0)), 20.0 / n);
}

// The threshold is half of what the render has.
TEST(LitPart, AViewOfFewWavesGetsAWarning) {
  const auto warnings_of = [](int lit, int of_render) {
    std::vector<std::string> warnings;
    Observer observer;
    observer.on_warning = [&](const std::string& sentence) { warnings.push_back(sentence); };
    warn_of_dots(first_pixels(lit, 1), first_pixels(of_render, 1), 64, observer);
    return warnings;
  };
  EXPECT_TRUE(warnings_of(100, 200).empty());
  EXPECT_TRUE(warnings_of(0, 9).empty());  // 0.9 % of the render: no surface
  const std::vector<std::string> warnings = warnings_of(99, 200);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(
      warnings[0].substr(0, 107),
      "the view shows dots: 9.9 % of it is lit, and 20 % of the render; 64 waves are too few for 50 × 20 pixels; ");
}

// The threshold is 1 of 1000 pixels.
TEST(LitPart, ARenderThatIsNearlyBlackGetsAWarning) {
  const Told dark = told_of(first_pixels(0, 0));
  EXPECT_TRUE(dark.warnings.empty());  // nothing to compare: the report has no metrics, and says why
  EXPECT_EQ(dark.facts.count("psnr_of_black_db"), 0u);
  Image render(40, 50, 1);
  render.values[7] = 0.8F;  // 0.05 %
  const Told nearly = told_of(render);
  EXPECT_EQ(nearly.facts.at("lit_fraction_of_render"), 0.0005);
  EXPECT_NEAR(nearly.facts.at("psnr_of_black_db"), 10 * std::log10(2000), 1e-12);  // 33.0 dB for no light at all
  ASSERT_EQ(nearly.warnings.size(), 1u);
  EXPECT_NE(nearly.warnings[0].find("only 0.05 % of the render is lit, less than 0.1 %"), std::string::npos);
  EXPECT_NE(nearly.warnings[0].find("a black view would have 33.0 dB"), std::string::npos);
  EXPECT_TRUE(told_of(first_pixels(1, 0.8F)).warnings.empty());  // 0.1 %
}

}  // namespace
}  // namespace holotrace::test
