#include <gtest/gtest.h>

#include <vector>

#include "holotrace/slm/encode/iterate/iteration_kernels.h"

namespace holotrace {
namespace {

struct Settled {
  std::vector<float> drive, rounded;
};

// 19 values: more than one vector of any instruction set, and a rest.
Settled settle(float turn, float levels, float hardness, float first) {
  Settled settled{std::vector<float>(19, first), std::vector<float>(19)};
  settle_drive(turn, levels, hardness, settled.drive.data(), settled.rounded.data(), settled.drive.size());
  for (size_t i = 1; i < 19; ++i) EXPECT_EQ(settled.rounded[i], settled.rounded[0]) << i;
  return settled;
}

TEST(SettleDrive, RoundsOnTheCircleOfPhases) {
  EXPECT_EQ(settle(8, 8, 1, 2.25F).rounded[0], 2);
  EXPECT_EQ(settle(8, 8, 1, 7.75F).rounded[0], 0);  // the level after the last one
  EXPECT_EQ(settle(8, 8, 1, 7.75F).drive[0], 7.75F);
  EXPECT_EQ(settle(8, 8, 1, -0.75F).drive[0], 7.25F);
  EXPECT_EQ(settle(8, 8, 1, 17.25F).drive[0], 1.25F);
}

TEST(SettleDrive, ClipsWithoutATurn) {
  EXPECT_EQ(settle(0, 4, 1, 5).drive[0], 3);
  EXPECT_EQ(settle(0, 4, 1, -1).drive[0], 0);
  EXPECT_EQ(settle(0, 4, 1, 1.75F).rounded[0], 2);
}

// drive + h·(level − drive); past the last level it goes toward a whole turn, which is level 0, and not back through all.
TEST(SettleDrive, SoftLevelsLieBetweenDriveAndLevel) {
  EXPECT_EQ(settle(8, 8, 0, 2.25F).rounded[0], 2.25F);
  EXPECT_EQ(settle(8, 8, 0.5F, 2.25F).rounded[0], 2.125F);
  EXPECT_EQ(settle(8, 8, 0.5F, 7.75F).rounded[0], 7.875F);
  EXPECT_EQ(settle(0, 4, 0.5F, 1.75F).rounded[0], 1.875F);
  EXPECT_EQ(settle(0, 4, 0.5F, 5).rounded[0], 3);
}

}  // namespace
}  // namespace holotrace
