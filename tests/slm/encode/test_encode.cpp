#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/off_axis.h"
#include "holotrace/slm/panel/pixel_kernel.h"
#include "holotrace/slm/panel/pixel_response.h"
#include "holotrace/slm/panel/show.h"
#include "support/devices.h"
#include "support/panels.h"

namespace holotrace {
namespace {

TEST(PhaseLevel, IsTheNearestAndWrapsAround) {
  for (int levels : {2, 3, 4, 256, 65536})
    for (int level = 0; level < levels; level += std::max(1, levels / 64))
      for (double off : {-0.49, 0.0, 0.49}) {  // of a step: just inside the level's own sector
        const double angle = 2 * pi * (level + off) / levels;
        EXPECT_EQ(phase_level(std::cos(angle), std::sin(angle), levels), level) << levels << " " << off;
      }
  EXPECT_EQ(phase_level(0, 0, 256), 0);
  EXPECT_EQ(phase_level(-1, -0.0, 3), phase_level(-1, 0.0, 3));  // π and −π are one phase
}

TEST(PhaseLevel, IsTheNearestShownPhaseForAnyRangeOfThePanel) {
  // Compared with all levels of the first turn, by the distance around the circle.
  for (double stretch : {0.3, 0.7, 0.999, 1.0, 1.001, 1.19, 1.407, 2.5})
    for (int levels : {2, 5, 256})
      for (int k = 0; k < 997; ++k) {
        const double wanted = k / 997.0;
        const auto off = [&](int level) {
          const double d = std::abs(wanted - stretch * level / levels);
          return std::min(d, std::abs(1 - d));
        };
        double best = 1;
        for (int level = 0; level < levels; ++level) best = std::min(best, off(level));
        const int level = phase_level(std::cos(2 * pi * wanted), std::sin(2 * pi * wanted), levels, stretch);
        // Levels beyond a turn may be nearer, by less than the half step by which those of the first turn may be wrong.
        const double half_step = stretch / levels / 2, gap = std::max(0.0, 1 - stretch * (levels - 1) / levels) / 2;
        EXPECT_LE(off(level), stretch <= 1 ? best + 1e-12 : std::max(half_step, gap) + 1e-12)
            << stretch << " " << levels << " " << wanted;
        EXPECT_LE(stretch * level / levels, 1 + half_step);
      }
}

TEST(PhaseLevel, OfTwoAsNearInATableIsTheLower) {
  const LevelTable table(make_panel(4, 4, 4), 4, 1);  // 0, ¼, ½, ¾ of a turn
  const int expected[] = {0, 1, 2, 0};                // level 0 is next to level 3
  for (int l = 0; l < 4; ++l) EXPECT_EQ(table.level_of((2 * l + 1) / 8.0), expected[l]) << l;
  Slm measured = make_panel(4, 4, 4);
  measured.effects.calibration = {{0, 1}, {pi / 2, 1}, {pi / 2, 1}, {pi, 1}};  // levels 1 and 2 show the same
  EXPECT_EQ(LevelTable(measured, 4, 1).level_of(0.25), 1);
}

TEST(AmplitudeLevel, IsTheNearestAndIsClipped) {
  EXPECT_EQ(amplitude_level(0.49 / 255, 256), 0);
  EXPECT_EQ(amplitude_level(0.51 / 255, 256), 1);
  EXPECT_EQ(amplitude_level(1, 65536), 65535);
  EXPECT_EQ(amplitude_level(1.5, 256), 255);
  EXPECT_EQ(amplitude_level(-0.5, 256), 0);
}

TEST(EncodePhase, QuantisedRampHasEveryOrderOfItsLevels) {
  // A smooth wave of 4·M pixels per period gives M steps of 4 pixels: orders m = 1 + qM with sinc²(m/M), no other
  // (closed_forms.md 3 and case 15). 1e-6: single precision.
  for (int levels : {2, 3, 4, 8, 16, 32, 64, 128, 256}) {
    const Slm slm = make_panel(4 * levels, 2, levels);
    const Field wave = sum_of({{1, 0, {0.7, 0}}}, slm.grid);
    const Field f = show(encode(wave, slm, {}), slm, {.subpixels = 3});
    const int highest = std::min(5 * levels, 300);  // 6·M would be the Nyquist frequency of these samples
    for (int m = -highest; m <= highest; ++m) {
      const double expected = (m - 1) % levels == 0 ? std::pow(sinc(double(m) / levels), 2) : 0;
      EXPECT_NEAR(efficiency_of(f, m), expected, 1e-6) << levels << " levels, order " << m;
    }
  }
}

TEST(EncodePhase, LevelsGiveTheEfficienciesOfTheTextbook) {
  const std::pair<int, double> table[] = {{2, 0.405285},  {3, 0.683918},   {4, 0.810569},
                                          {8, 0.949641},  {16, 0.987215},  {32, 0.996791},
                                          {64, 0.999197}, {128, 0.999799}, {256, 0.9999498}};
  for (const auto& [levels, efficiency] : table) {
    const Slm slm = make_panel(4 * levels, 2, levels);
    const Field f = show(encode(sum_of({{1, 0, 1}}, slm.grid), slm, {}), slm, {.subpixels = 3});
    EXPECT_NEAR(efficiency_of(f, 1), efficiency, 1e-6) << levels;
    if (levels == 4) {
      EXPECT_NEAR(efficiency_of(f, -3), 0.090063, 1e-6);
      EXPECT_NEAR(efficiency_of(f, 5), 0.032423, 1e-6);
    }
    if (levels == 8) {
      EXPECT_NEAR(efficiency_of(f, -7), 0.019380, 1e-6);
      EXPECT_NEAR(efficiency_of(f, 9), 0.011724, 1e-6);
    }
  }
}

TEST(EncodePhase, WaveKeepsItsDirectionAndPhaseInXAndY) {
  const Slm slm = make_panel(24, 16, 65536);
  for (int n : {1, 2, 3, 4})
    for (const auto& [a, b] : {std::pair{3, 0}, {-2, 0}, {0, 2}, {2, -3}}) {
      const Field wave = sum_of({{a, b, std::polar(2.0, 0.4)}}, slm.grid);
      const Field f = show(encode(wave, slm, {}), slm, {.subpixels = n});
      // Modulus: the pixel's sinc along both axes. Phase: that of the field to half a level, 5e-5 rad.
      const std::complex<double> expected = std::polar(sinc(a / 24.0) * sinc(b / 16.0), 0.4);
      EXPECT_LT(std::abs(wave_in(f, a, b) - expected), 1e-4) << n << ": " << a << ", " << b;
    }
}

TEST(EncodePhase, RealImageIsTheConjugate) {
  const Slm slm = make_panel(24, 16, 65536);
  const Field wave = sum_of({{3, 2, std::polar(1.0, 0.4)}}, slm.grid);
  const Hologram h = encode(wave, slm, {.image = ImageSide::real_image});
  EXPECT_EQ(h.image, ImageSide::real_image);
  const std::complex<double> expected = std::polar(sinc(3 / 24.0) * sinc(2 / 16.0), -0.4);
  EXPECT_LT(std::abs(wave_in(show(h, slm, {}), -3, -2) - expected), 1e-4);  // half a level is 5e-5 rad
}

class EncodeOn : public ::testing::TestWithParam<DeviceChoice> {
 protected:
  // Half a level and rounding: of doubles on the processor; of floats on a device, 1e-6 of the largest value.
  static double half_level(int levels) { return 0.501 + (GetParam().kind == DeviceKind::cpu ? 0 : 1e-6 * levels); }
};
class EncodeAmplitude : public EncodeOn {};
class EncodeOffAxis : public EncodeOn {};
class Encode : public EncodeOn {};
INSTANTIATE_TEST_SUITE_P(On, EncodeAmplitude, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);
INSTANTIATE_TEST_SUITE_P(On, EncodeOffAxis, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);
INSTANTIATE_TEST_SUITE_P(On, Encode, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);

TEST_P(EncodeAmplitude, HoldsTheModulusOverItsMaximum) {
  const Slm slm = make_panel(64, 48, 256);
  const Field field = sum_of(random_waves(8, 20, 3), slm.grid);
  Heard heard;
  const Hologram h = encode(field, slm, {.method = Encoding::amplitude, .device = GetParam()}, heard.observer());
  EXPECT_EQ(h.modulation, Modulation::amplitude);
  EXPECT_EQ(h.encoder, "amplitude");
  const double top = heard.number("modulus_max");
  double mean = 0;
  for (int j = 0; j < 48; ++j)
    for (int i = 0; i < 64; ++i) {
      const double wanted = std::abs(field.samples(j, i)) / top;
      EXPECT_NEAR(h.level(j, i) / 255.0, wanted, 0.5001 / 255);  // half a level
      mean += wanted / (64 * 48);
    }
  EXPECT_NEAR(heard.number("mean_transmittance"), mean, 1e-6);
  ASSERT_EQ(heard.warnings.size(), 1u);  // the test panel modulates phase
  EXPECT_NE(heard.warnings[0].find("crossed polariser"), std::string::npos);
}

TEST(EncodeReference, DefaultReferenceLeavesTheWidestBand) {
  const Grid grid{64, 64, test_pitch};
  // With bias the band B fits f − B = 2B below and f + B = 1/2p above: f = 3/8p, B = 1/8p.
  const Vec2 carrier = reference_carrier({}, grid, test_wavelength);
  EXPECT_DOUBLE_EQ(carrier.x, 3 / (8 * test_pitch));
  EXPECT_EQ(carrier.y, 0);
  EXPECT_DOUBLE_EQ(off_axis_filter(carrier, grid, true).half_u, 1 / (8 * test_pitch));
  // Without bias: only the twins at ±f, f = 1/4p.
  EXPECT_DOUBLE_EQ(reference_carrier({.with_bias = false}, grid, test_wavelength).x, 1 / (4 * test_pitch));
}

TEST_P(EncodeOffAxis, HoldsTheInterferencePattern) {
  // Eq. 9 pixel by pixel, with and without bias, to half a level.
  const Slm slm = make_panel(32, 16, 65536);
  const Field field = sum_of(random_waves(3, 5, 11), slm.grid);
  EncodeParams params{
      .method = Encoding::off_axis, .reference_angle_x = 0.004, .reference_angle_y = -0.011, .device = GetParam()};
  for (ImageSide side : {ImageSide::virtual_image, ImageSide::real_image})
    for (bool bias : {true, false}) {
      params.with_bias = bias;
      params.image = side;
      Heard heard;
      const Hologram h = encode(field, slm, params, heard.observer());
      std::vector<double> irradiance;
      for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 32; ++i) {
          std::complex<double> u(field.samples(j, i));
          if (side == ImageSide::real_image) u = std::conj(u);
          const double k = 2 * pi / test_wavelength;
          const double phase = k * (std::sin(0.004) * slm.grid.x(i) + std::sin(-0.011) * slm.grid.y(j));
          const std::complex<double> r = std::polar(heard.number("modulus_max"), phase);
          irradiance.push_back(bias ? std::norm(u + r) : std::norm(u + r) - std::norm(u) - std::norm(r));
        }
      const double low = bias ? 0 : *std::min_element(irradiance.begin(), irradiance.end());
      const double high = *std::max_element(irradiance.begin(), irradiance.end());
      for (size_t i = 0; i < irradiance.size(); ++i)
        EXPECT_NEAR(h.level.values[i], 65535 * (irradiance[i] - low) / (high - low), half_level(65536));
    }
}

TEST(EncodeReference, StopIsAroundTheOrderThatCarriesTheField) {
  const Grid grid{128, 64, test_pitch};
  const double nyquist = 1 / (2 * test_pitch);
  // With bias: a third of the way to the axis, where |U|² begins. Without: all but one bin (1/width) of the way.
  EXPECT_EQ(off_axis_filter({nyquist / 2, 0}, grid, true), (SpectralFilter{-nyquist / 2, -0.0, nyquist / 6, nyquist}));
  EXPECT_NEAR(off_axis_filter({nyquist / 2, 0}, grid, false).half_u, nyquist / 2 - 1 / grid.width(), 1e-9);
  // Beyond 3/4 of Nyquist, where the twin of the next order is nearer than |U|², and along y.
  EXPECT_NEAR(off_axis_filter({0, -0.9 * nyquist}, grid, true).half_v, 0.1 * nyquist, 1e-9);
  EXPECT_NEAR(off_axis_filter({0, -0.9 * nyquist}, grid, true).v0, 0.9 * nyquist, 1e-9);
  EXPECT_EQ(off_axis_filter({0, -0.9 * nyquist}, grid, true).half_u, nyquist);
}

TEST_P(EncodeOffAxis, WarnsOfAFieldTooWideForItsBand) {
  const Slm slm = make_panel(128, 32, 65536);
  const auto heard_for = [&](int cycles) {
    Heard heard;
    const Field wave = sum_of({{0, 0, 1}, {cycles, 0, 1}}, slm.grid);
    encode(wave, slm, {.method = Encoding::off_axis, .device = GetParam()}, heard.observer());
    return heard;
  };
  // The carrier is at 32 cycles over the panel, so the half width 16.
  EXPECT_NEAR(heard_for(15).number("band_power"), 1, 1e-6);
  EXPECT_EQ(heard_for(15).warnings.size(), 1u);  // the warning about the polariser
  EXPECT_NEAR(heard_for(17).number("band_power"), 0.5, 1e-6);
  const std::vector<std::string> warnings = heard_for(17).warnings;
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[1].find("keeps 50 % of the field's power"), std::string::npos) << warnings[1];
}

TEST_P(Encode, DarkFieldGivesABlankHologramAndAWarning) {
  const Slm slm = make_panel(8, 8);
  for (Encoding method : {Encoding::phase, Encoding::amplitude, Encoding::off_axis, Encoding::binary}) {
    Heard heard;
    const EncodeParams params{.method = method, .device = GetParam()};
    const Hologram h = encode(Field(slm.grid, test_wavelength), slm, params, heard.observer());
    for (uint16_t level : h.level.values) EXPECT_EQ(level, 0);
    EXPECT_NE(heard.warnings.back().find("dark everywhere"), std::string::npos);
  }
}

TEST(EncodeChecks, WarnsOfAnotherPlane) {
  const Slm slm = make_panel(8, 8);
  Field field = sum_of({{1, 0, 1}}, slm.grid);
  field.z = 0.1;
  Heard heard;
  encode(field, slm, {}, heard.observer());
  ASSERT_EQ(heard.warnings.size(), 1u);
  EXPECT_NE(heard.warnings[0].find("the field is in the plane z = 100 mm"), std::string::npos) << heard.warnings[0];
}

TEST(EncodePhase, APanelForALongerWaveKeepsItsEfficiency) {
  // A panel for 633 nm: at 532 and 450 nm a turn has 256·λ/633 = 215.2 and 182.0 levels. Rounding to them costs
  // sinc²(1/levels), up to 1e-4, as for any quantiser; the ramp of 256 pixels per period costs sinc²(1/256) = 1 − 5e-5.
  for (double wavelength : {633e-9, 532e-9, 450e-9}) {
    Slm slm = make_panel(1024, 2);
    slm.design_wavelength = 633e-9;
    Heard heard;
    const Field wave = sum_of({{4, 0, 1}}, slm.grid, wavelength);
    const Hologram h = encode(wave, slm, {}, heard.observer());
    EXPECT_NEAR(efficiency_of(show(h, slm, {.subpixels = 3}), 4), 1, 2.5e-4) << wavelength;
    EXPECT_TRUE(heard.warnings.empty());
    EXPECT_DOUBLE_EQ(heard.number("phase_range"), 2 * pi * 633e-9 / wavelength);
    const double levels = 256 * wavelength / 633e-9;
    EXPECT_LE(*std::max_element(h.level.values.begin(), h.level.values.end()), levels + 0.5);  // in the first turn
  }
}

TEST(EncodePhase, APanelShortOfTwoPiLosesWhatItSays) {
  // 450 nm panel at 532 and 633 nm: η = (r + sin(πr)/π)², r = 450/λ. The last level is one step short of r: 1/256 of a
  // turn in the worst place costs less than 3e-3.
  for (double wavelength : {532e-9, 633e-9}) {
    Slm slm = make_panel(1024, 2);
    slm.design_wavelength = 450e-9;
    Heard heard;
    const Hologram h = encode(sum_of({{4, 0, 1}}, slm.grid, wavelength), slm, {}, heard.observer());
    const double r = 450e-9 / wavelength, expected = std::pow(r + std::sin(pi * r) / pi, 2);
    EXPECT_DOUBLE_EQ(short_range_efficiency(r), expected);
    EXPECT_NEAR(efficiency_of(show(h, slm, {.subpixels = 3}), 4), expected, 3e-3) << wavelength;
    ASSERT_EQ(heard.warnings.size(), 1u);
  }
  Slm slm = make_panel(8, 8);
  slm.design_wavelength = 450e-9;
  Heard heard;
  encode(sum_of({{1, 0, 1}}, slm.grid, 633e-9), slm, {}, heard.observer());
  EXPECT_EQ(
      heard.warnings.at(0),
      "the SLM \"test\" reaches a phase of 1.422π at 633 nm, less than 2π: phases beyond it are set to its nearer end, "
      "and 92.5 % of the light stays in the image; give the panel a design wavelength of 633 nm or more, now it "
      "is 450 nm");
}

TEST(EncodeChecks, ShortPhaseIsToldWithWhatMakesItShort) {
  const auto warning = [](Slm slm, const EncodeParams& params) {
    Heard heard;
    encode(sum_of({{1, 0, 1}}, slm.grid, 633e-9), slm, params, heard.observer());
    const std::string sentence = heard.warnings.at(0);
    return sentence.substr(sentence.rfind(';') + 2);
  };
  Slm slm = make_panel(8, 8);
  slm.phase_range = 1.5 * pi;
  EXPECT_EQ(warning(slm, {}), "its phase_range is 1.5π: set it to 2π if the panel reaches that");
  // 3π at 350 nm is 1.66π at 633 nm, and 2π there from a design wavelength of 422 nm on.
  slm.phase_range = 3 * pi;
  slm.design_wavelength = 350e-9;
  EXPECT_EQ(warning(slm, {}), "give the panel a design wavelength of 422 nm or more, now it is 350 nm");
  slm = make_panel(8, 8, 5);
  slm.effects.calibration = {{0, 1}, {0.3 * pi, 1}, {0.6 * pi, 1}, {0.9 * pi, 1}, {1.2 * pi, 1}};
  // Four steps, plus one to complete the turn: 1.2π·5/4.
  EXPECT_EQ(warning(slm, {.effects = {"calibration"}}),
            "its calibration spans 1.5π, one more step included: use one that reaches 2π");
}

TEST_P(Encode, IlluminationShowsTheFieldAtItsOwnBrightness) {
  // The panel shows the wanted light at scale 1, plus noise. A band of 4 cycles in 64 pixels: the pixels'
  // roll-off sinc(4/64) per axis, 1.3 % at most.
  const Slm slm = make_panel(64, 64, 65536);
  const Field field = sum_of(random_waves(4, 20, 5), slm.grid);
  for (const bool bias : {false, true})
    for (const Encoding method : {Encoding::phase, Encoding::amplitude, Encoding::off_axis}) {
      const Hologram h = encode(field, slm, {.method = method, .with_bias = bias, .device = GetParam()});
      const Field shown = show(h, slm, {.irradiance = h.illumination});
      // Projection of the shown field onto the wanted one: Σ shown·U* / Σ|U|². For amplitude alone |U| is wanted.
      std::complex<double> sum = 0;
      const Vec2 carrier =
          method == Encoding::off_axis ? reference_carrier({.with_bias = bias}, slm.grid, test_wavelength) : Vec2{0, 0};
      double square = 0;
      for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 64; ++i) {
          std::complex<double> wanted(field.samples(j, i));
          if (method == Encoding::amplitude) wanted = std::abs(wanted);
          wanted *= std::polar(1.0, -2 * pi * carrier.x * slm.grid.x(i));
          sum += std::complex<double>(shown.samples(j, i)) * std::conj(wanted);
          square += std::norm(wanted);
        }
      const double part = std::abs(sum / square);
      // The carrier adds its own roll-off: sinc(3/8) with bias, sinc(1/4) without.
      EXPECT_NEAR(part / (method == Encoding::off_axis ? sinc(bias ? 0.375 : 0.25) : 1), 1, 0.03) << int(method);
    }
}

TEST(EncodeChecks, SaysWhatIsWrong) {
  const Slm slm = make_panel(8, 4, 16);
  const Field good = sum_of({{1, 0, 1}}, slm.grid);
  const auto error = [&](const Field& f, const Slm& s, const EncodeParams& p) {
    return error_of([&] { encode(f, s, p); });
  };
  EXPECT_EQ(error(good, slm, {.levels = 1}), "expected 0 or 2 to 65536 for \"levels\", got 1");
  EXPECT_EQ(error(good, slm, {.levels = 17}),
            "expected 2 to 16 levels, as many as the SLM \"test\" has, or 0 for all of them, got 17");
  EXPECT_EQ(error(good, make_panel(8, 4, 65537), {}), "expected 2 to 65536 levels, got 65537");
  EXPECT_EQ(error(good, make_panel(8, 4, 16, 0), {}), "expected a fill factor in (0, 1], got 0");
  EXPECT_EQ(
      error(good, make_panel(8, 5, 16), {}),
      "expected a field of 8 × 5 samples at 8 µm, the pixels of the SLM \"test\", got 8 × 4 at 8 µm; compute it on "
      "the SLM's grid or name the SLM it was computed for");
  Field close = good;
  close.grid.pitch *= 1 + 5e-10;
  EXPECT_EQ(error(close, slm, {}), "no error");  // pitches agree to 1e-9
  close.grid.pitch = test_pitch * (1 + 2e-9);
  EXPECT_NE(error(close, slm, {}), "no error");

  Field bad = good;
  bad.samples(3, 6) = {std::numeric_limits<float>::quiet_NaN(), 1};
  EXPECT_EQ(error(bad, slm, {}), "expected finite samples in the field, got nan+1i at row 3, column 6");
  bad = good;
  bad.wavelength = 0;
  EXPECT_EQ(error(bad, slm, {}), "expected a wavelength above 0 m, got 0 m");

  Slm amplitude = slm;
  amplitude.modulation = Modulation::amplitude;
  EXPECT_EQ(error(good, amplitude, {}),
            "expected an encoding for an amplitude panel, which \"test\" is, got \"phase\"; use \"amplitude\", "
            "\"off-axis\" or \"sgd\"");
  EXPECT_EQ(error(good, slm, {.method = Encoding::off_axis, .reference_ratio = 0}),
            "expected a number above 0 for \"reference_ratio\", got 0");
  // asin(λ/2p) = 1.905° at 532 nm and 8 µm (closed_forms.md 1); 0.05 rad is 2.865°.
  EXPECT_EQ(
      error(good, slm, {.method = Encoding::off_axis, .reference_angle_x = 0.05}),
      "expected an off-axis reference at an angle below 1.905°, the largest that pixels of 8 µm can represent at 532 "
      "nm, got 2.865° in x, 0° in y; use smaller reference angles");
}

}  // namespace
}  // namespace holotrace
