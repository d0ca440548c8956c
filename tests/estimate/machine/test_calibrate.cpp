#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/estimate/machine/calibrate.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {
namespace {

TEST(FitRates, FindsTheRatesThatMadeTheTimes) {
  SummationRates made;
  made.multiply_adds = 7e10;
  made.factors = 9e8;
  made.wave_tiles = 2e7;
  made.exact_terms = 3e7;
  std::vector<TimedWork> timed;
  for (const double side : {4.0, 16.0, 32.0, 128.0}) {
    const SummationWork work{.multiply_adds = 4 * side * side * 512, .factors = 2 * side * 512, .wave_tiles = 512};
    timed.push_back({work, predict_seconds(work, made, 1)});
  }
  const SummationWork one_by_one{.exact_terms = 1e6};
  timed.push_back({one_by_one, predict_seconds(one_by_one, made, 1)});
  const SummationRates fitted = fit_rates(timed);
  // Without noise, only the error of the descent remains, far below what affects the choice of a method.
  EXPECT_NEAR(fitted.multiply_adds / made.multiply_adds, 1, 1e-3);
  EXPECT_NEAR(fitted.factors / made.factors, 1, 1e-3);
  EXPECT_NEAR(fitted.wave_tiles / made.wave_tiles, 1, 1e-3);
  EXPECT_NEAR(fitted.exact_terms / made.exact_terms, 1, 1e-6) << "alone in its run";
}

TEST(FitRates, UntimedKindsAreScaledByTheTimedOnes) {
  // Two kinds with 3 and 12 times their default rates: in the geometric mean a machine six times as fast.
  const SummationRates usual;
  std::vector<TimedWork> timed{{{.exact_terms = 1e6}, 1e6 / (3 * usual.exact_terms)},
                               {{.fft_operations = 1e8}, 1e8 / (12 * usual.fft_operations)}};
  const SummationRates fitted = fit_rates(timed);
  EXPECT_NEAR(fitted.spreads / usual.spreads, 6, 1e-9);
  EXPECT_EQ(fitted.bf16_multiply_adds, 0) << "a unit that nobody has found is not there";
}

TEST(FitRates, WorkThatTakesNoTimeStaysFinite) {
  // The second run does additional work of another kind in the same time: no time remains for that kind.
  const std::vector<TimedWork> timed{{{.multiply_adds = 1e6}, 1e-3}, {{.multiply_adds = 1e6, .factors = 1e6}, 1e-3}};
  const SummationRates fitted = fit_rates(timed);
  EXPECT_NEAR(fitted.factors, 1e11, 1e6) << "a hundredth of the run of 1e6 in 1e-3 s";
}

TEST(FitRates, RefusesRunsWithoutTimeOrWork) {
  EXPECT_THROW(fit_rates({{{.multiply_adds = 1}, 0}}), Error);
  EXPECT_THROW(fit_rates({{{}, 1}}), Error);
}

TEST(Calibrate, TimesEveryKindOnceAtLeastAndGivesCoarseRates) {
  const SummationRates rates = calibrate_summation();
  for (const SummationTerm& term : summation_terms) {
    if (rates.*term.rate == 0) {
      EXPECT_STREQ(term.name, "bf16_multiply_adds") << "the only unit that a machine may be without";
      continue;
    }
    EXPECT_TRUE(std::isfinite(rates.*term.rate)) << term.name;
    EXPECT_EQ(coarse_rate(rates.*term.rate), rates.*term.rate) << term.name;
  }
}

TEST(Calibrate, KeyNamesTheInstructionSet) {
  EXPECT_NE(calibration_key().find(tile_sum_instruction_set()), std::string::npos) << calibration_key();
  EXPECT_EQ(calibration_key(), calibration_key());
}

}  // namespace
}  // namespace holotrace
