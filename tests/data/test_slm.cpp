#include <gtest/gtest.h>

#include <algorithm>

#include "holotrace/data/slm.h"
#include "support/error_of.h"

namespace holotrace {
namespace {

// A panel with every effect, each of its figures different from its default.
Slm panel_with_all() {
  Slm slm;
  slm.grid = {2, 1, 8e-6};
  slm.levels = 2;
  SlmEffects& e = slm.effects;
  e.calibration = {{0, 1}, {3, 0.5}};
  e.crosstalk = 0.4;
  e.gap_amplitude = 0.3;
  e.gap_phase = 1.25;
  e.flicker = 0.02;
  e.aberration = {{2, 0, 0.7}};
  e.phase_map = std::make_shared<Array2D<float>>(1, 2, 0.1F);
  e.light_map = std::make_shared<Array2D<float>>(1, 2, 0.9F);
  e.dead_fraction = 0.25;
  e.dead_seed = 5;
  e.dead_pixels = {{1, 0, 1}};
  e.crystal = Crystal{.twist = 0.5};
  return slm;
}

// Every figure of an effect counts, because the same hologram is shown with it and without it.
void expect_figures(const SlmEffects& e, const SlmEffects& all, const std::vector<std::string>& names) {
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  EXPECT_EQ(e.calibration.size(), has("calibration") ? 2u : 0u);
  EXPECT_EQ(e.crosstalk, has("crosstalk") ? all.crosstalk : 0);
  EXPECT_EQ(e.gap_amplitude, has("gaps") ? all.gap_amplitude : 0);
  EXPECT_EQ(e.gap_phase, has("gaps") ? all.gap_phase : 0);
  EXPECT_EQ(e.flicker, has("flicker") ? all.flicker : 0);
  EXPECT_EQ(e.aberration.size(), has("aberration") ? 1u : 0u);
  EXPECT_EQ(e.phase_map, has("phase-map") ? all.phase_map : nullptr);
  EXPECT_EQ(e.light_map, has("light-map") ? all.light_map : nullptr);
  EXPECT_EQ(e.dead_fraction, has("dead-pixels") ? all.dead_fraction : 0);
  EXPECT_EQ(e.dead_seed, has("dead-pixels") ? all.dead_seed : SlmEffects{}.dead_seed);
  EXPECT_EQ(e.dead_pixels.size(), has("dead-pixels") ? 1u : 0u);
  EXPECT_EQ(e.crystal ? e.crystal->twist : 0, has("crystal") ? all.crystal->twist : 0);
}

TEST(SlmEffects, EachOneIsTurnedOnByItsNameWithAllItsFigures) {
  const Slm slm = panel_with_all();
  check_slm(slm);
  EXPECT_EQ(effects_of(slm), slm_effect_names());
  for (const std::string& name : slm_effect_names()) {
    SCOPED_TRACE(name);
    const Slm one = with_effects(slm, {name});
    EXPECT_EQ(effects_of(one), std::vector<std::string>{name});
    expect_figures(one.effects, slm.effects, {name});
  }
  expect_figures(with_effects(slm, {"all"}).effects, slm.effects, slm_effect_names());
  expect_figures(with_effects(slm, {"none"}).effects, slm.effects, {});
}

TEST(SlmEffects, DeadPixelsAreKnownOnesOrAFraction) {
  Slm listed, random;
  listed.effects.dead_pixels = {{1, 0, 1}};
  random.effects.dead_fraction = 0.01;
  for (const Slm& slm : {listed, random}) EXPECT_EQ(effects_of(slm), std::vector<std::string>{"dead-pixels"});
}

TEST(Slm, FillFactorsOfBothAxesAreFractions) {
  Slm slm;
  slm.grid = {2, 1, 8e-6};
  for (const auto& [x, y] : {std::pair{1.5, 0.5}, {0.5, 1.5}, {-0.5, 0.5}, {0.5, -0.5}}) {
    slm.fill_x = x, slm.fill_y = y;
    EXPECT_EQ(error_of([&] { check_slm(slm); }).rfind("expected fill factors of both axes in (0, 1], or of neither", 0),
              0U)
        << x << " " << y;
  }
  slm.fill_x = 0.5, slm.fill_y = 1;
  EXPECT_EQ(error_of([&] { check_slm(slm); }), "no error");
}

}  // namespace
}  // namespace holotrace
