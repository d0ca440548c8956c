#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "holotrace/data/acceptance.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/shade_triangles.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

// Background, environment and sky in holograms.

namespace holotrace {
namespace {

const Grid panel{128, 96, 8e-6};

/// A black wall that covers the left half of the view, before a background of radiance 2.
Scene half_open() {
  Scene scene;
  scene.materials = {grey(0)};
  scene.meshes = {make_test_quad({-25_mm, 0, -0.3}, {25_mm, 0, 0}, {0, 50_mm, 0})};
  scene.background = {2, 2, 2};
  return scene;
}

TraceParams shown(Strategy strategy = Strategy::shared) {
  return {.strategy = strategy,
          .columns = 32,
          .rows = 24,
          .tile_columns = 2,
          .tile_rows = 2,
          .paths = 1,
          .has_background = true};
}

TEST(BackgroundWaves, AreThereOnlyIfAskedForAndWhereNoSurfaceIs) {
  TraceParams params = shown();
  params.has_background = false;
  EXPECT_TRUE(trace(half_open(), panel, green_light, params).waves.empty());
  params.has_background = true;
  const Sources sources = trace(half_open(), panel, green_light, params);
  EXPECT_EQ(sources.waves.size(), 16u * 24u);
  for (const Source& wave : sources.waves) {
    EXPECT_GT(wave.origin.x, 0);
    EXPECT_NEAR(length(wave.origin), 1e4, 1e-6) << "as good as infinitely far away: background_distance";
  }
}

TEST(BackgroundWaves, BringThePanelTheIrradianceOfTheBackground) {
  // As a wall of the same radiance: half of L·∫∫ cos⁴ dt over the square of tangents (test_trace.cpp), to the same error.
  const Sources sources = trace(half_open(), panel, green_light, shown());
  double irradiance = 0;
  for (const Source& wave : sources.waves) {
    const double cosine = -wave.origin.z / length(wave.origin);
    irradiance += double(wave.amplitude) * wave.amplitude * cosine * cosine;
  }
  const double t = acceptance_tangent(green_light, panel.pitch), s = std::sqrt(1 + t * t);
  EXPECT_NEAR(irradiance / (2 * 2 * t / s * std::atan(t / s)), 1, 1e-4);
}

TEST(BackgroundWaves, FillTheEtendueOfARandomPattern) {
  // L·G/A of the open half (test_trace.cpp). The edge of the wall is seen by half of the rays within the panel's parallax of
  // 1 mm at 0.3 m, over a view of 20 mm: its rays are off by √(4000/40)/4000 at most; four times: 1 %.
  TraceParams params = shown();
  params.pattern = Pattern::random;
  params.samples = 4000;
  const Sources sources = trace(half_open(), panel, green_light, params);
  double power = 0;
  for (const Source& wave : sources.waves) power += double(wave.amplitude) * wave.amplitude;
  const double sine = acceptance_sine(green_light, panel.pitch);
  EXPECT_NEAR(power / (2 * 2 * sine * sine), 1, 0.01);
}

TEST(BackgroundWaves, ReachOnlyTheTilesThatSeeThem) {
  // The wall's edge, x = 0 at 0.3 m, hides directions of the slope x/z from tiles at the left of −0.3·x/z: the tiles' centres are at
  // ±256 µm, so waves of slopes below 8.5e-4 are hidden from the left ones.
  TraceParams params = shown(Strategy::tiled);
  params.columns = 400;  // steps of the slope of 1.7e-4
  params.rows = 1;
  const Sources sources = trace(half_open(), panel, green_light, params);
  const size_t count = sources.waves.size();
  size_t hidden = 0;
  for (size_t i = 0; i < count; ++i) {
    const double slope = sources.waves[i].origin.x / -sources.waves[i].origin.z;
    const bool is_hidden = sources.tiles.values[i] == 0;  // from the tile at the upper left
    EXPECT_EQ(is_hidden, slope < 256e-6 / 0.3) << slope;
    EXPECT_GT(sources.tiles.values[count + i], 0) << "the tile at the upper right";
    hidden += is_hidden;
  }
  EXPECT_GT(hidden, 3u);
}

TEST(BackgroundWaves, AreSeenBesideMirrorsWithPhasesOfThePath) {
  Scene scene = half_open();
  scene.materials = {ConductorMaterial{}};
  TraceParams params = shown();
  params.phase = SourcePhase::path;
  const Sources sources = trace(scene, panel, green_light, params);
  EXPECT_EQ(std::count_if(sources.waves.begin(), sources.waves.end(), [](const Source& w) { return w.origin.x > 0; }),
            16 * 24);
}

TEST(BackgroundWaves, TrianglesWarnThatTheyLeaveThemOut) {
  Scene scene = half_open();
  scene.materials = {grey(0, 1)};
  Record record;
  shade_triangles(scene, panel, {green_light}, shown(), Shading::flat, TrianglePhase::random, record.observer);
  ASSERT_EQ(record.warnings.size(), 1u);
  EXPECT_EQ(record.warnings.front(),
            "the method triangles leaves out the background, which has no triangles; use another method to show it");
}

}  // namespace
}  // namespace holotrace
