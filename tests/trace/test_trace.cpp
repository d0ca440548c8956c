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

const Grid panel{256, 192, 8e-6};

/// A wall that emits radiance 1 and fills more than the panel accepts.
Scene make_bright_wall(double z = -0.3) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_wall(z, 50_mm, 50_mm)};
  return scene;
}

/// Two walls at an angle, lit by a rectangle, with smooth noise: what a real scene asks of a tracer.
Scene make_corner() {
  Scene scene;
  scene.materials = {grey(0.7), DiffuseMaterial{{0.9, 0.5, 0.2}, nullptr, {}}};
  scene.meshes = {make_wall(-0.3, 12_mm, 12_mm), make_test_quad({0, -6_mm, -0.29}, {12_mm, 0, 0}, {0, 2_mm, 10_mm}, 1)};
  scene.lights = {RectangleLight{{-5_mm, 15_mm, -0.29}, {10_mm, 0, 0}, {0, 0, 10_mm}, {40, 40, 40}}};
  return scene;
}

TEST(Trace, RasterOfFirstHitsBringsThePanelsCentreItsIrradiance) {
  // ∫∫ cos⁴ dt over the square of tangents: the cosine-weighted solid angle of a parallel square, π times the
  // view factor of four corner rectangles.
  TraceParams params{.columns = 64, .rows = 48, .paths = 1, .max_depth = 1};
  for (double field_of_view : {0.0, 0.5}) {
    params.field_of_view = field_of_view;
    const Scene scene = make_bright_wall(-0.05);
    const Sources sources = trace(scene, panel, green_light, params);
    ASSERT_EQ(sources.waves.size(), 64u * 48u);
    double irradiance = 0;
    for (const Source& wave : sources.waves) {
      const double ratio = -wave.origin.z / length(wave.origin);
      irradiance += double(wave.amplitude) * wave.amplitude * ratio * ratio;
    }
    const double t = field_of_view > 0 ? std::tan(field_of_view) : acceptance_tangent(green_light, panel.pitch);
    const double s = std::sqrt(1 + t * t), expected = 4 * t / s * std::atan(t / s);
    // The midpoint rule is off by (2T/48)²/24·|∂²cos⁴| ≤ 4/24·(2T/48)², relative: 1e-4 at T = 0.55, less at 0.03.
    EXPECT_NEAR(irradiance / expected, 1, 1e-4);
  }
}

TEST(Trace, RasterStartsAtTheTopLeftAndGoesThroughTheCellCentres) {
  const TraceParams params{.columns = 4, .rows = 2, .paths = 1, .max_depth = 1};
  const Sources sources = trace(make_bright_wall(), panel, green_light, params);
  const double t = acceptance_tangent(green_light, panel.pitch);
  ASSERT_EQ(sources.waves.size(), 8u);
  const Vec3 first = sources.waves[0].origin, second = sources.waves[1].origin, last = sources.waves[7].origin;
  // The tangents −3/4, 1/2 and so on, to double rounding.
  EXPECT_NEAR(first.x, -0.75 * t * 0.3, 1e-15);
  EXPECT_NEAR(first.y, 0.5 * t * 0.3, 1e-15);
  EXPECT_NEAR(second.x, -0.25 * t * 0.3, 1e-15);
  EXPECT_NEAR(last.x, 0.75 * t * 0.3, 1e-15);
  EXPECT_NEAR(last.y, -0.5 * t * 0.3, 1e-15);
}

/// Mean over the panel of Σ a²·(d₀/r)² inside boxes, by the pixels.
double mean_intensity(const Sources& sources, const Grid& grid) {
  double sum = 0;
  for (const Source& wave : sources.waves) {
    const double depth = -wave.origin.z, radius = box_radius(depth, sources.wavelength, grid.pitch);
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const double x = grid.x(i) - wave.origin.x, y = grid.y(j) - wave.origin.y;
        if (std::abs(x) > radius || std::abs(y) > radius) continue;
        sum += double(wave.amplitude) * wave.amplitude * depth * depth / (depth * depth + x * x + y * y);
      }
  }
  return sum / double(grid.pixels());
}

TEST(Trace, RandomFirstHitsBringThePanelItsEtendueTimesRadiance) {
  const Grid small{64, 48, 8e-6};
  const TraceParams params{.pattern = Pattern::random, .samples = 4000, .paths = 1, .max_depth = 1};
  const Sources sources = trace(make_bright_wall(-0.02), small, green_light, params);
  const double s = acceptance_sine(green_light, small.pitch);
  // L·G/A, less the part s²/3 of G beyond the boxes. A box edge between pixels is off by up to half a pixel: the
  // standard deviation of a wave's pixel sum is about 1/√6 of a column in 64 of them, and 4000 waves average that to
  // 1e-4. The stratified count of left-out rays adds less than √(4000·s²/3)/4000 = 3e-4. 4 of both together: 1.3e-3.
  EXPECT_NEAR(mean_intensity(sources, small) / (4 * s * s * (1 - s * s / 3)), 1, 1.3e-3);
}

TEST(Trace, RandomFirstHitsKeepTheEtendueOfTheUnitDiscOnPanelsOfHalfAWavelength) {
  // Pitch λ/4: all directions are accepted, boxes have no end and G = A·π.
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
    return double(trace(scene, panel, green_light, params).waves.at(0).amplitude);
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
  const Sources sources = trace(scene, panel, green_light, {.columns = 4, .rows = 4, .paths = 1});
  ASSERT_EQ(sources.waves.size(), 2u);  // the wall is black; the first point is behind it
  EXPECT_EQ(sources.waves[0].amplitude, 2.0f);
  EXPECT_EQ(sources.waves[1].amplitude, 3.0f);
}

TEST(Trace, DarkHitsAndMissesMakeNoWave) {
  Scene scene;
  scene.materials = {grey(0, 1), grey(0)};
  scene.meshes = {make_test_quad({-2.5_mm, 0, -0.3}, {2.5_mm, 0, 0}, {0, 5_mm, 0}, 0),
                  make_test_quad({2.5_mm, 0, -0.3}, {2.5_mm, 0, 0}, {0, 5_mm, 0}, 1)};
  Record record;
  const TraceParams params{.columns = 40, .rows = 40, .paths = 2, .max_depth = 2};
  const Sources sources = trace(scene, panel, green_light, params, record.observer);
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
    trace(scene, panel, green_light, params, record.observer);
    EXPECT_EQ(record.warnings.size(), 1u);
    return record.warnings.empty() ? "" : record.warnings[0];
  };
  // field_of_view widens the raster; random rays keep to the panel's acceptance.
  EXPECT_EQ(warning({.pattern = Pattern::random, .samples = 64, .paths = 1}),
            "none of 64 rays from the panel met a mesh: its pitch of 8 µm sees 1.905° to each side of the axis at 532 "
            "nm; move the scene onto the axis or take a panel of finer pitch");
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
  EXPECT_TRUE(trace(scene, panel, green_light, params, unseen.observer).waves.empty());
  ASSERT_EQ(unseen.warnings.size(), 1u);
  EXPECT_EQ(
      unseen.warnings[0],
      "none of 64 rays from the panel met a mesh: its pitch of 8 µm sees 1.905° to each side of the axis at 532 nm; "
      "move the scene onto the axis or set field_of_view");

  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  Record dark;
  EXPECT_TRUE(trace(scene, panel, green_light, params, dark.observer).waves.empty());
  ASSERT_EQ(dark.warnings.size(), 1u);
  EXPECT_EQ(dark.warnings[0], "every first hit is dark; add lights, emission or a background to the scene");

  scene.lights = {PointLight{{0, 0, -0.4}, {1, 1, 1}}};
  Record behind;
  trace(scene, panel, green_light, params, behind.observer);
  ASSERT_EQ(behind.warnings.size(), 1u);
  EXPECT_EQ(behind.warnings[0],
            "every first hit is dark: the scene's lights do not reach what the panel sees; move them, or add others, "
            "emission or a background");

  scene.materials.push_back(DielectricMaterial{});
  scene.meshes.push_back(make_wall(-0.2, 50_mm, 50_mm, 1));
  scene.lights = {PointLight{{0, 0, -0.1}, {1, 1, 1}}};
  Record behind_glass;
  trace(scene, panel, green_light, params, behind_glass.observer);
  ASSERT_EQ(behind_glass.warnings.size(), 1u);
  EXPECT_EQ(behind_glass.warnings[0],
            "every first hit is dark: the scene's lights do not reach what the panel sees; solid glass casts a shadow "
            "in the light of points, spots, beams and the sun: light what it covers by rectangles, emission, a "
            "background or an environment");
}

TEST(Trace, LuminousPointsBecomeSourcesAsTheyAre) {
  Scene scene = make_bright_wall();
  scene.points = {{{1_mm, 2_mm, -0.25}, 0.5f, 0.25f}, {{0, 0, -0.2}, 2.0f, 0}};
  TraceParams params{.columns = 3, .rows = 3, .paths = 1, .phase = SourcePhase::constant};
  Sources sources = trace(scene, panel, green_light, params);
  ASSERT_EQ(sources.waves.size(), 2u + 9u);
  EXPECT_EQ(sources.wavelength, green_light);
  EXPECT_EQ(sources.waves[0], (Source{{1_mm, 2_mm, -0.25}, 0.5f, 0.25f}));
  EXPECT_EQ(sources.waves[1], (Source{{0, 0, -0.2}, 2.0f, 0}));
  EXPECT_EQ(sources.waves[2].phase, 0);

  params.phase = SourcePhase::random;
  sources = trace(scene, panel, green_light, params);
  CounterRandom first(1, 0, 0);
  EXPECT_EQ(sources.waves[0].phase, float(2 * pi * first.uniform() + 0.25));
}

TEST(Trace, TheSameSourcesComeFromAnyNumberOfThreads) {
  for (Pattern pattern : {Pattern::grid, Pattern::random}) {
    const TraceParams params{.pattern = pattern, .columns = 48, .rows = 48, .samples = 2000, .paths = 4};
    std::vector<Sources> results;
    for (size_t threads : {1, 2, 7}) {
      tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      results.push_back(trace(make_corner(), panel, green_light, params));
    }
    EXPECT_GT(results[0].waves.size(), 500u);
    EXPECT_EQ(results[0].waves, results[1].waves);
    EXPECT_EQ(results[0].waves, results[2].waves);
  }
}

TEST(Trace, SeedsDrawOtherPhasesAndTheSameSeedTheSame) {
  TraceParams params{.columns = 16, .rows = 16, .paths = 1, .max_depth = 1};
  const Sources first = trace(make_bright_wall(), panel, green_light, params);
  EXPECT_EQ(first.waves, trace(make_bright_wall(), panel, green_light, params).waves);
  params.seed = 2;
  const Sources second = trace(make_bright_wall(), panel, green_light, params);
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
  trace(make_bright_wall(), panel, green_light, params, open.observer);
  EXPECT_TRUE(open.warnings.empty()) << "beyond a wall alone there is nothing to miss";
  trace(make_corner(), panel, green_light, params, record.observer);
  ASSERT_EQ(record.warnings.size(), 1u);
  EXPECT_NE(record.warnings[0].find("% of the light paths were cut after 1 surfaces"), std::string::npos);
}

TEST(Trace, ParametersOutOfRangeAreErrorsThatSayWhatWasExpected) {
  const auto sentence = [](const TraceParams& params, double pitch = 8e-6, double wavelength = green_light) {
    return error_of([&] { trace(make_bright_wall(), {16, 16, pitch}, wavelength, params); });
  };
  EXPECT_EQ(sentence({.paths = 0}), "expected paths of 1 or more per first hit, got 0");
  EXPECT_EQ(sentence({.max_depth = 0}), "expected a max_depth of 1 surface or more, got 0");
  EXPECT_EQ(sentence({.columns = 0}), "expected a raster of at least 1 × 1 first hits, got columns = 0, rows = 256");
  EXPECT_EQ(sentence({.pattern = Pattern::random, .samples = 0}), "expected 1 to 1099511627776 samples, got 0");
  EXPECT_EQ(sentence({.field_of_view = 90_deg}), "expected a field_of_view from 0 to less than 90 deg, got 90 deg");
  EXPECT_EQ(
      sentence({}, 266_nm),
      "expected a field_of_view for a panel of pitch 266 nm at 532 nm: it accepts light from all sides, so set the "
      "half angle of the view");
  EXPECT_EQ(sentence({.field_of_view = 30_deg, .paths = 1}, 266_nm), "");
  EXPECT_EQ(sentence({}, -1), "expected a pixel pitch above 0 m, got -1 m");
  EXPECT_EQ(sentence({}, 8e-6, 0), "expected a wavelength above 0 m, got 0 m");
  EXPECT_EQ(error_of([] { trace({}, panel, green_light, {}); }), "expected at least one object in the scene, got none");
}

double squared_amplitudes(const Sources& sources) {
  double sum = 0;
  for (const Source& wave : sources.waves) sum += double(wave.amplitude) * wave.amplitude;
  return sum;
}

TEST(Trace, LayersOfAPartitionAddUpToTheWhole) {
  TraceParams params{.columns = 24, .rows = 24, .paths = 8, .layers = {"EL", "EDL", "EDD.*L"}};
  const Sources all = trace(make_corner(), panel, green_light, {.columns = 24, .rows = 24, .paths = 8});
  const Sources summed = trace(make_corner(), panel, green_light, params);
  params.separate_layers = true;
  const std::vector<Sources> layers = trace(make_corner(), panel, std::vector<double>{green_light}, params);
  ASSERT_EQ(layers.size(), 2u) << "nothing that shines is seen directly: EL has no wave and is left out";
  EXPECT_EQ(layers[0].name, "EDL");
  EXPECT_EQ(layers[1].name, "EDD.*L");
  double sum = 0;
  for (const Sources& layer : layers) sum += squared_amplitudes(layer);
  // The same paths, split: a² of floats, 1e-7 each.
  EXPECT_NEAR(sum / squared_amplitudes(all), 1, 1e-6);
  EXPECT_NEAR(squared_amplitudes(summed) / squared_amplitudes(all), 1, 1e-6);
}

TEST(Trace, LightsOfTheirOwnAddUpToTheWholeAndEmptyOnesAreLeftOut) {
  Scene scene = make_corner();
  scene.lights.push_back(PointLight{{5_mm, 5_mm, -0.25}, {1e-3, 1e-3, 1e-3}});
  scene.lights.push_back(PointLight{{5_mm, 5_mm, -0.5}, {1, 1, 1}});  // behind the wall
  scene.points = {{{0, 0, -0.2}, 1.0f, 0}};
  TraceParams params{.columns = 24, .rows = 24, .paths = 8};
  const Sources all = trace(scene, panel, green_light, params);
  params.separate_lights = true;
  const std::vector<Sources> lights = trace(scene, panel, std::vector<double>{green_light}, params);
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights[0].name, "light 0");
  EXPECT_EQ(lights[1].name, "light 1");
  EXPECT_EQ(lights[2].name, "points");
  EXPECT_EQ(lights[2].waves.size(), 1u);
  double sum = 0;
  for (const Sources& light : lights) sum += squared_amplitudes(light);
  EXPECT_NEAR(sum / squared_amplitudes(all), 1, 1e-6);
  params.layers = {"EDL", "EDD.*L"};
  params.separate_layers = true;
  const std::vector<Sources> both = trace(scene, panel, std::vector<double>{green_light}, params);
  ASSERT_EQ(both.size(), 4u) << "a point is the path EL, which is in neither layer";
  EXPECT_EQ(both[0].name, "EDL, light 0");
  EXPECT_EQ(both[3].name, "EDD.*L, light 1");
}

TEST(Trace, AListOfWavelengthsIsEachByItselfFromTheFirstHitsOfTheLongest) {
  const std::vector<double> colours{460_nm, 630_nm, 532_nm, 450_nm};  // four: a group of three and one of one
  for (const Pattern pattern : {Pattern::grid, Pattern::random}) {
    const TraceParams params{.pattern = pattern, .columns = 16, .rows = 16, .samples = 400, .paths = 2};
    const std::vector<Sources> sets = trace(make_corner(), panel, colours, params);
    ASSERT_EQ(sets.size(), 4u);
    for (size_t i = 0; i < 4; ++i) EXPECT_EQ(sets[i].wavelength, colours[i]);
    const Sources red = trace(make_corner(), panel, 630_nm, params);
    EXPECT_EQ(sets[1].waves, red.waves);
    // All colours of the raster are at the same places; shorter ones of the random pattern leave out what they
    // cannot hold.
    if (pattern == Pattern::grid) {
      ASSERT_EQ(sets[0].waves.size(), red.waves.size());
      for (size_t i = 0; i < red.waves.size(); ++i) EXPECT_EQ(sets[0].waves[i].origin, red.waves[i].origin);
    } else {
      EXPECT_LT(sets[0].waves.size(), sets[2].waves.size());
      EXPECT_LT(sets[2].waves.size(), red.waves.size());
    }
  }
}

TEST(Trace, ShorterWavelengthsBringTheirEtendueFromSharedRays) {
  const Grid small{64, 48, 8e-6};
  const TraceParams params{.pattern = Pattern::random, .samples = 4000, .paths = 1, .max_depth = 1};
  const auto sets = trace(make_bright_wall(-0.02), small, std::vector<double>{630_nm, 450_nm}, params);
  const double s = acceptance_sine(450_nm, small.pitch);
  // As RandomFirstHitsBringThePanelItsEtendueTimesRadiance, but only (450/630)² = 0.51 of 4000 strata count; those on
  // the edge, 4·√2040 = 180, are in or out by chance: √180/2/2040 = 3.3e-3. 4 of them: 1.3e-2.
  EXPECT_NEAR(mean_intensity(sets[1], small) / (4 * s * s * (1 - s * s / 3)), 1, 1.3e-2);
}

TEST(Trace, FramesAreIndependentDrawsOfThePhasesAlone) {
  TraceParams params{.columns = 32, .rows = 32, .paths = 1, .max_depth = 1};
  for (const SourcePhase phase : {SourcePhase::random, SourcePhase::surface, SourcePhase::path}) {
    params.phase = phase;
    const Sources first = trace(make_bright_wall(), panel, green_light, params);
    Sources second = first;
    set_frame(second, 1);
    ASSERT_EQ(first.phase_keys.size(), first.waves.size());
    Statistics cosine;
    for (size_t i = 0; i < first.waves.size(); ++i) {
      EXPECT_EQ(first.waves[i].origin, second.waves[i].origin);
      EXPECT_EQ(first.waves[i].amplitude, second.waves[i].amplitude);
      cosine.add(std::cos(first.waves[i].phase - second.waves[i].phase));
    }
    EXPECT_NEAR(cosine.mean(), 0, 4 * std::sqrt(0.5 / 1024));  // differences are even over the circle
    set_frame(second, 0);
    for (size_t i = 0; i < first.waves.size(); ++i)  // there and back: float roundings of up to 2·2π
      EXPECT_NEAR(first.waves[i].phase, second.waves[i].phase, 2e-6);
  }
  params.phase = SourcePhase::constant;
  EXPECT_TRUE(trace(make_bright_wall(), panel, green_light, params).phase_keys.empty());
}

TEST(Trace, SurfacePhaseIsAFunctionOfThePlaceAlone) {
  TraceParams params{.pattern = Pattern::random,
                     .samples = 3000,
                     .paths = 1,
                     .max_depth = 1,
                     .phase = SourcePhase::surface,
                     .grain = 0.4_mm};
  const Sources sources = trace(make_bright_wall(-0.05), panel, green_light, params);
  // Panel and cone see some 5.3 mm × 4.9 mm of the wall: 13 × 12 cells, and no more phases than those and the rims.
  std::map<uint64_t, float> phases;
  for (size_t i = 0; i < sources.waves.size(); ++i) {
    const auto [place, is_new] = phases.emplace(sources.phase_keys[i], sources.waves[i].phase);
    EXPECT_EQ(place->second, sources.waves[i].phase);
  }
  EXPECT_GT(phases.size(), 100u);
  EXPECT_LE(phases.size(), 15u * 14u);
  params.seed = 2;  // other rays, the same places: the phase belongs to place and seed
  const Sources other = trace(make_bright_wall(-0.05), panel, green_light, params);
  size_t shared_keys = 0;
  for (const uint64_t key : other.phase_keys) shared_keys += phases.contains(key);
  EXPECT_GT(double(shared_keys), 0.98 * double(other.phase_keys.size()));
}

TEST(Trace, SetsThatAreSeveralAreNoAnswerForOneWavelength) {
  EXPECT_EQ(
      error_of([] { trace(make_corner(), panel, green_light, {.separate_lights = true}); }),
      "expected parameters that make one set of waves, got separate_layers = false, separate_lights = true; trace "
      "a list of wavelengths, which returns all sets");
  EXPECT_EQ(error_of([] { trace(make_corner(), panel, std::vector<double>{}, {}); }),
            "expected at least one wavelength, got none");
  EXPECT_EQ(error_of([] { trace(make_corner(), panel, green_light, {.strategy = Strategy::gather}); }),
            "expected the strategy shared or tiled, got gather, which makes no waves but the field itself: "
            "take the command field or run, or call gather");
  EXPECT_EQ(error_of([] { trace(make_corner(), panel, green_light, {.grain = -1}); }),
            "expected a grain of 0 m (the pixel pitch) or more, got -1 m");
}

TEST(Trace, ProgressReachesOne) {
  double most = 0;
  std::mutex mutex;
  Observer observer;
  observer.on_progress = [&](double fraction) {
    const std::lock_guard lock(mutex);
    most = std::max(most, fraction);
  };
  trace(make_bright_wall(), panel, green_light, {.columns = 16, .rows = 16, .paths = 1}, observer);
  EXPECT_EQ(most, 1);
}

}  // namespace
}  // namespace holotrace
