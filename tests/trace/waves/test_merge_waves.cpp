#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <set>

#include "holotrace/trace/trace.h"
#include "holotrace/trace/waves/source_phase.h"
#include "trace/scenes.h"

// One wave for each cell of equal phase.

namespace holotrace {
namespace {

const Grid merged_panel{64, 48, 8e-6};
constexpr double grain = 50e-6;

double light_of(const Sources& sources) {
  double sum = 0;
  for (const Source& wave : sources.waves) sum += double(wave.amplitude) * wave.amplitude;
  return sum;
}

TEST(MergeWaves, AmplitudesAddUpInPowerInEveryTileAndThePlaceIsTheMostCentral) {
  TracedWaves waves;
  waves.waves = {{{0, 0, -0.1}, 3, 1}, {{1, 0, -1}, 7, 2}, {{1e-6, 0, -0.1}, 4, 3}, {{2e-6, 0, -0.1}, 12, 4}};
  waves.keys = {5, 6, 5, 5};
  waves.cells = {{5, 3e-6, {0, 0, -0.1}}, {}, {5, 1e-6, {0, 0, -0.1}}, {5, 2e-6, {0, 0, -0.1}}};
  waves.second_foci = {{}, {}, {{0, 0, -0.2}, {1, 0, 0}}, {{0, 0, -0.3}, {1, 0, 0}}};
  waves.tiles = {3, 0, 7, 7, 4, 1, 12, 0};
  merge_waves(waves, 8e-6, 2);
  ASSERT_EQ(waves.waves.size(), 2u);
  EXPECT_EQ(waves.waves[0], (Source{{1e-6, 0, -0.1}, 13, 3}));  // √(3² + 4² + 12²)
  EXPECT_EQ(waves.waves[1], (Source{{1, 0, -1}, 7, 2}));
  EXPECT_EQ(waves.second_foci, (std::vector<SecondFocus>{{{0, 0, -0.2}, {1, 0, 0}}, {}}));
  EXPECT_EQ(waves.keys, (std::vector<uint64_t>{5, 6}));
  EXPECT_EQ(waves.tiles, (std::vector<float>{13, 1, 7, 7}));
}

TEST(MergeWaves, WavesAloneAndImagesApartStayApart) {
  TracedWaves waves;
  // Two waves alone; two of one cell 1 mm apart at 0.1 m, where 8 cells are 64 µm: images by two mirrors.
  waves.waves = {{{0, 0, -0.1}, 1, 0}, {{0, 0, -0.1}, 1, 0}, {{0, 0, -0.1}, 1, 0}, {{1_mm, 0, -0.1}, 1, 0}};
  waves.keys = {1, 2, 3, 3};
  waves.cells = {{}, {}, {3, 0, {0, 0, -0.1}}, {3, 0, {1_mm, 0, -0.1}}};
  waves.second_foci.resize(4);
  merge_waves(waves, 8e-6, 0);
  EXPECT_EQ(waves.waves.size(), 4u);
}

TEST(MergeWaves, RastersOfAnyFinenessMakeOneWavePerCellAndTheSameLight) {
  TraceParams params{
      .columns = 64, .rows = 64, .paths = 1, .max_depth = 1, .phase = SourcePhase::surface, .grain = grain};
  const Scene scene = make_bright_wall(-20_mm);
  double light = 0;
  for (const int columns : {128, 256}) {  // 10 and 5 µm apart: 5 and 10 in a cell, along an axis
    params.columns = params.rows = columns;
    const Sources sources = trace(scene, merged_panel, green_light, params);
    const std::set<uint64_t> keys(sources.phase_keys.begin(), sources.phase_keys.end());
    EXPECT_EQ(keys.size(), sources.waves.size());
    // ±0.67 mm are 26.7 cells: 27 or 28 along an axis.
    EXPECT_GE(sources.waves.size(), 27u * 27);
    EXPECT_LE(sources.waves.size(), 28u * 28);
    if (columns == 256) {
      EXPECT_NEAR(light_of(sources) / light, 1, 1e-4);  // of midpoint rules for cos⁴, as in test_trace.cpp
    }
    light = light_of(sources);
  }
  params.one_wave_per_cell = false;
  const Sources each = trace(scene, merged_panel, green_light, params);
  EXPECT_EQ(each.waves.size(), 256u * 256);
  EXPECT_NEAR(light_of(each) / light, 1, 1e-5);  // floats
}

TEST(MergeWaves, ALittleMoreOrLessLightOfACellIsItsArea) {
  // Each whole cell is 50 µm wide; the raster has steps of 5.2 µm. Its light is that of its hits, (9 or 10)² of them.
  const TraceParams params{
      .columns = 256, .rows = 256, .paths = 1, .max_depth = 1, .phase = SourcePhase::surface, .grain = grain};
  const Sources sources = trace(make_bright_wall(-20_mm), merged_panel, green_light, params);
  const double area = grain * grain / (0.02 * 0.02);  // as tangents: L·dA
  int whole = 0;
  for (const Source& wave : sources.waves) {
    const double squared = double(wave.amplitude) * wave.amplitude;
    if (std::abs(wave.origin.x) > 0.6_mm || std::abs(wave.origin.y) > 0.6_mm) continue;
    ++whole;
    EXPECT_NEAR(squared / area, 1, 0.2);  // (10/9.6)² and (9/9.6)², less 2·(0.6/20)²
    const Vec3 middle = surface_cell(wave.origin, grain).centre;
    EXPECT_LE(std::abs(wave.origin.x - middle.x), 2.7_um);  // half the raster's step
    EXPECT_LE(std::abs(wave.origin.y - middle.y), 2.7_um);
  }
  EXPECT_GT(whole, 500);
}

TEST(MergeWaves, ConstantPhasesHaveCellsOfAPixelWhateverTheGrain) {
  for (const double any : {0.0, 1e-6, 1e-3}) {
    const TraceParams params{.columns = 200,
                             .rows = 200,
                             .field_of_view = 0.5_deg,
                             .paths = 1,
                             .max_depth = 1,
                             .phase = SourcePhase::constant,
                             .grain = any};
    const Sources sources = trace(make_bright_wall(-20_mm), merged_panel, green_light, params);
    // ±175 µm in steps of 1.7 µm are 43.6 pixels: 44 or 45 along an axis.
    EXPECT_GE(sources.waves.size(), 44u * 44);
    EXPECT_LE(sources.waves.size(), 45u * 45);
    EXPECT_TRUE(sources.phase_keys.empty());
  }
}

TEST(MergeWaves, RandomPhasesShareNoWave) {
  const TraceParams params{.columns = 64, .rows = 64, .paths = 1, .max_depth = 1, .grain = 1.0};
  EXPECT_EQ(trace(make_bright_wall(-20_mm), merged_panel, green_light, params).waves.size(), 64u * 64);
}

TEST(MergeWaves, MirrorsShowACellOnceEach) {
  // One cell of 0.1 mm contains the wall. It is seen directly, and by each of two mirrors (one mesh) at x = ±2
  // mm.
  Scene scene;
  scene.materials = {grey(0, 1), ConductorMaterial{}};
  Mesh mirrors = make_test_quad({-2_mm, 0, -0.05}, {0, 0, 19_mm}, {0, 5_mm, 0}, 1);
  const Mesh right = make_test_quad({2_mm, 0, -0.05}, {0, 5_mm, 0}, {0, 0, 19_mm}, 1);
  for (const Vec3 p : right.positions) mirrors.positions.push_back(p);
  mirrors.texture_coordinates.clear();
  for (const auto& t : right.triangles) mirrors.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
  scene.meshes = {make_wall(-0.1, 20_um, 20_um), mirrors};
  const TraceParams params{.columns = 801,
                           .rows = 1,
                           .field_of_view = std::atan(0.0405),
                           .paths = 1,
                           .max_depth = 2,
                           .phase = SourcePhase::path,
                           .grain = 1e-4};
  // 801 columns over ±40.5/1000: the wall is seen at ±0.2/1000, its images at ±40/1000 (±4 mm at 0.1 m), 0.1/1000
  // apart.
  const Sources sources = trace(scene, merged_panel, green_light, params);
  std::map<int, int> places;
  for (const Source& wave : sources.waves) ++places[int(std::lround(wave.origin.x / 1_mm))];
  EXPECT_EQ(places, (std::map<int, int>{{-4, 1}, {0, 1}, {4, 1}}));
  const std::set<uint64_t> keys(sources.phase_keys.begin(), sources.phase_keys.end());
  EXPECT_EQ(keys.size(), 1u);
}

TEST(MergeWaves, TheSameBytesComeFromAnyNumberOfThreads) {
  const TraceParams params{.strategy = Strategy::tiled,
                           .pattern = Pattern::random,
                           .samples = 20000,
                           .tile_columns = 4,
                           .tile_rows = 3,
                           .paths = 1,
                           .phase = SourcePhase::path,
                           .grain = 0.2_mm};
  std::vector<Sources> results;
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(trace(make_corner(), merged_panel, green_light, params));
  }
  EXPECT_GT(results[0].waves.size(), 100u);
  for (const size_t i : {1, 2}) {
    EXPECT_EQ(results[0].waves, results[i].waves);
    EXPECT_EQ(results[0].tiles, results[i].tiles);
    EXPECT_EQ(results[0].phase_keys, results[i].phase_keys);
  }
}

}  // namespace
}  // namespace holotrace
