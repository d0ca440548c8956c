// From levels through the virtual SLM to the far field: values for gratings from textbooks and manufacturers.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/scene/slm_file.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/panels.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

using Effects = std::vector<std::string>;

// Saves a hologram to the file for a panel and loads it again.
Hologram through_file(const Workplace& here, const Hologram& hologram) {
  const std::string path = here.path("hologram.png");
  save_hologram(path, hologram);
  return load_hologram(path);
}

Slm lit_fully(int nx, int ny, int levels) { return make_panel(nx, ny, levels, 1); }

// A plane wave into order 1 of a grating of `period` pixels, as input of an encoder: phases in the middle of the
// levels' steps, so that rounding has no effect.
Field ramp(const Slm& slm, int period) {
  Field f(slm.grid, test_wavelength);
  for (int j = 0; j < slm.grid.ny; ++j)
    for (int i = 0; i < slm.grid.nx; ++i) {
      const double shift = period > slm.levels ? 0.5 - period / (2.0 * slm.levels) : 0;
      f.samples(j, i) = std::complex<float>(std::polar(1.0, 2 * pi * (i + shift) / period));
    }
  return f;
}

TEST(SlmChain, BlazedGratingsHaveTheEfficiencyOfTheirLevels) {
  // closed_forms.md, section 3: η₁ = sinc²(1/M) to the digits there, and only orders 1 + qM with sinc²(m/M). Single
  // precision is correct to 1e-6.
  const Workplace here;
  struct Case {
    int levels;
    double first;
  };
  for (const Case& c : {Case{2, 0.405285}, Case{3, 0.683918}, Case{4, 0.810569}, Case{8, 0.949641}, Case{16, 0.987215},
                        Case{32, 0.996791}, Case{64, 0.999197}, Case{128, 0.999799}, Case{256, 0.9999498}}) {
    const int period = std::max(c.levels, c.levels == 3 ? 24 : 32);
    const Slm slm = lit_fully(2 * period, 2, c.levels);
    const Hologram hologram = through_file(here, encode(ramp(slm, period), slm, {}));
    const Field f = show(hologram, slm, {.subpixels = 3});
    EXPECT_NEAR(efficiency_of(f, 2), c.first, 1.5e-6) << c.levels;
    const int highest = std::min(3 * period / 2 - 1, 40);
    for (int m = -highest; m <= highest; ++m) {
      const double expected = (m - 1) % c.levels == 0 ? std::pow(sinc(double(m) / c.levels), 2) : 0;
      EXPECT_NEAR(efficiency_of(f, 2 * m), expected, 1.5e-6) << c.levels << " levels, order " << m;
    }
  }
}

TEST(SlmChain, OrdersHaveTheEfficienciesOfTextbooks) {
  // M = 4: order −3 0.090063, 5 0.032423; M = 8: −7 0.019380, 9 0.011724.
  for (const auto& [levels, order, expected] :
       {std::tuple{4, -3, 0.090063}, {4, 5, 0.032423}, {8, -7, 0.019380}, {8, 9, 0.011724}}) {
    const Slm slm = lit_fully(32, 2, levels);
    const Field f = show(encode(ramp(slm, 16), slm, {}), slm, {.subpixels = 3});
    EXPECT_NEAR(efficiency_of(f, 2 * order), expected, 1.5e-6) << levels << ", " << order;
  }
}

// Power of a beam in order m of a grating of `period` pixels at z, as a fraction of the power in the window.
double power_in_order(const Field& at_z, int period, int m, double z) {
  const double place = z * std::tan(std::asin(m * test_wavelength / (period * test_pitch)));
  const double next = z * test_wavelength / (period * test_pitch);
  double inside = 0;
  for (int j = 0; j < at_z.grid.ny; ++j)
    for (int i = 0; i < at_z.grid.nx; ++i)
      if (std::abs(at_z.grid.x(i) - place) < next / 2) inside += std::norm(at_z.samples(j, i));
  return inside * at_z.grid.pitch * at_z.grid.pitch;
}

TEST(SlmChain, OrdersAreSeparateWhereTheGratingEquationSays) {
  // A beam of w = 0.1 mm on a blazed grating of 4 levels, at 30 mm: the orders are 0.5 mm apart, 4.4 beam radii, and
  // a window of that width contains all but erfc(3.1) = 1e-5 of each. The beam's width in frequency is 1/(πw), compared
  // with 1/4p between orders: the slope of the envelope changes the power of an order by (4p/πw)² = 1e-2 of that slope.
  const int period = 4;
  const double z = 0.03;
  Slm slm = lit_fully(640, 96, 4);
  const Hologram h = make_hologram(slm, Modulation::phase, [&](int i) { return i % period; });
  ShowParams params{.subpixels = 3, .light = Wavefront::gaussian, .beam_radius = 0.1e-3};
  Heard heard;
  const Field far = propagate(show(h, slm, params, heard.observer()), z);
  const double in = heard.number("power_in");
  EXPECT_NEAR(power_in_order(far, period, 1, z) / in, 0.810569, 2e-3);
  EXPECT_NEAR(power_in_order(far, period, -3, z) / in, 0.090063, 2e-3);
  EXPECT_NEAR(power_in_order(far, period, 0, z) / in, 0, 1e-4);
  EXPECT_NEAR(power_in_order(far, period, -1, z) / in, 0, 1e-4);

  // With tilted light, all orders move by its angle: the place of order 0 is now empty, and order 1 is at that of 2.
  params.tilt_x = std::asin(test_wavelength / (period * test_pitch));
  const Field moved = propagate(show(h, slm, params), z);
  EXPECT_NEAR(power_in_order(moved, period, 2, z) / in, 0.810569, 2e-3);
  EXPECT_NEAR(power_in_order(moved, period, 1, z) / in, 0, 1e-3);
}

TEST(SlmChain, AnEncoderThatKnowsTheCalibrationGetsItsLightBack) {
  // A panel with a curved phase response up to 2.2π. Assuming an even 2π loses light. The nearest phases give that of
  // a blazed grating again, except for the remaining steps of at most 1.25 levels of 256: a loss of (π·1.25/256)²/3.
  const int period = 32;
  Slm slm = lit_fully(64, 2, 256);
  for (int level = 0; level < 256; ++level) {
    const double t = level / 255.0;
    slm.effects.calibration.push_back({2.2 * pi * (0.75 * t + 0.25 * t * t), 1});
  }
  const ShowParams params{.subpixels = 3, .effects = {"calibration"}};
  const auto first = [&](const Effects& known) {
    return efficiency_of(show(encode(ramp(slm, period), slm, {.effects = known}), slm, params), 2);
  };
  const double ideal = std::pow(sinc(1.0 / period), 2);
  EXPECT_NEAR(first({"calibration"}), ideal, 1e-4);
  EXPECT_LT(first({}), ideal - 0.01);
}

TEST(SlmChain, EveryFaultOfAPanelTakesLightFromTheImage) {
  Slm slm = slm_preset("pluto");
  slm.grid = {64, 8, slm.grid.pitch};
  const Hologram h = make_hologram(slm, Modulation::phase, [](int i) { return i * 32 % 256; });
  const double none = efficiency_of(show(h, slm, {.subpixels = 3}), 8);
  EXPECT_NEAR(none, 0.93 * 0.93 * std::pow(sinc(std::sqrt(0.93) / 8), 2), 1e-6);
  for (const std::string& name : effects_of(slm)) {
    const ShowParams params{.subpixels = 3, .effects = {name}};
    const IlluminationState crest{test_wavelength, 0, 0, 1};
    const double left = efficiency_of(show(h, slm, params, crest), 8);
    if (name == "gaps") {  // they reflect light that the pattern does not change: only to the panel's own orders
      EXPECT_NEAR(left, none, 1e-6);
    } else {
      EXPECT_LT(left, none) << name;
    }
  }
}

TEST(SlmChain, TheProgramShowsAPanelsEffects) {
  const Workplace here;
  here.write("panel.toml",
             "columns = 64\nrows = 48\npitch = \"8 um\"\ncrosstalk = 0.3\ngap_amplitude = 0.5\nflicker = 0.05\n");
  const Outcome info = here.run({"info", "--slm", "panel.toml", "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  const nlohmann::json panel = nlohmann::json::parse(info.out);
  EXPECT_EQ(panel["crosstalk"], "0.3 pixels (2.4 µm)");
  EXPECT_EQ(panel["pixels"], "64x48");

  here.write(
      "scene.toml",
      "wavelength = \"532 nm\"\n[slm]\ncolumns = 64\nrows = 48\ncrosstalk = 0.3\n[[object]]\n"
      "type = \"wireframe_cube\"\nsize = \"0.1 mm\"\nposition = \"0 0 -20 mm\"\n[trace]\ncolumns = 8\nrows = 8\n");
  const Outcome run = here.run({"run", "scene.toml", "-o", "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json report = nlohmann::json::parse(here.read("out/report.json"));
  bool is_told = false;
  for (const auto& stage : report["stages"]) {
    if (stage["stage"] != "show") continue;
    is_told = true;
    EXPECT_EQ(stage["effects"], "crosstalk");
    EXPECT_EQ(stage["effects_off"], "calibration, gaps, flicker, aberration");
  }
  EXPECT_TRUE(is_told);
  // The hologram has the panel and its effects, and knows which are its own. They are shown unless none are wanted.
  const Outcome with = here.run({"show", "out/hologram.png", "-o", "with.exr", "--effects", "crosstalk"});
  ASSERT_EQ(with.exit_code, 0) << with.err;
  const Outcome own = here.run({"show", "out/hologram.png", "-o", "own.exr"});
  ASSERT_EQ(own.exit_code, 0) << own.err;
  EXPECT_TRUE(here.read("with.exr") == here.read("own.exr"));
  const Outcome without = here.run({"show", "out/hologram.png", "-o", "without.exr", "--effects", "none"});
  ASSERT_EQ(without.exit_code, 0) << without.err;
  EXPECT_FALSE(here.read("with.exr") == here.read("without.exr"));

  const Outcome wrong = here.run({"show", "out/hologram.png", "-o", "x.png", "--effects", "crostalk"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_NE(wrong.err.find("unknown effect \"crostalk\"; did you mean \"crosstalk\"?"), std::string::npos) << wrong.err;
  const Outcome unknown = here.run({"info", "--slm", "plutto"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.err.find("did you mean \"pluto\"?"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace holotrace::test
