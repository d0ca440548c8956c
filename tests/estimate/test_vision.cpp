#include <algorithm>

#include "holotrace/base/units.h"
#include "holotrace/estimate/limits.h"
#include "support/panels.h"

namespace holotrace {
namespace {

using namespace literals;

bool is_met(const std::vector<VisionNeed>& needs, const std::string& what) {
  const auto found = std::find_if(needs.begin(), needs.end(), [&](const VisionNeed& n) { return n.what == what; });
  EXPECT_NE(found, needs.end()) << what;
  return found->is_met;
}

TEST(Vision, FiguresAreThoseOfTheLiterature) {
  EXPECT_DOUBLE_EQ(HumanVision::acuity, pi / 180 / 60);     // 1 arc minute
  EXPECT_DOUBLE_EQ(HumanVision::foveal_low, 2 * pi / 180);  // the paper: 2 to 5 degrees,
  EXPECT_DOUBLE_EQ(HumanVision::foveal_high, 5 * pi / 180);
  EXPECT_DOUBLE_EQ(HumanVision::peripheral_low, 100 * pi / 180);  // and 100 to 140
  EXPECT_DOUBLE_EQ(HumanVision::peripheral_high, 140 * pi / 180);
}

TEST(Vision, ResolutionIsThatOfTheApertureWhateverTheDistance) {
  // λz/S ≤ acuity·z: S ≥ 632.8 nm / 2.909e-4 = 2.1754 mm, 272 pixels of 8 µm.
  for (const double z : {0.1, 1.0, 10.0}) {
    EXPECT_TRUE(is_met(compare_with_vision({273, 273, 8e-6}, 632.8_nm, z), "resolution"));
    EXPECT_FALSE(is_met(compare_with_vision({271, 1000, 8e-6}, 632.8_nm, z), "resolution"));
  }
}

TEST(Vision, FieldEyeboxAndFlicker) {
  const Grid pluto{1920, 1080, 8e-6}, fine{100000, 100000, 0.35e-6};
  const auto needs = compare_with_vision(pluto, 632.8_nm, 0.3_m, 30);
  EXPECT_FALSE(is_met(needs, "foveal field"));  // 4.53° < 5°
  EXPECT_FALSE(is_met(needs, "peripheral field"));
  EXPECT_FALSE(is_met(needs, "flicker"));
  EXPECT_TRUE(is_met(needs, "eyebox"));  // 2·11.87 mm − 15.36 mm = 8.4 mm, pupils are at most 8 mm
  EXPECT_FALSE(is_met(compare_with_vision(pluto, 532_nm, 0.3_m), "eyebox"));  // 2·9.98 − 15.36 = 4.6 mm
  // asin(632.8/700) = 64.7°, twice that is 129°.
  EXPECT_TRUE(is_met(compare_with_vision(fine, 632.8_nm, 0.3_m, 60), "peripheral field"));
  EXPECT_TRUE(is_met(compare_with_vision(fine, 632.8_nm, 0.3_m, 60), "flicker"));
  EXPECT_EQ(compare_with_vision(pluto, 532_nm, 0.3_m).size(), 4U);  // without a frame rate, no flicker
}

}  // namespace
}  // namespace holotrace
