#include <cmath>

#include "holotrace/slm/panel/show.h"
#include "support/panels.h"

// What show tells about the panel's effects, and the values that it refuses.

namespace holotrace {
namespace {

TEST(Effects, AreToldOnAndOff) {
  Slm slm = make_panel(8, 8, 4, 0.8);
  slm.effects.gap_amplitude = 0.6;
  slm.effects.flicker = 0.1;
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 1; });
  Heard heard;
  show(h, slm, with_effects({"gaps"}), heard.observer());
  EXPECT_EQ(std::get<std::string>(heard.facts.at("effects")), "gaps");
  EXPECT_EQ(std::get<std::string>(heard.facts.at("effects_off")), "flicker");
  EXPECT_TRUE(heard.warnings.empty());
  show(h, slm, with_effects({"crosstalk"}), heard.observer());
  ASSERT_EQ(heard.warnings.size(), 1u);
  EXPECT_EQ(heard.warnings[0], "the SLM \"test\" has no data for crosstalk; add them to [slm] or to the panel's file");
  EXPECT_EQ(error_of([&] { show(h, slm, with_effects({"crostalk"})); }),
            "unknown effect \"crostalk\"; did you mean \"crosstalk\"?");
}

TEST(Effects, OutOfRangeAreRefused) {
  const auto error = [](const std::function<void(Slm&)>& change) {
    Slm slm = make_panel(8, 4, 3);
    change(slm);
    return error_of([&] { check_slm(slm); });
  };
  EXPECT_EQ(error([](Slm& s) {
              s.effects.calibration = {{0, 1}, {1, 1}};
            }),
            "expected a calibration of 3 levels, as many as the panel has, got 2");
  EXPECT_EQ(error([](Slm& s) {
              s.effects.calibration = {{0, 1}, {2, 1}, {1.5, 1}};
            }),
            "expected a calibration whose phase never falls, got 1.5 rad after 2 rad at level 2");
  EXPECT_EQ(error([](Slm& s) {
              s.effects.calibration = {{0, 1}, {2, 1.5}, {3, 1}};
            }),
            "expected calibrated amplitudes in [0, 1], got 1.5 at level 1");
  EXPECT_EQ(error([](Slm& s) {
              s.effects.dead_pixels = {{8, 1, 0}};
            }),
            "expected dead pixels on the panel of 8 × 4 pixels, got column 8, row 1");
  EXPECT_EQ(error([](Slm& s) {
              s.effects.dead_pixels = {{7, 1, 3}};
            }),
            "expected dead pixels at a level below 3, got 3 at column 7, row 1");
  EXPECT_EQ(error([](Slm& s) { s.effects.dead_fraction = 1.5; }),
            "expected a fraction of dead pixels in [0, 1], got 1.5");
  EXPECT_EQ(error([](Slm& s) {
              s.effects.aberration = {{2, 1, 0.1}};
            }),
            "expected Zernike terms with 0 ≤ n ≤ 20, |m| ≤ n and n − |m| even, got n = 2, m = 1");
  EXPECT_EQ(error([](Slm& s) { s.fill_x = 0.9; }),
            "expected fill_x and fill_y, which belong together, got 0.9 in x, 0 in y; give both");
  EXPECT_EQ(error([](Slm& s) { s.fill_x = s.fill_y = 1.5; }),
            "expected fill factors of both axes in (0, 1], or of neither, got 1.5 in x, 1.5 in y");
  EXPECT_EQ(error([](Slm& s) { s.effects.phase_map = std::make_shared<Array2D<float>>(4, 7); }),
            "expected a phase map of 8 × 4 pixels, as the panel has, got 7 × 4");
  EXPECT_EQ(error([](Slm& s) { s.effects.light_map = std::make_shared<Array2D<float>>(4, 7); }),
            "expected a light map of 8 × 4 pixels, as the panel has, got 7 × 4");
  EXPECT_EQ(error([](Slm& s) {
              Array2D<float> map(4, 8);
              map(1, 2) = -0.1F;
              s.effects.light_map = std::make_shared<Array2D<float>>(map);
            }),
            "expected irradiances of 0 or more in the light map");
}

}  // namespace
}  // namespace holotrace
