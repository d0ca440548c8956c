#include <gtest/gtest.h>

#include "holotrace/base/time_left.h"

namespace holotrace {
namespace {

TEST(TimeLeft, OfASteadyTaskIsExact) {
  TimeLeft left;
  EXPECT_FALSE(left.estimate(0, 0));
  EXPECT_FALSE(left.estimate(1, 0.01)) << "too early to tell";
  for (int second = 10; second < 100; second += 10)
    EXPECT_NEAR(*left.estimate(second, second / 100.0), 100 - second, 1e-9);
  EXPECT_FALSE(left.estimate(100, 1)) << "nothing is left";
}

TEST(TimeLeft, OfAResumedTaskCountsFromItsResumption) {
  // Half was done before; then a tenth of the whole takes 10 s.
  TimeLeft left;
  EXPECT_FALSE(left.estimate(0.1, 0.5));
  EXPECT_FALSE(left.estimate(0.9, 0.508)) << "less than a fiftieth of the rest";
  EXPECT_TRUE(left.estimate(1.3, 0.512)) << "more than a fiftieth of the rest, though not of the whole";
  EXPECT_NEAR(*left.estimate(10.1, 0.6), 40, 1e-9);
  EXPECT_NEAR(*left.estimate(20.1, 0.7), 30, 1e-9);
}

TEST(TimeLeft, VariesLessThanTheRate) {
  // Bands are finished two at a time: two in the time of one, then none.
  TimeLeft left;
  left.estimate(1, 0.01);
  double before = *left.estimate(10, 0.1);
  for (int step = 1; step < 8; ++step) {
    const double now = *left.estimate(10 + 10 * step, 0.1 * (step % 2 == 0 ? step + 1 : step + 1.5));
    EXPECT_LT(now, before) << "falls, though the rate wavers";
    before = now;
  }
}

TEST(Duration, IsWrittenInSuitableUnits) {
  EXPECT_EQ(format_duration(4.21), "4.2 s");
  EXPECT_EQ(format_duration(59.96), "1 min 00 s");
  EXPECT_EQ(format_duration(185), "3 min 05 s");
  EXPECT_EQ(format_duration(7800), "2 h 10 min");
}

}  // namespace
}  // namespace holotrace
