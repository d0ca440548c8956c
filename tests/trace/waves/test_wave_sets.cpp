#include <gtest/gtest.h>

#include <map>

#include "holotrace/data/acceptance.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

// The sets of waves that a tracing makes: path groups, lights, wavelengths, frames.

namespace holotrace {
namespace {

const Grid sets_panel{256, 192, 8e-6};

double squared_amplitudes(const Sources& sources) {
  double sum = 0;
  for (const Source& wave : sources.waves) sum += double(wave.amplitude) * wave.amplitude;
  return sum;
}

TEST(WaveSets, PathGroupsOfAPartitionAddUpToTheWhole) {
  TraceParams params{.columns = 24, .rows = 24, .paths = 8, .path_expressions = {"EL", "EDL", "EDD.*L"}};
  const Sources all = trace(make_corner(), sets_panel, green_light, {.columns = 24, .rows = 24, .paths = 8});
  const Sources summed = trace(make_corner(), sets_panel, green_light, params);
  params.separate_path_groups = true;
  const std::vector<Sources> path_groups = trace(make_corner(), sets_panel, std::vector<double>{green_light}, params);
  ASSERT_EQ(path_groups.size(), 2u) << "nothing that shines is seen directly: EL has no wave and is left out";
  EXPECT_EQ(path_groups[0].label.name, "EDL");
  EXPECT_EQ(path_groups[1].label.name, "EDD.*L");
  double sum = 0;
  for (const Sources& path_group : path_groups) sum += squared_amplitudes(path_group);
  // The same paths, split among sums: a² of floats, 1e-7 each.
  EXPECT_NEAR(sum / squared_amplitudes(all), 1, 1e-6);
  EXPECT_NEAR(squared_amplitudes(summed) / squared_amplitudes(all), 1, 1e-6);
}

TEST(WaveSets, LightsOfTheirOwnAddUpToTheWholeAndEmptyOnesAreLeftOut) {
  Scene scene = make_corner();
  scene.lights.push_back(PointLight{{5_mm, 5_mm, -0.25}, {1e-3, 1e-3, 1e-3}});
  scene.lights.push_back(PointLight{{5_mm, 5_mm, -0.5}, {1, 1, 1}});  // behind the wall
  scene.points = {{{0, 0, -0.2}, 1.0f, 0}};
  TraceParams params{.columns = 24, .rows = 24, .paths = 8};
  const Sources all = trace(scene, sets_panel, green_light, params);
  params.separate_lights = true;
  const std::vector<Sources> lights = trace(scene, sets_panel, std::vector<double>{green_light}, params);
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights[0].label.name, "light 0");
  EXPECT_EQ(lights[1].label.name, "light 1");
  EXPECT_EQ(lights[2].label.name, "points");
  EXPECT_EQ(lights[2].waves.size(), 1u);
  double sum = 0;
  for (const Sources& light : lights) sum += squared_amplitudes(light);
  EXPECT_NEAR(sum / squared_amplitudes(all), 1, 1e-6);
  params.path_expressions = {"EDL", "EDD.*L"};
  params.separate_path_groups = true;
  const std::vector<Sources> both = trace(scene, sets_panel, std::vector<double>{green_light}, params);
  ASSERT_EQ(both.size(), 4u) << "a point is the path EL, which is in neither path group";
  EXPECT_EQ(both[0].label.name, "EDL, light 0");
  EXPECT_EQ(both[3].label.name, "EDD.*L, light 1");
}

TEST(WaveSets, AListOfWavelengthsIsEachByItselfFromTheFirstHitsOfTheLongestWithoutACommonCone) {
  const std::vector<double> colours{460_nm, 630_nm, 532_nm, 450_nm};  // four: a group of three and a group of one
  for (const Pattern pattern : {Pattern::grid, Pattern::random}) {
    const TraceParams params{
        .pattern = pattern, .columns = 16, .rows = 16, .samples = 400, .has_common_cone = false, .paths = 2};
    const std::vector<Sources> sets = trace(make_corner(), sets_panel, colours, params);
    ASSERT_EQ(sets.size(), 4u);
    for (size_t i = 0; i < 4; ++i) EXPECT_EQ(sets[i].wavelength, colours[i]);
    const Sources red = trace(make_corner(), sets_panel, 630_nm, params);
    EXPECT_EQ(sets[1].waves, red.waves);
    // All colours of the raster are at the same places. Shorter wavelengths of the random pattern leave out directions
    // beyond their acceptance.
    if (pattern == Pattern::grid) {
      ASSERT_EQ(sets[0].waves.size(), red.waves.size());
      for (size_t i = 0; i < red.waves.size(); ++i) EXPECT_EQ(sets[0].waves[i].origin, red.waves[i].origin);
    } else {
      EXPECT_LT(sets[0].waves.size(), sets[2].waves.size());
      EXPECT_LT(sets[2].waves.size(), red.waves.size());
    }
  }
}

TEST(WaveSets, WithACommonConeAllWavelengthsHaveTheFirstHitsOfTheShortest) {
  const std::vector<double> colours{460_nm, 630_nm, 532_nm, 450_nm};
  for (const Pattern pattern : {Pattern::grid, Pattern::random}) {
    const TraceParams params{.pattern = pattern, .columns = 16, .rows = 16, .samples = 400, .paths = 2};
    const std::vector<Sources> sets = trace(make_corner(), sets_panel, colours, params);
    const Sources blue = trace(make_corner(), sets_panel, 450_nm, params);
    ASSERT_EQ(sets.size(), 4u);
    for (const Sources& set : sets) {
      EXPECT_EQ(set.label.cone_wavelength, 450_nm);
      ASSERT_EQ(set.waves.size(), blue.waves.size());
      for (size_t i = 0; i < blue.waves.size(); ++i) EXPECT_EQ(set.waves[i].origin, blue.waves[i].origin);
    }
    EXPECT_EQ(blue.label.cone_wavelength, 0) << "one wavelength has its own";
  }
}

TEST(WaveSets, ShorterWavelengthsBringTheirEtendueFromSharedRays) {
  const Grid small{64, 48, 8e-6};
  const TraceParams params{
      .pattern = Pattern::random, .samples = 4000, .has_common_cone = false, .paths = 1, .max_depth = 1};
  const auto sets = trace(make_bright_wall(-0.02), small, std::vector<double>{630_nm, 450_nm}, params);
  const double s = acceptance_sine(450_nm, small.pitch);
  // As RandomFirstHitsBringThePanelItsEtendueTimesRadiance, but only (450/630)² = 0.51 of 4000 strata count. Those on
  // the edge, 4·√2040 = 180, are in or out by chance: √180/2/2040 = 3.3e-3. Four times that: 1.3e-2.
  EXPECT_NEAR(mean_intensity(sets[1], small) / (4 * s * s * (1 - s * s / 3)), 1, 1.3e-2);
}

TEST(WaveSets, FramesAreIndependentDrawsOfThePhasesAlone) {
  TraceParams params{.columns = 32, .rows = 32, .paths = 1, .max_depth = 1};
  for (const SourcePhase phase : {SourcePhase::random, SourcePhase::surface, SourcePhase::path}) {
    params.phase = phase;
    const Sources first = trace(make_bright_wall(), sets_panel, green_light, params);
    Sources second = first;
    set_frame(second, 1);
    ASSERT_EQ(first.phase_keys.size(), first.waves.size());
    Statistics cosine;
    for (size_t i = 0; i < first.waves.size(); ++i) {
      EXPECT_EQ(first.waves[i].origin, second.waves[i].origin);
      EXPECT_EQ(first.waves[i].amplitude, second.waves[i].amplitude);
      cosine.add(std::cos(first.waves[i].phase - second.waves[i].phase));
    }
    EXPECT_NEAR(cosine.mean(), 0, 4 * std::sqrt(0.5 / 1024));  // differences are uniform over the circle
    set_frame(second, 0);
    for (size_t i = 0; i < first.waves.size(); ++i)  // forward and back: float roundings of up to 2·2π
      EXPECT_NEAR(first.waves[i].phase, second.waves[i].phase, 2e-6);
  }
  params.phase = SourcePhase::constant;
  EXPECT_TRUE(trace(make_bright_wall(), sets_panel, green_light, params).phase_keys.empty());
}

TEST(WaveSets, SurfacePhaseIsAFunctionOfThePlaceAlone) {
  TraceParams params{.pattern = Pattern::random,
                     .samples = 3000,
                     .paths = 1,
                     .max_depth = 1,
                     .phase = SourcePhase::surface,
                     .grain = 0.4_mm,
                     .one_wave_per_cell = false};
  const Sources sources = trace(make_bright_wall(-0.05), sets_panel, green_light, params);
  // Panel and cone see some 5.3 mm × 4.9 mm of the wall: 13 × 12 cells, so there are no more phases than these plus the
  // rims.
  std::map<uint64_t, float> phases;
  for (size_t i = 0; i < sources.waves.size(); ++i) {
    const auto [place, is_new] = phases.emplace(sources.phase_keys[i], sources.waves[i].phase);
    EXPECT_EQ(place->second, sources.waves[i].phase);
  }
  EXPECT_GT(phases.size(), 100u);
  EXPECT_LE(phases.size(), 15u * 14u);
  params.seed = 2;  // other rays, the same places: the phase belongs to place and seed
  const Sources other = trace(make_bright_wall(-0.05), sets_panel, green_light, params);
  size_t shared_keys = 0;
  for (const uint64_t key : other.phase_keys) shared_keys += phases.contains(key);
  EXPECT_GT(double(shared_keys), 0.98 * double(other.phase_keys.size()));
}

TEST(WaveSets, SetsThatAreSeveralAreNoAnswerForOneWavelength) {
  EXPECT_EQ(error_of([] { trace(make_corner(), sets_panel, green_light, {.separate_lights = true}); }),
            "expected parameters that make one set of waves, got separate_path_groups = false, separate_lights = true, "
            "separate_polarizations = false; trace a list of wavelengths, which returns all sets");
  EXPECT_EQ(error_of([] { trace(make_corner(), sets_panel, std::vector<double>{}, {}); }),
            "expected at least one wavelength, got none");
  EXPECT_EQ(error_of([] { trace(make_corner(), sets_panel, green_light, {.strategy = Strategy::gather}); }),
            "expected the strategy shared or tiled, got gather, which makes no waves but the field itself: use "
            "the command field or run, or call gather");
  EXPECT_EQ(error_of([] { trace(make_corner(), sets_panel, green_light, {.grain = -1}); }),
            "expected a length of 0 m or more for \"grain\", got -1 m");
}

}  // namespace
}  // namespace holotrace
