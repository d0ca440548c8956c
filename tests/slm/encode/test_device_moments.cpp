// The moduli of fields on OpenCL devices, against sums in double.

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/random.h"
#include "holotrace/slm/encode/shown_pixels.h"
#include "support/devices.h"
#include "support/targets.h"

namespace holotrace {
namespace {

class DeviceMoments : public test::OnEveryDevice {
 protected:
  static constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
  static constexpr float infinite = std::numeric_limits<float>::infinity();
};
HOLOTRACE_FOR_ALL_DEVICES(DeviceMoments);

TEST(UnitFor, IsAPowerOfTwoThatBringsModuliNearOne) {
  EXPECT_EQ(unit_for(0), 1);
  EXPECT_EQ(unit_for(1), 1);
  EXPECT_EQ(unit_for(1.99), 1);
  EXPECT_EQ(unit_for(0.3), 4);
  EXPECT_EQ(unit_for(1e30), std::ldexp(1.0F, -99));
  EXPECT_EQ(unit_for(4.8e38), std::ldexp(1.0F, -126)) << "no smaller float has all of its digits";
  EXPECT_EQ(unit_for(1e-44), std::ldexp(1.0F, 126));
}

// 40,000 columns of equal samples, where plain sums are off by 1e-5: one millionth (test_device_field.cpp).
TEST_P(DeviceMoments, AreThoseOfTheSamples) {
  for (const float scale : {1.0F, 1e-30F, 1e30F}) {
    Field field({40'000, 2, test_pitch}, test_wavelength);
    for (size_t i = 0; i < field.samples.size(); ++i)
      field.samples.values[i] =
          scale * (i < 40'000 ? std::complex<float>(0.6F, 0.31F)
                              : std::complex<float>(std::polar(1e-5 * double(i), 0.1 * double(i))));
    field.samples.values[17] = scale * std::complex<float>(0, -3);
    double sum = 0, square = 0;
    for (const std::complex<double> u : field.samples.values) {
      sum += std::abs(u);
      square += std::norm(u);
    }
    const ModulusMoments moments = modulus_moments(send(device_, field));
    EXPECT_NEAR(moments.largest, 3.0 * double(scale), 1e-6 * double(scale));
    EXPECT_NEAR(moments.sum, sum, 1e-6 * sum);
    EXPECT_NEAR(moments.square, square, 1e-6 * square);
  }
}

// More rows than a launch of some makers' devices takes (most_groups_across); the largest modulus is in the second part.
TEST_P(DeviceMoments, CountAllRowsOfATallField) {
  Field field({2, int(most_groups_across) + 90, test_pitch}, test_wavelength);
  for (auto& u : field.samples.values) u = 0.5F;
  field.samples.values.back() = 3;
  const ModulusMoments moments = modulus_moments(send(device_, field));
  const double others = 2.0 * field.grid.ny - 1;
  EXPECT_EQ(moments.largest, 3);
  EXPECT_EQ(moments.sum, 0.5 * others + 3);  // sums of these numbers are exact in float
  EXPECT_EQ(moments.square, 0.25 * others + 9);
}

TEST_P(DeviceMoments, TellOfASampleThatIsNotFinite) {
  const Grid grid{70, 3, test_pitch};
  for (const std::complex<float> bad : {std::complex<float>(not_a_number, 0), {0, not_a_number}, {0, -infinite}}) {
    for (const size_t place : {size_t(0), size_t(69), size_t(209)}) {
      Field field = random_field(grid, 2);
      field.samples.values[place] = bad;
      EXPECT_FALSE(std::isfinite(modulus_moments(send(device_, field)).largest)) << bad << " at " << place;
    }
  }
  Field largest(grid, test_wavelength);
  largest.samples.values[100] = {std::numeric_limits<float>::max(), -std::numeric_limits<float>::max()};
  EXPECT_NEAR(modulus_moments(send(device_, largest)).largest, std::sqrt(2.0) * std::numeric_limits<float>::max(),
              1e32);
}

// Moduli in the middle of steps, where rounding does not matter; in one go, and by one, two or all rows at once.
TEST_P(DeviceMoments, CountModuliStepByStep) {
  constexpr int steps = 40;
  Field field({130, 5, test_pitch}, test_wavelength);
  CounterRandom random(4, 0, 0);
  std::vector<int64_t> expected(steps + 1);
  for (auto& u : field.samples.values) {
    const int step = int(random.uniform() * random.uniform() * steps);
    u = std::complex<float>(std::polar(2.0 * (step + 0.5) / steps, 6 * random.uniform()));
    ++expected[size_t(step)];
  }
  const DeviceField there = send(device_, field);
  EXPECT_EQ(count_moduli(there, 2, steps), expected);
  for (const int64_t at_once : {1, 130, 260, 389, 650}) EXPECT_EQ(count_moduli(there, 2, steps, at_once), expected);
}

TEST_P(DeviceMoments, ClipModuliAndTellWhatIsCutOff) {
  Field field = random_field({70, 3, test_pitch}, 6);  // moduli 0.5 to 1.5
  field.samples.values[5] = 0;
  DeviceField there = send(device_, field);
  double expected = 0;
  const double cut = clip_moduli(there, 1.25);
  const Field clipped = fetch(there);
  for (size_t i = 0; i < field.samples.size(); ++i) {
    const std::complex<double> u(field.samples.values[i]);
    expected += std::max(0.0, std::norm(u) - 1.25 * 1.25);
    EXPECT_LT(std::abs(std::complex<double>(clipped.samples.values[i]) - u / std::max(1.25, std::abs(u))), 3e-7);
  }
  EXPECT_NEAR(cut, expected, 1e-5 * expected);  // differences of squares near each other
}

}  // namespace
}  // namespace holotrace
