#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <mutex>

#include "holotrace/base/random.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const Grid traced_panel{256, 192, 8e-6};

TEST(Trace, RasterOfFirstHitsBringsThePanelsCentreItsIrradiance) {
  // ∫∫ cos⁴ dt over the square of tangents: the cosine-weighted solid angle of a parallel square, π times the
  // view factor of four corner rectangles.
  TraceParams params{.columns = 64, .rows = 48, .paths = 1, .max_depth = 1};
  for (double field_of_view : {0.0, 0.5}) {
    params.field_of_view = field_of_view;
    const Scene scene = make_bright_wall(-0.05);
    const Sources sources = trace(scene, traced_panel, green_light, params);
    ASSERT_EQ(sources.waves.size(), 64u * 48u);
    double irradiance = 0;
    for (const Source& wave : sources.waves) {
      const double ratio = -wave.origin.z / length(wave.origin);
      irradiance += double(wave.amplitude) * wave.amplitude * ratio * ratio;
    }
    const double t = field_of_view > 0 ? std::tan(field_of_view) : acceptance_tangent(green_light, traced_panel.pitch);
    const double s = std::sqrt(1 + t * t), expected = 4 * t / s * std::atan(t / s);
    // The midpoint rule has an error of (2T/48)²/24·|∂²cos⁴| ≤ 4/24·(2T/48)², relative: 1e-4 at T = 0.55, less at 0.03.
    EXPECT_NEAR(irradiance / expected, 1, 1e-4);
  }
}

TEST(Trace, RasterStartsAtTheTopLeftAndGoesThroughTheCellCentres) {
  const TraceParams params{.columns = 4, .rows = 2, .paths = 1, .max_depth = 1};
  const Sources sources = trace(make_bright_wall(), traced_panel, green_light, params);
  const double t = acceptance_tangent(green_light, traced_panel.pitch);
  ASSERT_EQ(sources.waves.size(), 8u);
  const Vec3 first = sources.waves[0].origin, second = sources.waves[1].origin, last = sources.waves[7].origin;
  // The tangents −3/4, 1/2 and so on, to double rounding.
  EXPECT_NEAR(first.x, -0.75 * t * 0.3, 1e-15);
  EXPECT_NEAR(first.y, 0.5 * t * 0.3, 1e-15);
  EXPECT_NEAR(second.x, -0.25 * t * 0.3, 1e-15);
  EXPECT_NEAR(last.x, 0.75 * t * 0.3, 1e-15);
  EXPECT_NEAR(last.y, -0.5 * t * 0.3, 1e-15);
}

TEST(Trace, RandomFirstHitsBringThePanelItsEtendueTimesRadiance) {
  const Grid small{64, 48, 8e-6};
  const TraceParams params{.pattern = Pattern::random, .samples = 4000, .paths = 1, .max_depth = 1};
  const Sources sources = trace(make_bright_wall(-0.02), small, green_light, params);
  const double s = acceptance_sine(green_light, small.pitch);
  // L·G/A, less the part s²/3 of G beyond the boxes. A box edge between pixels is wrong by up to half a pixel: the
  // standard deviation of a wave's pixel sum is about 1/√6 of a column in 64 of them, and 4000 waves average that to
  // 1e-4. The stratified count of left-out rays adds less than √(4000·s²/3)/4000 = 3e-4. Four times both: 1.3e-3.
  EXPECT_NEAR(mean_intensity(sources, small) / (4 * s * s * (1 - s * s / 3)), 1, 1.3e-3);
}

TEST(Trace, RandomFirstHitsKeepTheEtendueOfTheUnitDiscOnPanelsOfHalfAWavelength) {
  // Pitch λ/4: all directions are accepted, boxes are unlimited and G = A·π.
  const Grid fine{40, 40, green_light / 4};
  const TraceParams params{.pattern = Pattern::random, .samples = 20000, .paths = 1, .max_depth = 1};
  Scene scene = make_bright_wall(-1_mm);
  scene.meshes = {make_wall(-1_mm, 10.0, 10.0)};
  const Sources sources = trace(scene, fine, green_light, params);
  // The disc is π/4 of the sampled square: binomial, 4 standard errors (strata make it less).
  const double share = pi / 4, error = 4 * std::sqrt(share * (1 - share) / 20000) / share;
  EXPECT_NEAR(mean_intensity(sources, fine) / pi, 1, error);
}

TEST(Trace, RandomFirstHitsGiveTheSameLightAtAnyDepth) {
  const Grid small{64, 48, 8e-6};
  const TraceParams params{.pattern = Pattern::random, .samples = 2000, .paths = 1, .max_depth = 1};
  const double near = mean_intensity(trace(make_bright_wall(-5_mm), small, green_light, params), small);
  const double far = mean_intensity(trace(make_bright_wall(-0.5), small, green_light, params), small);
  // At 5 mm a box is 42 pixels wide: pixel rounding 1/(42·√6)·√(2/2000) = 3e-4, times 4.
  EXPECT_NEAR(near / far, 1, 1.2e-3);
}

TEST(Trace, LinearAmplitudeIsProportionalToRadianceAndSqrtToItsRoot) {
  TraceParams params{.columns = 1, .rows = 1, .paths = 1, .max_depth = 1};
  const auto amplitude = [&](double radiance, AmplitudeLaw law) {
    Scene scene = make_bright_wall();
    scene.materials = {grey(0, radiance)};
    params.amplitude = law;
    return double(trace(scene, traced_panel, green_light, params).waves.at(0).amplitude);
  };
  // Amplitudes are floats: 1e-6 is ten of their roundings.
  EXPECT_NEAR(amplitude(4, AmplitudeLaw::sqrt) / amplitude(1, AmplitudeLaw::sqrt), 2, 1e-6);
  EXPECT_NEAR(amplitude(4, AmplitudeLaw::linear) / amplitude(1, AmplitudeLaw::linear), 4, 1e-6);
  EXPECT_NEAR(amplitude(1, AmplitudeLaw::linear) / amplitude(1, AmplitudeLaw::sqrt), 1, 1e-6);
}

TEST(Trace, EachWavelengthSeesItsChannels) {
  EXPECT_EQ(channel_weights(400e-9), (Vec3{0, 0, 1}));
  EXPECT_EQ(channel_weights(460e-9), (Vec3{0, 0, 1}));
  EXPECT_EQ(channel_weights(532e-9), (Vec3{0, 1, 0}));
  EXPECT_EQ(channel_weights(632.8e-9), (Vec3{1, 0, 0}));
  EXPECT_NEAR(radiance_at(496e-9, {100, 2, 4}), 3, 1e-12);   // half way from blue to green
  EXPECT_NEAR(radiance_at(581e-9, {10, 2, 100}), 6, 1e-12);  // half way from green to red
}

TEST(Trace, AMeshHidesThePointsBehindItAsInTheRender) {
  Scene scene;
  scene.materials = {grey(0)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.points = {{{0, 0, -0.31}, 1.0f, 0}, {{0, 0, -0.29}, 2.0f, 0}, {{50_mm, 0, -0.31}, 3.0f, 0}};
  const Sources sources = trace(scene, traced_panel, green_light, {.columns = 4, .rows = 4, .paths = 1});
  ASSERT_EQ(sources.waves.size(), 2u);  // the wall is black; the first point is behind it
  EXPECT_FLOAT_EQ(sources.waves[1].amplitude / sources.waves[0].amplitude, 1.5f);
}

TEST(Trace, DarkHitsAndMissesMakeNoWave) {
  Scene scene;
  scene.materials = {grey(0, 1), grey(0)};
  scene.meshes = {make_test_quad({-2.5_mm, 0, -0.3}, {2.5_mm, 0, 0}, {0, 5_mm, 0}, 0),
                  make_test_quad({2.5_mm, 0, -0.3}, {2.5_mm, 0, 0}, {0, 5_mm, 0}, 1)};
  Record record;
  const TraceParams params{.columns = 40, .rows = 40, .paths = 2, .max_depth = 2};
  const Sources sources = trace(scene, traced_panel, green_light, params, record.observer);
  for (const Source& wave : sources.waves) {
    EXPECT_LT(wave.origin.x, 0);
    EXPECT_GT(wave.amplitude, 0);
  }
  EXPECT_EQ(record.count("waves"), int64_t(sources.waves.size()));
  EXPECT_EQ(record.count("first_hits"), 2 * record.count("waves"));
  EXPECT_LT(record.count("first_hits"), 1600) << "some rays pass the walls";
  EXPECT_EQ(record.count("paths"), 2 * record.count("first_hits"));
  EXPECT_EQ(record.number("mean_path_length"), 1) << "black surfaces end every path";
  EXPECT_EQ(record.count("rays"), 1600);
  EXPECT_TRUE(record.warnings.empty());
}

TEST(Trace, AdviceOnAnUnseenSceneFitsThePattern) {
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_test_quad({0.2, 0, -0.3}, {5_mm, 0, 0}, {0, 5_mm, 0})};
  const auto warning = [&](const TraceParams& params) {
    Record record;
    trace(scene, traced_panel, green_light, params, record.observer);
    EXPECT_EQ(record.warnings.size(), 1u);
    return record.warnings.empty() ? "" : record.warnings[0];
  };
  // field_of_view widens the raster; random rays keep to the panel's acceptance.
  EXPECT_EQ(
      warning({.pattern = Pattern::random, .samples = 64, .paths = 1}),
      "none of 64 rays from the panel met a mesh: a panel of pitch 8 µm sees only 1.905° to each side of the axis at "
      "532 nm; move the scene onto the axis or take a panel of finer pitch");
  EXPECT_EQ(warning({.columns = 8, .rows = 8, .field_of_view = 10_deg, .paths = 1}),
            "none of 64 rays from the panel met a mesh: the raster sees 10° to each side of the axis; move the "
            "scene onto the axis or widen field_of_view");
}

TEST(Trace, ScenesUnseenOrDarkAreWarnedOf) {
  const TraceParams params{.columns = 8, .rows = 8, .paths = 1};
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_test_quad({0.2, 0, -0.3}, {5_mm, 0, 0}, {0, 5_mm, 0})};
  Record unseen;
  EXPECT_TRUE(trace(scene, traced_panel, green_light, params, unseen.observer).waves.empty());
  ASSERT_EQ(unseen.warnings.size(), 1u);
  EXPECT_EQ(
      unseen.warnings[0],
      "none of 64 rays from the panel met a mesh: a panel of pitch 8 µm sees only 1.905° to each side of the axis at "
      "532 nm; move the scene onto the axis or set field_of_view");

  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  Record dark;
  EXPECT_TRUE(trace(scene, traced_panel, green_light, params, dark.observer).waves.empty());
  ASSERT_EQ(dark.warnings.size(), 1u);
  EXPECT_EQ(dark.warnings[0], "every first hit is dark; add lights, emission or a background to the scene");

  scene.lights = {PointLight{{0, 0, -0.4}, {1, 1, 1}}};
  Record behind;
  trace(scene, traced_panel, green_light, params, behind.observer);
  ASSERT_EQ(behind.warnings.size(), 1u);
  EXPECT_EQ(behind.warnings[0],
            "every first hit is dark: the scene's lights do not reach the surfaces that the panel sees; move "
            "them, or add others, emission or a background");

  scene.materials.push_back(DielectricMaterial{});
  scene.meshes.push_back(make_wall(-0.2, 50_mm, 50_mm, 1));
  scene.lights = {PointLight{{0, 0, -0.1}, {1, 1, 1}}};
  Record behind_glass;
  trace(scene, traced_panel, green_light, params, behind_glass.observer);
  EXPECT_TRUE(behind_glass.warnings.empty());  // glass bends the light, but lets it through

  const auto bumps = std::make_shared<Image>(1, 1, 3);
  bumps->values = {0.5f, 0.5f, 1};
  scene.materials[1].normal_map = bumps;
  Record bumpy_glass;
  trace(scene, traced_panel, green_light, params, bumpy_glass.observer);
  ASSERT_FALSE(bumpy_glass.warnings.empty());
  EXPECT_EQ(bumpy_glass.warnings[0],
            "caustics of point, spot and directional lights through mirrors or glass with a normal map or an opacity "
            "below 1 are left out; use rectangle lights, or remove the map");
}

// A point of radiance L is a patch of λd/W by λd/H: its solid angle is λ²/(W·H) at any depth.
TEST(Trace, LuminousPointsBecomeSourcesOfTheirRadiance) {
  Scene scene = make_bright_wall();
  scene.points = {{{1_mm, 2_mm, -0.25}, 0.5f, 0.25f}, {{0, 0, -0.2}, 2.0f, 0}};
  TraceParams params{.columns = 3, .rows = 3, .paths = 1, .phase = SourcePhase::constant};
  Sources sources = trace(scene, traced_panel, green_light, params);
  ASSERT_EQ(sources.waves.size(), 2u + 9u);
  EXPECT_EQ(sources.wavelength, green_light);
  const double solid_angle =
      green_light * green_light / (traced_panel.nx * traced_panel.pitch * traced_panel.ny * traced_panel.pitch);
  EXPECT_EQ(sources.waves[0].origin, (Vec3{1_mm, 2_mm, -0.25}));
  EXPECT_EQ(sources.waves[0].phase, 0.25f);
  EXPECT_FLOAT_EQ(sources.waves[0].amplitude, float(0.5 * std::sqrt(solid_angle)));
  EXPECT_EQ(sources.waves[1].origin, (Vec3{0, 0, -0.2}));
  EXPECT_FLOAT_EQ(sources.waves[1].amplitude, float(2 * std::sqrt(solid_angle)));
  EXPECT_EQ(sources.waves[2].phase, 0);

  params.phase = SourcePhase::random;
  sources = trace(scene, traced_panel, green_light, params);
  CounterRandom first(1, 0, 0);
  EXPECT_EQ(sources.waves[0].phase, float(2 * pi * first.uniform() + 0.25));
}

TEST(Trace, LuminousPointsOfOneCellAreNotInStep) {
  // With equal phases, n points would bring n² times the light of one; with independent phases they bring n times.
  Scene scene;
  for (int i = 0; i < 4; ++i) scene.points.push_back({{i * 1e-6, 0, -0.2}, 1, 0});
  for (const SourcePhase phase : {SourcePhase::surface, SourcePhase::path, SourcePhase::laser}) {
    const Sources sources = trace(scene, traced_panel, green_light, {.phase = phase, .grain = 100e-6});
    ASSERT_EQ(sources.waves.size(), 4U);
    EXPECT_EQ(std::set<uint64_t>(sources.phase_keys.begin(), sources.phase_keys.end()).size(), 4U);
  }
}

TEST(Trace, LuminousPointsAreWhite) {
  // |U|² of a point relative to a white surface is the same at every wavelength (|U|² = L·λ²/WH if the panel is
  // smaller than the box): amplitudes are proportional to the wavelength.
  Scene scene;
  scene.points = {{{0, 0, -0.2}, 1, 0}};
  const std::vector<Sources> sets = trace(scene, traced_panel, std::vector<double>{630e-9, 450e-9}, {});
  EXPECT_FLOAT_EQ(sets[0].waves[0].amplitude / sets[1].waves[0].amplitude, 630.0F / 450.0F);
}

// A wall of radiance 1 and points of radiance a²: no warning from 1/1000 to 1000.
TEST(Trace, PointsAndSurfacesThatOutshineEachOtherAreWarnedOf) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  const auto warnings = [&](float amplitude, Strategy strategy) {
    scene.points = {{{0, 0, -0.2}, amplitude, 0}};
    Record record;
    const TraceParams params{.strategy = strategy, .columns = 8, .rows = 8, .paths = 1};
    trace(scene, traced_panel, green_light, params, record.observer);
    return record.warnings;
  };
  for (const Strategy strategy : {Strategy::shared, Strategy::tiled}) {
    EXPECT_TRUE(warnings(0.04F, strategy).empty());  // 1/625
    EXPECT_TRUE(warnings(30, strategy).empty());     // 900
    ASSERT_EQ(warnings(0.02F, strategy).size(), 1u);
    EXPECT_EQ(warnings(0.02F, strategy)[0],
              "the surfaces are 2.5e+03 times as bright as the luminous points (mean radiance 1 and 0.0004 W/m²/sr), "
              "so the points cannot be seen; multiply their amplitude by about 50 (its square is their radiance)");
    ASSERT_EQ(warnings(40, strategy).size(), 1u);
    EXPECT_EQ(
        warnings(40, strategy)[0],
        "the luminous points are 1.6e+03 times as bright as the surfaces (mean radiance 1.6e+03 and 1 W/m²/sr), "
        "so the surfaces appear black; multiply the points' amplitude by about 0.025 (its square is their radiance)");
  }
}

TEST(Trace, TheSameSourcesComeFromAnyNumberOfThreads) {
  for (Pattern pattern : {Pattern::grid, Pattern::random}) {
    const TraceParams params{.pattern = pattern, .columns = 48, .rows = 48, .samples = 2000, .paths = 4};
    std::vector<Sources> results;
    for (size_t threads : {1, 2, 7}) {
      tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      results.push_back(trace(make_corner(), traced_panel, green_light, params));
    }
    EXPECT_GT(results[0].waves.size(), 500u);
    EXPECT_EQ(results[0].waves, results[1].waves);
    EXPECT_EQ(results[0].waves, results[2].waves);
  }
}

TEST(Trace, SeedsDrawOtherPhasesAndTheSameSeedTheSame) {
  TraceParams params{.columns = 16, .rows = 16, .paths = 1, .max_depth = 1};
  const Sources first = trace(make_bright_wall(), traced_panel, green_light, params);
  EXPECT_EQ(first.waves, trace(make_bright_wall(), traced_panel, green_light, params).waves);
  params.seed = 2;
  const Sources second = trace(make_bright_wall(), traced_panel, green_light, params);
  Statistics cosine;
  for (size_t i = 0; i < first.waves.size(); ++i) {
    EXPECT_EQ(first.waves[i].origin, second.waves[i].origin);
    EXPECT_NE(first.waves[i].phase, second.waves[i].phase);
    EXPECT_GE(first.waves[i].phase, 0);
    EXPECT_LE(first.waves[i].phase, float(2 * pi));
    cosine.add(std::cos(first.waves[i].phase));
  }
  EXPECT_NEAR(cosine.mean(), 0, 4 * std::sqrt(0.5 / 256));  // uniform phases: mean of cos 0, variance 1/2
}

TEST(Trace, MoreRaysLeaveTheRandomPatternsMeanAsItIs) {
  // The light on the panel from a lit corner is a property of the scene: 4 standard errors between two sample counts.
  TraceParams params{.pattern = Pattern::random, .samples = 1000, .paths = 4};
  const Grid small{64, 48, 8e-6};
  Statistics few, many;
  for (int64_t seed = 1; seed <= 12; ++seed) {
    params.seed = seed;
    params.samples = 500;
    few.add(mean_intensity(trace(make_corner(), small, green_light, params), small));
    params.samples = 1500;
    many.add(mean_intensity(trace(make_corner(), small, green_light, params), small));
  }
  EXPECT_NEAR(few.mean(), many.mean(), 4 * std::hypot(few.standard_error(), many.standard_error()));
}

TEST(Trace, PathsCutByMaxDepthAreWarnedOf) {
  const TraceParams params{.columns = 8, .rows = 8, .paths = 16, .max_depth = 1};
  Record open, record;
  trace(make_bright_wall(), traced_panel, green_light, params, open.observer);
  EXPECT_TRUE(open.warnings.empty()) << "beyond a wall alone there is nothing to miss";
  trace(make_corner(), traced_panel, green_light, params, record.observer);
  ASSERT_EQ(record.warnings.size(), 1u);
  EXPECT_NE(record.warnings[0].find("% of the light paths were cut after 1 surfaces"), std::string::npos);
}

TEST(Trace, ParametersOutOfRangeAreErrorsThatSayWhatWasExpected) {
  const auto sentence = [](const TraceParams& params, double pitch = 8e-6, double wavelength = green_light) {
    return error_of([&] { trace(make_bright_wall(), {16, 16, pitch}, wavelength, params); });
  };
  EXPECT_EQ(sentence({.paths = 0}), "expected a whole number of 1 or more for \"paths\", got 0");
  EXPECT_EQ(sentence({.max_depth = 0}), "expected a whole number of 1 or more for \"max_depth\", got 0");
  EXPECT_EQ(sentence({.columns = -1}), "expected a whole number of 0 or more for \"columns\", got -1");
  EXPECT_EQ(sentence({.pattern = Pattern::random, .samples = 0}),
            "expected a whole number from 1 to 1099511627776 for \"samples\", got 0");
  EXPECT_EQ(sentence({.field_of_view = 90_deg}),
            "expected an angle from 0 deg to less than 90 deg for \"field_of_view\", got 90 deg");
  EXPECT_EQ(
      sentence({}, 266_nm),
      "expected a field_of_view for a panel of pitch 266 nm at 532 nm: it accepts light from all sides, so set the "
      "half angle of the view");
  EXPECT_EQ(sentence({.field_of_view = 30_deg, .paths = 1}, 266_nm), "no error");
  EXPECT_EQ(sentence({}, -1), "expected a pixel pitch above 0 m, got -1 m");
  EXPECT_EQ(sentence({}, 8e-6, 0), "expected a wavelength above 0 m, got 0 m");
  EXPECT_EQ(error_of([] { trace({}, traced_panel, green_light, {}); }),
            "expected at least one object in the scene, a visible rectangle light, or a background, got none");
}

TEST(Trace, ProgressReachesOne) {
  double most = 0;
  std::mutex mutex;
  Observer observer;
  observer.on_progress = [&](double fraction) {
    const std::lock_guard lock(mutex);
    most = std::max(most, fraction);
  };
  trace(make_bright_wall(), traced_panel, green_light, {.columns = 16, .rows = 16, .paths = 1}, observer);
  EXPECT_EQ(most, 1);
}

}  // namespace
}  // namespace holotrace
