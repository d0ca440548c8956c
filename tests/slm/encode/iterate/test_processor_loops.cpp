#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/slm/encode/iterate/processor_loops.h"

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

// The formulas of devices (descent_kernel.h) against the vectors of the processor, for 1e5 random values: equal but for the
// rounding of products that one of them adds without rounding, 1e-7, and roundings of halves.
class DescentFormulas : public ::testing::Test {
 protected:
  static constexpr size_t count = 100000;
  static std::vector<float> drawn(float least, float most, uint64_t seed) {
    CounterRandom random(seed, 0, 0);
    std::vector<float> values(count);
    for (float& value : values) value = least + (most - least) * float(random.uniform());
    return values;
  }
  static void expect_near(float found, float expected, float scale) {
    EXPECT_NEAR(found, expected, 4e-7F * (std::abs(expected) + scale));
  }
};

TEST_F(DescentFormulas, StepAsTheVectorsDo) {
  const AdamStep adam{0.9F, 0.99F, 3, 1e-3F};
  const std::vector<float> slope = drawn(-1, 1, 1), mean = drawn(-1, 1, 2), square = drawn(0, 1, 3),
                           drive = drawn(-300, 300, 4);
  std::vector<float> m = mean, v = square, x = drive;
  adam_step(adam, slope.data(), m.data(), v.data(), x.data(), count);
  for (size_t i = 0; i < count; ++i) {
    const descent_kernel::AdamPixel pixel = descent_kernel::adam_pixel(adam, slope[i], {drive[i], mean[i], square[i]});
    expect_near(pixel.mean, m[i], 1);
    expect_near(pixel.square, v[i], 1);
    expect_near(pixel.drive, x[i], 300);
  }
}

TEST_F(DescentFormulas, SettleAsTheVectorsDo) {
  const std::vector<float> start = drawn(-300, 600, 5);
  for (const auto& [turn, levels, hardness] :
       {std::tuple(256.0F, 256.0F, 1.0F), {200.5F, 256, 1}, {0, 256, 1}, {3, 3, 0.4F}, {0, 2, 0.4F}}) {
    std::vector<float> drive = start, rounded(count);
    settle_drive(turn, levels, hardness, drive.data(), rounded.data(), count);
    size_t differing = 0;
    for (size_t i = 0; i < count; ++i) {
      const auto settled = descent_kernel::settle_pixel(turn, levels, hardness, start[i]);
      const bool is_near = std::abs(settled.drive - drive[i]) < 1e-4 && std::abs(settled.rounded - rounded[i]) < 1e-4;
      differing += !is_near;
    }
    EXPECT_LE(differing, 2u) << turn << " " << hardness;  // at a half, or at a whole turn
  }
}

TEST_F(DescentFormulas, LeaveTheResidualOfTheVectors) {
  const std::vector<float> amplitude = drawn(0, 2, 6), weight = drawn(0, 1, 7);
  std::vector<float> power = drawn(0, 4, 8);
  for (size_t i = 0; i < count; i += 100) power[i] = 0;
  std::vector<float> factor = power;
  const double error = take_residual(factor.data(), amplitude.data(), weight.data(), 0.8F, count);
  double sum = 0;
  for (size_t i = 0; i < count; ++i) {
    const auto residual = descent_kernel::residual_of_pixel(power[i], amplitude[i], weight[i], 0.8F);
    expect_near(residual.factor, factor[i], 1);
    sum += double(residual.error);
  }
  EXPECT_NEAR(sum, error, 1e-5 * error);  // sums of floats
}

TEST_F(DescentFormulas, HaveTheUnitModulusOfTheVectors) {
  std::vector<float> u = drawn(-1, 1, 11), d = drawn(-1, 1, 12);
  for (size_t i = 0; i < count; i += 100) {  // sums of 0
    d[i] = -u[i];
    d[i + 1] = -u[i + 1];
  }
  std::vector<float> moved = u;
  add_and_make_unit_modulus(reinterpret_cast<std::complex<float>*>(moved.data()),
                            reinterpret_cast<const std::complex<float>*>(d.data()), count / 2);
  for (size_t i = 0; i < count; i += 2) {
    const descent_kernel::Phasor unit = descent_kernel::unit_modulus({u[i] + d[i], u[i + 1] + d[i + 1]});
    expect_near(unit.re, moved[i], 1);
    expect_near(unit.im, moved[i + 1], 1);
  }
  EXPECT_EQ(descent_kernel::unit_modulus({0, 0}).re, 1);
  EXPECT_EQ(descent_kernel::unit_modulus({0, 0}).im, 0);
}

// asked·(1 + (s·a/A − 1)/10), by hand for s = 2, a = 3: a goal of 6.
TEST(Strengthened, FollowsTheLackOfLight) {
  using descent_kernel::strengthened;
  EXPECT_FLOAT_EQ(strengthened(3, 3, 36, 2), 3);        // as wanted
  EXPECT_FLOAT_EQ(strengthened(3, 3, 16, 2), 3.15F);    // A = 4: 6/4 − 1 = 1/2
  EXPECT_FLOAT_EQ(strengthened(3, 3, 144, 2), 2.85F);   // A = 12: −1/2
  EXPECT_FLOAT_EQ(strengthened(3, 3, 1, 2), 3.3F);      // A = 1: 5, limited to 1
  EXPECT_FLOAT_EQ(strengthened(3, 3, 0, 2), 3.3F);      // no light
  EXPECT_FLOAT_EQ(strengthened(5.9F, 3, 0, 2), 6);      // at most twice the wanted amplitude
  EXPECT_FLOAT_EQ(strengthened(1.5F, 0, 16, 2), 1.5F);  // nothing is wanted
}

TEST_F(DescentFormulas, HaveTheSlopeOfThePhase) {
  const std::vector<float> a = drawn(-1, 1, 9), b = drawn(-1, 1, 10);
  std::vector<float> slope(count / 2);
  const auto pairs = [](const std::vector<float>& values) {
    return reinterpret_cast<const std::complex<float>*>(values.data());
  };
  add_phase_gradient(pairs(a), pairs(b), 2, slope.data(), slope.size());
  for (size_t i = 0; i < slope.size(); ++i)
    expect_near(2 * descent_kernel::phase_slope(a[2 * i], a[2 * i + 1], b[2 * i], b[2 * i + 1]), slope[i], 1);
}

}  // namespace
}  // namespace holotrace
