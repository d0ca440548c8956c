// A panel's calibration between its points.

#include <gtest/gtest.h>

#include "holotrace/data/slm.h"

namespace holotrace {
namespace {

// All numbers are exact in binary: straight lines between points at half a step make no rounding.
TEST(Calibration, IsStraightBetweenPointsAndBeyondTheLastOnlyInPhase) {
  const std::vector<CalibrationPoint> points{{0, 1}, {1, 0.5}, {3, 0.25}};
  const CalibrationPoint between = calibration_at(points, 0.5), at_last = calibration_at(points, 2),
                         beyond = calibration_at(points, 2.5);
  EXPECT_EQ(between.phase, 0.5);
  EXPECT_EQ(between.amplitude, 0.75);
  EXPECT_EQ(at_last.phase, 3);
  EXPECT_EQ(at_last.amplitude, 0.25);
  EXPECT_EQ(beyond.phase, 4);  // 3 + (3 − 1)/2
  EXPECT_EQ(beyond.amplitude, 0.25);
}

}  // namespace
}  // namespace holotrace
