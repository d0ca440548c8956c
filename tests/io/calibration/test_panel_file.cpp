#include <filesystem>

#include "holotrace/io/calibration/calibration_files.h"
#include "holotrace/io/scene/scene_file.h"
#include "support/panels.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

Slm measured() {
  Slm slm = make_panel(70, 64);
  slm.name = "my \"first\" panel";
  slm.source = "bench 2";
  slm.fill_factor = 0.9;
  slm.design_wavelength = 633e-9;
  slm.phase_range = 6.5;
  for (int level = 0; level < 256; ++level) slm.effects.calibration.push_back({level / 40.0, 1 - level / 5000.0});
  slm.effects.crosstalk = 0.234567;
  slm.effects.gap_amplitude = 0.4;
  slm.effects.gap_phase = -0.3;
  slm.effects.aberration = {{2, 0, 0.5}, {3, -1, -0.25}};
  Array2D<float> light(64, 70);
  for (size_t i = 0; i < light.size(); ++i) light.values[i] = 0.5F + float(i % 13) / 7;
  slm.effects.light_map = std::make_shared<const Array2D<float>>(light);
  return slm;
}

TEST(PanelFile, GivesTheSamePanelAgain) {
  const Slm slm = measured();
  const std::string path = test::temporary("panel.toml");
  save_panel(path, slm);
  const Slm again = load_slm(path);
  EXPECT_EQ(again.name, slm.name);
  EXPECT_EQ(again.source, slm.source);
  EXPECT_EQ(again.grid.nx, 70);
  EXPECT_EQ(again.grid.ny, 64);
  EXPECT_DOUBLE_EQ(again.grid.pitch, slm.grid.pitch);
  EXPECT_EQ(again.levels, 256);
  EXPECT_EQ(again.fill_factor, 0.9);
  EXPECT_DOUBLE_EQ(again.phase_range, 6.5);
  EXPECT_DOUBLE_EQ(again.design_wavelength, 633e-9);
  EXPECT_EQ(effects_of(again), effects_of(slm));
  for (size_t level = 0; level < 256; ++level) {  // six digits are written
    EXPECT_NEAR(again.effects.calibration[level].phase, slm.effects.calibration[level].phase, 1e-6);
    EXPECT_NEAR(again.effects.calibration[level].amplitude, slm.effects.calibration[level].amplitude, 1e-6);
  }
  EXPECT_NEAR(again.effects.crosstalk, 0.234567, 1e-9);
  EXPECT_NEAR(again.effects.gap_amplitude, 0.4, 1e-9);
  EXPECT_NEAR(again.effects.gap_phase, -0.3, 1e-9);
  ASSERT_EQ(again.effects.aberration.size(), 2u);
  EXPECT_EQ(again.effects.aberration[1].n, 3);
  EXPECT_EQ(again.effects.aberration[1].m, -1);
  EXPECT_NEAR(again.effects.aberration[1].rms, -0.25, 1e-9);
  EXPECT_EQ(again.effects.light_map->values, slm.effects.light_map->values);
  EXPECT_EQ(panel_paths("a/p.toml", slm), (std::vector<std::string>{"a/p.toml", "a/p_phase.csv", "a/p_light.exr"}));
  for (const std::string& file : panel_paths(path, slm)) EXPECT_TRUE(std::filesystem::exists(file)) << file;
}

TEST(PanelFile, OfAPanelWithoutEffectsHasNoOtherFiles) {
  Slm slm = make_panel(8, 6);
  slm.fill_x = 0.9;
  slm.fill_y = 0.8;
  const std::string path = test::temporary("plain.toml");
  save_panel(path, slm);
  const Slm again = load_slm(path);
  EXPECT_EQ(again.fill_x, 0.9);
  EXPECT_EQ(again.fill_y, 0.8);
  EXPECT_EQ(effects_of(again), std::vector<std::string>{});
  EXPECT_EQ(panel_paths(path, slm).size(), 1u);
  EXPECT_EQ(error_of([&] { save_panel("panel.json", slm); }),
            "expected a panel file .toml, got panel.json; change its extension");
}

}  // namespace
}  // namespace holotrace
