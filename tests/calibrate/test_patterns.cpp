#include <gtest/gtest.h>

#include <map>
#include <set>

#include "calibrate/photographs.h"
#include "holotrace/calibrate/measured_panel.h"
#include "holotrace/calibrate/patterns.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

std::set<int> levels_of(const TestPattern& pattern) {
  return {pattern.hologram.level.values.begin(), pattern.hologram.level.values.end()};
}

TEST(TestPatterns, CompareEveryMeasuredLevelOftenEnough) {
  const auto patterns = make_test_patterns(assumed_panel(256, 192), bench_wavelength, 0.1, {});
  EXPECT_EQ(patterns.front().kind, PatternKind::spots);
  EXPECT_EQ(patterns.back().kind, PatternKind::focus);
  // In `spots` and `focus`, level 0 and the level nearest to half a wave: 17 levels of 256 in even steps, number 8.
  EXPECT_EQ(levels_of(patterns.front()), (std::set<int>{0, 128}));
  EXPECT_EQ(levels_of(patterns.back()), (std::set<int>{0, 128}));
  std::map<int, int> uses;
  std::set<std::string> names;
  for (const TestPattern& pattern : patterns) {
    names.insert(pattern.name);
    if (pattern.kind == PatternKind::levels)
      for (const int level : levels_of(pattern)) ++uses[level];
  }
  EXPECT_EQ(names.size(), patterns.size());
  EXPECT_EQ(uses.size(), 17u);
  for (const auto& [level, count] : uses) EXPECT_GE(count, 4) << level;
}

TEST(TestPatterns, OfOneSeedAreTheSameAndOfAnotherDiffer) {
  const Slm slm = assumed_panel(96, 96);
  const auto a = make_test_patterns(slm, bench_wavelength, 0.05, {}),
             b = make_test_patterns(slm, bench_wavelength, 0.05, {});
  TestPatternParams other;
  other.pattern_seed = 2;
  const auto c = make_test_patterns(slm, bench_wavelength, 0.05, other);
  EXPECT_EQ(a[1].hologram.level.values, b[1].hologram.level.values);
  EXPECT_NE(a[1].hologram.level.values, c[1].hologram.level.values);
}

TEST(TestPatterns, FocusTheLightOfEachCellAtOnePlace) {
  // A lens in the levels 0 and π sends (2/π)² = 40.5 % of its light to its focus (the first order of a binary phase
  // grating). The spots of 9 cells of 85 pixels, each √6λz wide, are about λz/85p = 93 µm wide, or 12 pixels; discs of 12
  // pixels about the brightest places hold most of that.
  const Slm slm = assumed_panel(256, 256, 1);
  const auto patterns = make_test_patterns(slm, bench_wavelength, 0.1, {});
  Image image = fine_irradiance(patterns.front().hologram, slm, 0.1);
  double total = 0, found = 0;
  for (const float value : image.values) total += value;
  for (int spot = 0; spot < 9; ++spot) {
    const size_t at = size_t(std::max_element(image.values.begin(), image.values.end()) - image.values.begin());
    const int row = int(at) / image.nx, column = int(at) % image.nx, radius = 48;
    for (int j = std::max(0, row - radius); j < std::min(image.ny, row + radius); ++j)
      for (int i = std::max(0, column - radius); i < std::min(image.nx, column + radius); ++i)
        if (std::hypot(i - column, j - row) < radius) {
          found += image(j, i);
          image(j, i) = 0;
        }
  }
  EXPECT_GT(found / total, 0.8 * 0.405);  // a disc of that radius holds more than 80 % of a square lens's spot
}

TEST(TestPatterns, OfPanelsThatCannotBeMeasuredAreRefused) {
  Slm slm = assumed_panel(96, 96);
  slm.modulation = Modulation::amplitude;
  const auto make = [&](const TestPatternParams& params = {}) {
    return error_of([&] { make_test_patterns(slm, bench_wavelength, 0.1, params); });
  };
  EXPECT_EQ(
      make(),
      "expected a phase panel, whose phases are to be measured, got \"assumed\", which modulates amplitude; name a "
      "phase panel");
  slm = assumed_panel(96, 40);
  EXPECT_EQ(make(), "expected a panel of at least 64 × 64 pixels, for lenses of many zones, got 96 × 40");
  slm = assumed_panel(96, 96);
  slm.levels = 16;
  EXPECT_EQ(make(),
            "expected at most 16 measured levels, as many as the panel \"assumed\" has, got 17; lower measured_levels");
  TestPatternParams params;
  params.measured_levels = 2;
  EXPECT_EQ(make(params), "expected a whole number from 3 to 257 for \"measured_levels\", got 2");
  EXPECT_EQ(error_of([&] { make_test_patterns(slm, bench_wavelength, 0, {.measured_levels = 9}); }),
            "expected a distance above 0 m, got 0 m");
}

TEST(AssumedPhase, IsThatOfThePanelAtTheWavelengthInUse) {
  // A delay by a length: at two thirds of the design wavelength the phase is 1.5 times as large.
  Slm slm = assumed_panel(96, 96);
  EXPECT_DOUBLE_EQ(assumed_phase(slm, 64, bench_wavelength), pi / 2);  // a quarter of 256 levels, without a design
  slm.design_wavelength = bench_wavelength;
  EXPECT_DOUBLE_EQ(assumed_phase(slm, 64, bench_wavelength / 1.5), 1.5 * pi / 2);
  for (int level = 0; level < 256; ++level) slm.effects.calibration.push_back({hidden_phase(level), 1});
  EXPECT_DOUBLE_EQ(assumed_phase(slm, 64, bench_wavelength), hidden_phase(64));
  EXPECT_DOUBLE_EQ(assumed_phase(slm, 64, bench_wavelength / 1.5), 1.5 * hidden_phase(64));
}

TEST(MeasuredCurve, OfPhasesThatFallIsTheirMean) {
  EXPECT_EQ(never_falling({0, 1, 3, 2, 2.5, 4}), (std::vector<double>{0, 1, 2.5, 2.5, 2.5, 4}));
  EXPECT_EQ(never_falling({3, 2, 1}), (std::vector<double>{2, 2, 2}));
  EXPECT_EQ(never_falling({0, 1, 2}), (std::vector<double>{0, 1, 2}));
}

TEST(MeasuredCurve, BetweenItsLevelsIsSmoothAndNeverFalls) {
  // A line is reproduced; a curve passes through its points, and to the error of a cubic of that step between them.
  const std::vector<int> levels{0, 16, 32, 48, 64, 80};
  std::vector<double> line, curve;
  const auto f = [](double level) { return level / 40 + 0.2 * std::sin(level / 16); };
  for (const int level : levels) {
    line.push_back(0.03 * level);
    curve.push_back(f(level));
  }
  const std::vector<double> along = at_all_levels(levels, line, 90), between = at_all_levels(levels, curve, 81);
  ASSERT_EQ(along.size(), 90u);
  for (int level = 0; level < 90; ++level) EXPECT_NEAR(along[size_t(level)], 0.03 * level, 1e-12) << level;
  for (int level = 16; level <= 64; ++level)
    EXPECT_NEAR(between[size_t(level)], f(level), 0.01) << level;  // linear interpolation: 0.2/8 = 0.025
  for (const int level : levels) EXPECT_DOUBLE_EQ(between[size_t(level)], f(level));
  // Uneven steps, away from the ends: values of SciPy 1.17's PchipInterpolator, which has the same slopes at inner points.
  const std::vector<double> uneven = at_all_levels({0, 4, 16, 24, 64, 80}, {0, 1, 2, 5, 6, 9}, 81);
  for (const auto& [level, value] : {std::pair<size_t, double>{10, 1.4909378596087457},
                                     {20, 3.584215408118726},
                                     {40, 5.496983734547821},
                                     {50, 5.610624146063761}})
    EXPECT_NEAR(uneven[level], value, 1e-12) << level;
  const std::vector<double> steep = at_all_levels({0, 10, 20, 30}, {0, 0, 5, 5}, 31);
  for (size_t level = 1; level < steep.size(); ++level) EXPECT_GE(steep[level], steep[level - 1] - 1e-12) << level;
}

}  // namespace
}  // namespace holotrace
