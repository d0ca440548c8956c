#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/shared/sum_by_kind.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/tiles/tile_error.h"
#include "support/devices.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;
using test::relative_error;

// Eq. 5–7 in long double, from the formula alone: without splitting r, and without code of the library.
FieldDouble closed_form(const Sources& sources, const Grid& grid) {
  constexpr long double tau = 2 * std::numbers::pi_v<long double>;
  FieldDouble field(grid, sources.wavelength);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      std::complex<long double> sum = 0;
      for (const Source& s : sources.waves) {
        const long double dx = (i - (grid.nx - 1) / 2.0L) * grid.pitch - s.origin.x;
        const long double dy = ((grid.ny - 1) / 2.0L - j) * grid.pitch - s.origin.y;
        const long double d = std::abs(s.origin.z), r = std::sqrt(dx * dx + dy * dy + d * d);
        const long double sign = s.origin.z < 0 ? 1 : -1;  // waves to points in front of the panel converge
        const long double radius = d * std::tan(std::asin(sources.wavelength / (2 * (long double)grid.pitch)));
        if (std::abs(dx) > radius || std::abs(dy) > radius) continue;
        sum += std::polar(s.amplitude * d / r, sign * std::fmod(r / sources.wavelength, 1.0L) * tau + s.phase);
      }
      field.samples(j, i) = std::complex<double>(sum);
    }
  return field;
}

Sources one_wave(Vec3 origin) { return {green, {{origin, 1.0F, 0.0F}}}; }

double phase_at(const Sources& sources, double x, double y) {
  const PreparedWave wave = prepare_wave(sources.waves[0], {1, 1, 8_um}, sources.wavelength);
  const double phase = std::arg(wave_at(wave, x, y, sources.wavelength));
  return phase < 0 ? phase + 2 * pi : phase;
}

// 300 waves of random phases, every third one to a point in front of the panel. Boxes cut some of them.
Sources waves_on_both_sides(const Grid& grid) {
  Sources sources = make_random_sources(300, grid, green, 5_mm, 60_mm);
  for (size_t i = 0; i < sources.waves.size(); i += 3) sources.waves[i].origin.z *= -1;
  return sources;
}

TEST(BothSides, EveryMethodSumsThemWithinItsTolerance) {
  const Grid grid{96, 80, 8_um};
  const Sources sources = waves_on_both_sides(grid);
  const FieldDouble expected = closed_form(sources, grid);
  EXPECT_LT(relative_error(sum_exact(sources, grid), expected), 1e-7);  // cycles in double, phases in float
  for (const SynthesisMethod method :
       {SynthesisMethod::exact, SynthesisMethod::tiled, SynthesisMethod::planes, SynthesisMethod::automatic}) {
    Heard heard;
    const Field field = synthesize(sources, grid, {.method = method, .tolerance = 1e-3}, heard.observer());
    EXPECT_LT(relative_error(field, expected), 1e-3) << method_name(method);
    EXPECT_EQ(std::get<int64_t>(heard.facts.at("waves")), 300) << "of both sides";
    EXPECT_EQ(std::get<int64_t>(heard.facts.at("waves_pixels")), waves_pixels(sources, grid));
    EXPECT_GT(relative_error(field, closed_form(kinds_of(sources).behind, grid)), 0.1);
  }
}

// Counts add up; a time is predicted only if it is for each kind.
TEST(BothSides, FactsAreThoseOfAllKinds) {
  const Grid grid{4, 4, 8_um};
  const Sources near{green}, far{green};
  for (const bool has_both : {true, false}) {
    Heard heard;
    const auto sum = [&](const Sources& kind, const Observer& observer) {
      observer.fact("triangles", 3);
      observer.fact("method", std::string(&kind == &near ? "double-phase" : "phase"));
      if (has_both || &kind == &near) observer.fact("predicted_seconds", 2.0);
      return Field(grid, green);
    };
    const Field field = sum_kinds<Sources>({{near, false}, {far, true}}, {"lamp", 5, 450_nm}, heard.observer(), sum);
    EXPECT_EQ(field.label, (Label{"lamp", 5, 450_nm}));
    EXPECT_EQ(std::get<int64_t>(heard.facts.at("triangles")), 6);
    EXPECT_EQ(std::get<std::string>(heard.facts.at("method")), "double-phase and phase");
    EXPECT_EQ(heard.facts.count("predicted_seconds"), size_t(has_both));
    if (has_both) {
      EXPECT_EQ(heard.number("predicted_seconds"), 4);
    }
  }
}

// The waves of one side are those of the whole set with the other's amplitudes at 0, tile by tile.
TEST(BothSides, KeepTheirAmplitudesInTiles) {
  const Grid grid{64, 64, 8_um};
  Sources sources = waves_on_both_sides(grid);
  const size_t count = sources.waves.size();
  sources.tiles = {2, 1, std::vector<float>(2 * count)};
  for (size_t i = 0; i < count; ++i) {
    sources.tiles.values[i] = 1;
    sources.tiles.values[count + i] = float(i % 5);
  }
  FieldDouble expected(grid, green);
  for (const int tile : {0, 1}) {
    Sources one = sources;
    one.tiles = {};
    for (size_t i = 0; i < count; ++i) one.waves[i].amplitude = sources.tiles.values[size_t(tile) * count + i];
    const FieldDouble field = closed_form(one, grid);
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 32 * tile; i < 32 * (tile + 1); ++i) expected.samples(j, i) = field.samples(j, i);
  }
  EXPECT_LT(relative_error(sum_exact(sources, grid), expected), 1e-7);
}

// A wave to a point 30 mm in front of the panel has its focus there: the middle of an Airy-like spot of a square panel, whose
// half width λz/w is 21 µm; samples are 8 µm apart.
TEST(BothSides, AWaveToAPointInFrontHasItsFocusThere) {
  const Grid grid{96, 96, 8_um};
  const Field field = synthesize({green, {{{80_um, -40_um, 30_mm}, 1, 0}}}, grid, {});
  const Field there = propagate(field, 30_mm), behind = propagate(field, -30_mm);
  size_t brightest = 0;
  for (size_t i = 0; i < there.samples.size(); ++i)
    if (std::norm(there.samples.values[i]) > std::norm(there.samples.values[brightest])) brightest = i;
  EXPECT_NEAR(grid.x(double(brightest % 96)), 80_um, 4.1_um);
  EXPECT_NEAR(grid.y(double(brightest / 96)), -40_um, 4.1_um);
  // On the other side the light is spread over more than the panel: 1/30 of the focus.
  for (const auto& u : behind.samples.values) EXPECT_LT(std::norm(u), std::norm(there.samples.values[brightest]) / 30);
}

// closed_forms.md section 5, case 1; the digits given there: 1e-7.
TEST(SphericalWave, HasThePhasesOfCase1) {
  EXPECT_NEAR(phase_at(one_wave({0, 0, -0.2_m}), 1_mm, 0.5_mm), 4.5467537, 1e-7);
  EXPECT_NEAR(phase_at(one_wave({0, 0, -0.3_m}), 7.68_mm, 4.32_mm), 6.0954139, 1e-7);
  EXPECT_NEAR(phase_at(one_wave({0, 0, -0.2_m}), 0, 0), 5.3383454, 1e-7);
}

// Case 2: at the n-th zone radius the path is n half waves longer than on the axis.
TEST(SphericalWave, GainsHalfACycleFromZoneToZone) {
  const double z = 0.2_m;
  const double digits[][2] = {{1, 0.326190_mm}, {2, 0.461303_mm}, {10, 1.031507_mm}, {100, 3.262010_mm}};
  for (const auto& [n, given] : digits) {
    const double radius = std::sqrt(n * green * z + n * n * green * green / 4);
    EXPECT_NEAR(radius, given, 0.5e-9);  // half of the last digit given, 1e-6 mm
    // A double keeps (r − d)/λ, at most 50 cycles, to 1e-13.
    EXPECT_NEAR(path_beyond_depth(radius * radius, z) / green, n / 2, 1e-12);
  }
}

TEST(SphericalWave, IsAmplitudeTimesDepthOverDistance) {
  const Sources sources{green, {{{0, 0, -3_mm}, 2.0F, 0.0F}}};
  const PreparedWave wave = prepare_wave(sources.waves[0], {1, 1, 8_um}, green);
  EXPECT_NEAR(std::abs(wave_at(wave, 4_mm, 0, green)), 2.0 * 3 / 5, 1e-15);  // a 3-4-5 triangle
}

// Boxes of closed_forms.md section 1: R in pixels of 8 µm.
TEST(LitBox, HasTheRadiusOfTheGratingEquation) {
  const struct {
    double wavelength, depth;
    int pixels;
  } cases[] = {{532_nm, 0.1_m, 416}, {532_nm, 0.2_m, 832}, {532_nm, 0.3_m, 1248},
               {633_nm, 0.1_m, 495}, {633_nm, 0.2_m, 990}, {633_nm, 0.3_m, 1485}};
  for (const auto& c : cases)
    EXPECT_NEAR(box_radius(c.depth, c.wavelength, 8_um) / 8_um, c.pixels, 0.75) << c.depth;  // given as whole pixels
}

TEST(LitBox, LightsNoPixelOutsideAndAllInside) {
  const Grid grid{801, 600, 8_um};
  const Source source{{1.1_mm, -0.7_mm, -50_mm}, 1, 0};
  const double radius = box_radius(50_mm, green, 8_um);
  const PixelBox box = lit_box(source, grid, acceptance_tangent(green, grid.pitch));
  for (int i = 0; i < grid.nx; ++i)
    EXPECT_EQ(std::abs(grid.x(i) - source.origin.x) <= radius, i >= box.x0 && i < box.x1) << i;
  for (int j = 0; j < grid.ny; ++j)
    EXPECT_EQ(std::abs(grid.y(j) - source.origin.y) <= radius, j >= box.y0 && j < box.y1) << j;
}

struct Panel {
  int nx, ny;
};
class SumOnPanel : public ::testing::TestWithParam<Panel> {};

// Sums on the processor, and on every OpenCL device of this machine.
class Synthesis : public ::testing::TestWithParam<DeviceChoice> {
 protected:
  static Field sum(const Sources& sources, const Grid& grid, double tolerance,
                   SynthesisMethod method = SynthesisMethod::automatic) {
    SynthesizeParams params{method, tolerance};
    params.device = GetParam();
    return synthesize(sources, grid, params);
  }
};

INSTANTIATE_TEST_SUITE_P(On, Synthesis, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);

class SynthesisOnPanel : public ::testing::TestWithParam<std::tuple<Panel, DeviceChoice>> {};

// Square and not, odd and even. A double holds kr of 2e6 rad to 2e-10; splitting off d₀/λ improves it to 1e-11.
TEST_P(SumOnPanel, ExactIsTheClosedForm) {
  const Grid grid{GetParam().nx, GetParam().ny, 8_um};
  for (const int count : {1, 25}) {
    const Sources sources = make_random_sources(count, grid, green, 0.1_m, 0.3_m, 0.5);
    EXPECT_LT(relative_error(sum_exact(sources, grid), closed_form(sources, grid)), 1e-10) << count;
  }
}

// The tolerance holds over its whole range, near and far.
TEST_P(SynthesisOnPanel, IsWithinItsTolerance) {
  const auto& [panel, device] = GetParam();
  const Grid grid{panel.nx, panel.ny, 8_um};
  for (const double depth : {0.02_m, 0.2_m, 2.0_m})
    for (const int count : {1, 40}) {
      const Sources sources = make_random_sources(count, grid, green, depth, 1.1 * depth, 0.3);
      const FieldDouble exact = sum_exact(sources, grid);
      for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
        SynthesizeParams params{SynthesisMethod::automatic, tolerance};
        params.device = device;
        const Field field = synthesize(sources, grid, params);
        EXPECT_LT(relative_error(field, exact), tolerance) << depth << " m, " << count << " waves, " << tolerance;
      }
    }
}

constexpr std::array panels{Panel{128, 128}, Panel{201, 131}, Panel{97, 97}, Panel{300, 64}, Panel{65, 222}};

std::string size_name(const Panel& panel) { return fmt::format("{}x{}", panel.nx, panel.ny); }

INSTANTIATE_TEST_SUITE_P(Shapes, SumOnPanel, ::testing::ValuesIn(panels),
                         [](const auto& info) { return size_name(info.param); });
std::string panel_and_device(const ::testing::TestParamInfo<std::tuple<Panel, DeviceChoice>>& info) {
  return size_name(std::get<0>(info.param)) + "_" + test::device_name(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Shapes, SynthesisOnPanel,
                         ::testing::Combine(::testing::ValuesIn(panels),
                                            ::testing::ValuesIn(test::processor_and_devices())),
                         panel_and_device);

TEST_P(Synthesis, Reaches1e4AtTheUsualDepth) {
  const Grid grid{700, 500, 8_um};
  const Sources sources = make_random_sources(60, grid, green, 0.19_m, 0.21_m, 0.3);
  EXPECT_LT(relative_error(sum(sources, grid, 1e-4, SynthesisMethod::tiled), sum_exact(sources, grid)), 1e-4);
}

TEST(SumTiled, StatesAnErrorNearTheOneItMakes) {
  const Grid grid{700, 500, 8_um};
  const Sources sources = make_random_sources(60, grid, green, 0.05_m, 0.06_m, 0.3);
  const auto waves = prepare_waves(sources, grid);
  const TileChoice choice = choose_tile(waves, grid, green, 3e-3);
  ASSERT_TRUE(choice.meets_tolerance);
  const double made = relative_error(sum_tiled(sources, grid, 3e-3), sum_exact(sources, grid));
  EXPECT_LT(made, 1.25 * choice.error);  // the margin that choose_tile keeps
  EXPECT_GT(made, choice.error / 2);     // the estimate is not far too large either
}

// One bright near wave among many faint far ones: draws by energy find it.
TEST_P(Synthesis, KeepsItsToleranceForOneNearWaveAmongMany) {
  const Grid grid{256, 192, 8_um};
  Sources sources = make_random_sources(20000, grid, green, 0.5_m, 0.5_m);
  for (Source& s : sources.waves) s.amplitude *= 1e-4F;
  sources.waves.push_back({{0.1_mm, 0.05_mm, -20_mm}, 10, 0});
  // At 3000 pixels, which give the error of all within 2 %: the exact sum of all takes a minute.
  EXPECT_LT(sampled_error(sum(sources, grid, 1e-3), sources, 3000), 1e-3);
}

// Waves that cancel leave a field that is small compared with their errors.
TEST_P(Synthesis, KeepsItsToleranceForWavesThatCancel) {
  const Grid grid{512, 384, 8_um};
  const Sources sources{green,
                        {{{1_mm, 0.5_mm, -0.2_m}, 1, 0},
                         {{1_mm, 0.5_mm, -0.2_m - 1_um}, 1, float(pi - 2 * pi * std::fmod(1_um / green, 1.0))}}};
  const FieldDouble exact = sum_exact(sources, grid);
  const FieldDouble one = sum_exact({green, {sources.waves[0]}}, grid);
  ASSERT_LT(power(exact), 0.01 * power(one));  // they do cancel
  EXPECT_LT(relative_error(sum(sources, grid, 1e-3), exact), 1e-3);
}

TEST_P(Synthesis, RefusesAToleranceThatFloatsCannotHold) {
  const Grid grid{64, 64, 8_um};
  try {
    sum(make_random_sources(3, grid, green, 0.2_m, 0.2_m), grid, 1e-7, SynthesisMethod::tiled);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("use the method exact"), std::string::npos) << error.what();
  }
}

TEST_P(Synthesis, FallsBackToExactWhereTilesAreTooCoarse) {
  const Grid grid{64, 64, 8_um};
  const Sources sources = make_random_sources(3, grid, green, 0.2_m, 0.2_m);
  std::string method;
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& value) {
    if (name == "method") method = std::get<std::string>(value);
  };
  SynthesizeParams params{SynthesisMethod::automatic, 1e-6};
  params.device = GetParam();
  const Field field = synthesize(sources, grid, params, observer);
  EXPECT_EQ(method, "exact");
  EXPECT_LT(relative_error(field, sum_exact(sources, grid)), 1e-6);  // rounding of a float, 6e-8, with a margin
}

TEST(Synthesize, IsLinearInTheAmplitudes) {
  const Grid grid{200, 120, 8_um};
  Sources a = make_random_sources(20, grid, green, 0.2_m, 0.22_m);
  Sources both = a;
  for (Source& s : a.waves) {
    s.amplitude *= 2;
    both.waves.push_back(s);
  }
  const FieldDouble once = sum_exact(a, grid), thrice = sum_exact(both, grid);
  for (size_t i = 0; i < once.samples.size(); ++i)
    EXPECT_LT(std::abs(thrice.samples.values[i] - 1.5 * once.samples.values[i]), 1e-12);
}

TEST(Synthesize, GivesTheSameBytesOnAnyNumberOfThreads) {
  const Grid grid{333, 217, 8_um};
  const Sources sources = make_random_sources(500, grid, green, 0.1_m, 0.2_m);
  std::vector<Field> fields;
  std::vector<FieldDouble> exact;
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    fields.push_back(sum_tiled(sources, grid, 1e-3));
    exact.push_back(sum_exact(sources, grid));
  }
  EXPECT_EQ(fields[0].samples.values, fields[1].samples.values);
  EXPECT_EQ(fields[0].samples.values, fields[2].samples.values);
  EXPECT_EQ(exact[0].samples.values, exact[2].samples.values);
}

TEST(Synthesize, WarnsOfWavesThatMissThePanel) {
  const Grid grid{64, 64, 8_um};
  Sources sources = one_wave({0, 0, -0.2_m});
  sources.waves.push_back({{0.1_m, 0, -0.2_m}, 1, 0});  // 100 mm off the axis; R is 6.7 mm
  std::string warning;
  Observer observer;
  observer.on_warning = [&](const std::string& text) { warning = text; };
  synthesize(sources, grid, {}, observer);
  EXPECT_EQ(warning.rfind("1 of 2 waves light no pixel", 0), 0U) << warning;
}

// --- a separate amplitude in each tile of the panel ----------------------------------------------

Sources with_tiles(Sources sources, int columns, int rows) {
  sources.tiles = {columns, rows, {}};
  for (int t = 0; t < columns * rows; ++t)
    for (const Source& s : sources.waves) sources.tiles.values.push_back(s.amplitude);
  return sources;
}

// 200 × 131 pixels in 3 × 2 tiles: tiles of unequal size, none a multiple of the sum's own tiles.
TEST_P(Synthesis, OfEqualTileAmplitudesIsThePlainSum) {
  const Grid grid{200, 131, 8_um};
  const Sources plain = make_random_sources(40, grid, green, 0.1_m, 0.2_m, 0.3), tiled = with_tiles(plain, 3, 2);
  // The same terms, added in the same order: equal to the last bit.
  EXPECT_EQ(sum_exact(plain, grid).samples.values, sum_exact(tiled, grid).samples.values);
  // Single precision, and splits in other tiles: each is within its tolerance of the exact sum.
  EXPECT_LT(relative_error(sum(tiled, grid, 1e-4, SynthesisMethod::tiled), sum_exact(plain, grid)), 1e-4);
  EXPECT_EQ(waves_pixels(plain, grid), waves_pixels(tiled, grid));
}

TEST_P(Synthesis, TakesTheAmplitudesOfTilesAtTheirPixels) {
  const Grid grid{200, 131, 8_um};
  const Sources plain = make_random_sources(40, grid, green, 0.1_m, 0.2_m, 0.3);
  Sources tiled = with_tiles(plain, 4, 3);
  for (size_t i = 0; i < tiled.tiles.values.size(); ++i) tiled.tiles.values[i] *= float(i % 7) / 3;
  // Expected: in every tile, the plain sum of waves with that tile's amplitudes.
  FieldDouble expected(grid, green);
  for (int t = 0; t < 12; ++t) {
    Sources one = plain;
    for (size_t j = 0; j < one.waves.size(); ++j) one.waves[j].amplitude = tiled.tiles.values[t * 40 + j];
    const FieldDouble field = sum_exact(one, grid);
    for (int j = t / 4 * 131 / 3; j < (t / 4 + 1) * 131 / 3; ++j)
      for (int i = t % 4 * 50; i < (t % 4 + 1) * 50; ++i) expected.samples(j, i) = field.samples(j, i);
  }
  EXPECT_LT(relative_error(sum_exact(tiled, grid), expected), 1e-14);  // the same terms without those of amplitude 0
  for (const SynthesisMethod method : {SynthesisMethod::automatic, SynthesisMethod::tiled})
    EXPECT_LT(relative_error(sum(tiled, grid, 1e-3, method), expected), 1e-3);
}

TEST_P(Synthesis, OfMoreTilesThanPixelsAndOfDarkTilesIsNoTrouble) {
  const Grid grid{6, 5, 8_um};
  const Sources plain = make_random_sources(5, grid, green, 0.1_m, 0.2_m);
  EXPECT_LT(relative_error(sum_exact(with_tiles(plain, 9, 7), grid), sum_exact(plain, grid)), 1e-14);
  Sources dark = with_tiles(plain, 2, 2);
  for (float& a : dark.tiles.values) a = 0;
  EXPECT_LT(relative_error(sum(with_tiles(plain, 9, 7), grid, 1e-3), sum_exact(plain, grid)), 1e-3);
  for (const auto& u : sum(dark, grid, 1e-3).samples.values) EXPECT_EQ(u, std::complex<float>(0));
}

TEST(TileAmplitudes, GiveTheSameBytesOnAnyNumberOfThreads) {
  const Grid grid{333, 217, 8_um};
  const Sources sources = with_tiles(make_random_sources(100, grid, green, 0.1_m, 0.2_m), 3, 3);
  std::vector<Field> fields;
  for (const size_t threads : {1, 5}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    fields.push_back(sum_tiled(sources, grid, 1e-3));
  }
  EXPECT_EQ(fields[0].samples.values, fields[1].samples.values);
}

void expect_error(const Sources& sources, const Grid& grid, const std::string& start, SynthesizeParams params = {}) {
  try {
    synthesize(sources, grid, params);
    FAIL() << "no error: " << start;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).rfind(start, 0), 0U) << error.what();
  }
}

TEST(Synthesize, RefusesMethodsOfTheProcessorOnADevice) {
  const Grid grid{8, 8, 8_um};
  SynthesizeParams params{SynthesisMethod::exact};
  params.device.kind = DeviceKind::opencl;
  expect_error(one_wave({0, 0, -0.1_m}), grid,
               "expected the method auto, tiled or planes on an OpenCL device, got exact", params);
}

TEST(Synthesize, RefusesWhatIsNoScene) {
  const Grid grid{8, 8, 8_um};
  expect_error(one_wave({0, 0, 0}), grid, "expected source 0 behind the panel");
  expect_error(one_wave({NAN, 0, -0.1_m}), grid, "expected finite numbers in source 0");
  expect_error(one_wave({0, 0, -INFINITY}), grid, "expected finite numbers in source 0");
  expect_error({green, {}}, grid, "expected at least one source, got none");
  expect_error(one_wave({0, 0, -0.1_m}), {0, 8, 8_um}, "expected a grid of at least 1 × 1 pixels, got 0 × 8");
  expect_error(one_wave({0, 0, -0.1_m}), {8, 8, -8_um}, "expected a pixel pitch above 0 m");
  expect_error(one_wave({0, 0, -0.1_m}), grid, "expected a number above 0 and below 1 for \"tolerance\", got 0",
               {SynthesisMethod::tiled, 0});
  Sources tiled = with_tiles(one_wave({0, 0, -0.1_m}), 2, 3);
  tiled.tiles.values.pop_back();
  expect_error(tiled, grid, "expected 6 amplitudes for 2 × 3 tiles and 1 waves, got 5");
  tiled.tiles.values.push_back(NAN);
  expect_error(tiled, grid, "expected finite amplitudes of tiles, got nan for source 0 in tile 5");
  expect_error(one_wave({0, 0, -0.1_m}), {2000000, 2000000, 8_um},
               "expected a field of 2000000 × 2000000 samples to fit in memory");
}

}  // namespace
}  // namespace holotrace
