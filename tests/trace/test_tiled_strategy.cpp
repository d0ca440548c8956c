#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "holotrace/data/acceptance.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/shapes.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const Grid tiled_panel{256, 192, 8e-6};
const std::vector<double> green{green_light};

Vec3 tile_centre(const TraceParams& params, int tile) {
  return centre_of(tiled_panel, tile_box(tiled_panel, params.tile_columns, params.tile_rows, tile));
}

TEST(TiledStrategy, AnOpenDiffuseSceneHasTheAmplitudesOfTheSharedOneInEveryTile) {
  Scene scene;
  scene.materials = {grey(0.5, 1)};
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  scene.points = {{{0, 0, -0.2}, 1.0f, 0.5f}};
  TraceParams params{.columns = 16, .rows = 16, .tile_columns = 3, .tile_rows = 2, .paths = 2, .max_depth = 1};
  for (const Pattern pattern : {Pattern::grid, Pattern::random}) {
    params.pattern = pattern;
    params.samples = 300;
    params.strategy = Strategy::shared;
    const Sources shared = trace(scene, tiled_panel, green_light, params);
    params.strategy = Strategy::tiled;
    const Sources tiled = trace(scene, tiled_panel, green_light, params);
    ASSERT_EQ(tiled.waves.size(), shared.waves.size());
    EXPECT_EQ(tiled.tiles.columns, 3);
    EXPECT_EQ(tiled.tiles.rows, 2);
    ASSERT_EQ(tiled.tiles.values.size(), 6 * shared.waves.size());
    for (size_t i = 0; i < shared.waves.size(); ++i) {
      EXPECT_EQ(tiled.waves[i].origin, shared.waves[i].origin);
      EXPECT_EQ(tiled.waves[i].phase, shared.waves[i].phase);
      // The power over the panel is summed tile by tile: 1e-9 of the quadrature, and a float's rounding. Tiles that the
      // wave reaches only at angles beyond the panel's acceptance get no light.
      const Vec3 origin = shared.waves[i].origin;
      const double radius = box_radius(-origin.z, green_light, tiled_panel.pitch);
      for (size_t t = 0; t < 6; ++t) {
        const PixelBox box = tile_box(tiled_panel, 3, 2, int(t));
        const bool is_in_reach =
            origin.x > tiled_panel.x(box.x0) - radius && origin.x < tiled_panel.x(box.x1 - 1) + radius &&
            origin.y < tiled_panel.y(box.y0) + radius && origin.y > tiled_panel.y(box.y1 - 1) - radius;
        EXPECT_NEAR(tiled.tiles.values[t * shared.waves.size() + i] / shared.waves[i].amplitude, is_in_reach, 1e-6);
      }
    }
  }
}

TEST(TiledStrategy, AFloorAtGrazingIncidenceDoesNotHideItself) {
  // A floor 1 mm below the axis and some 0.3 m away. Tiles at most 0.7 mm above it see it at less than 0.3° to the ray:
  // every tile above the floor must see it.
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_test_quad({0, -1_mm, -0.3}, {5_mm, 0, 0}, {0, 0, -20_mm})};
  TraceParams params{.strategy = Strategy::tiled, .columns = 16, .rows = 64, .tile_columns = 2, .tile_rows = 2};
  params.paths = 1;
  params.field_of_view = 0.3_deg;
  const Sources sources = trace(scene, tiled_panel, green_light, params);
  ASSERT_GT(sources.waves.size(), 40u);
  EXPECT_EQ(std::count(sources.tiles.values.begin(), sources.tiles.values.end(), 0.0F), 0);
}

/// A card at z = −50 mm covers x > 50 µm. It hides a spot and a point at z = −0.2 m from the right part of the panel.
Scene make_half_hidden_scene() {
  Scene scene;
  scene.materials = {grey(0, 1), grey(0)};
  scene.meshes = {make_test_quad({0, 0, -0.2}, {20_um, 0, 0}, {0, 20_um, 0}, 0),
                  make_test_quad({5.05_mm, 0, -0.05}, {5_mm, 0, 0}, {0, 5_mm, 0}, 1)};
  scene.points = {{{0, 10_um, -0.199}, 1.0f, 0}};
  return scene;
}

TEST(TiledStrategy, ACardHidesWhatIsBehindItFromTheTilesThatItCovers) {
  // The line from (x, y) on the panel to the axis at −0.2 m passes z = −0.05 at 3x/4: hidden for x > 67 µm.
  TraceParams params{.strategy = Strategy::tiled,
                     .columns = 1,
                     .rows = 1,
                     .tile_columns = 8,
                     .tile_rows = 4,
                     .paths = 1,
                     .max_depth = 1};
  const Sources tiled = trace(make_half_hidden_scene(), tiled_panel, green_light, params);
  ASSERT_EQ(tiled.waves.size(), 2u);  // the point and the spot
  for (int t = 0; t < 32; ++t) {
    const bool is_hidden = tile_centre(params, t).x > 67_um;
    for (size_t i = 0; i < 2; ++i) {
      const float amplitude = tiled.tiles.values[size_t(t) * 2 + i];
      EXPECT_EQ(amplitude, is_hidden ? 0 : tiled.waves[i].amplitude) << t;
    }
  }
}

TEST(TiledStrategy, RandomRaysBringHiddenWavesTheirPowerToTheTilesThatSeeThem) {
  // A black card hides a bright wall behind it from part of the panel. E of a pixel is that of the visible part of the
  // wall: summed over the waves tile by tile, and computed from the solid angle by rays of a separate raster.
  Scene scene;
  scene.materials = {grey(0, 1), grey(0)};
  scene.meshes = {make_wall(-20_mm, 50_mm, 50_mm),
                  make_test_quad({0.5_mm, 0, -10_mm}, {0.5_mm, 0, 0}, {0, 0.6_mm, 0}, 1)};
  const TraceParams params{.strategy = Strategy::tiled,
                           .pattern = Pattern::random,
                           .samples = 20000,
                           .tile_columns = 16,
                           .tile_rows = 12,
                           .paths = 1,
                           .max_depth = 1};
  const Sources sources = trace(scene, tiled_panel, green_light, params);
  const double tangent = acceptance_tangent(green_light, tiled_panel.pitch);
  double total = 0, total_expected = 0, worst = 0;
  for (int t = 0; t < 192; ++t) {
    const Vec3 centre = tile_centre(params, t);
    double irradiance = 0;
    for (size_t i = 0; i < sources.waves.size(); ++i) {
      const Vec3 o = sources.waves[i].origin;
      const double reach = box_radius(-o.z, green_light, tiled_panel.pitch);
      if (std::abs(o.x - centre.x) > reach || std::abs(o.y - centre.y) > reach) continue;
      const double a = sources.tiles.values[size_t(t) * sources.waves.size() + i];
      irradiance += a * a * o.z * o.z / dot(o - centre, o - centre);
    }
    // The part of the cone's tangents that the card does not cover.
    const double x0 = std::max(-tangent, (0 - centre.x) / 10_mm), x1 = std::min(tangent, (1_mm - centre.x) / 10_mm);
    const double y0 = std::max(-tangent, (-0.6_mm - centre.y) / 10_mm),
                 y1 = std::min(tangent, (0.6_mm - centre.y) / 10_mm);
    const double covered = x1 > x0 && y1 > y0 ? (x1 - x0) * (y1 - y0) : 0;
    const double expected = 4 * tangent * tangent - covered;
    total += irradiance;
    total_expected += expected;
    worst = std::max(worst, std::abs(irradiance - expected) / (4 * tangent * tangent));
  }
  // 15000 waves: 1 % for the whole panel. A tile sees about a third of them: 5 standard errors of √(1/5000), and the
  // effect of tiles at the card's edge, 128 µm in 700.
  EXPECT_NEAR(total / total_expected, 1, 0.01);
  EXPECT_LT(worst, 5 * std::sqrt(1.0 / 5000) + 0.05);
}

/// The point of a sphere at which light from `light` is reflected to `eye`: the normal bisects the two directions.
Vec3 highlight(Vec3 centre, double radius, Vec3 light, Vec3 eye) {
  Vec3 point = centre + Vec3{0, 0, radius};
  for (int i = 0; i < 100; ++i) point = centre + normalize(normalize(light - point) + normalize(eye - point)) * radius;
  return point;
}

TEST(TiledStrategy, AHighlightMovesAcrossTheTiles) {
  const Vec3 centre{0, 0, -65_mm}, light{0, 30_mm, -30_mm};
  const double radius = 5_mm;
  Scene scene;
  scene.materials = {MetallicRoughnessMaterial{.base_color = {0.9, 0.9, 0.9}, .metallic = 1, .roughness = 0.15}};
  Mesh sphere = make_round_mesh(centre, radius, 128);
  for (const Vec3 p : sphere.positions) sphere.normals.push_back(normalize(p - centre));
  scene.meshes = {sphere};
  scene.lights = {PointLight{light, {1, 1, 1}}};
  const TraceParams params{.strategy = Strategy::tiled,
                           .columns = 160,
                           .rows = 160,
                           .tile_columns = 2,
                           .tile_rows = 1,
                           .field_of_view = 5_deg,
                           .paths = 1,
                           .max_depth = 1};
  const Sources sources = trace(scene, tiled_panel, green_light, params);
  const auto centroid = [&](int tile) {
    Vec3 sum;
    double weight = 0;
    for (size_t i = 0; i < sources.waves.size(); ++i) {
      const double a = sources.tiles.values[size_t(tile) * sources.waves.size() + i];
      sum += sources.waves[i].origin * (a * a);
      weight += a * a;
    }
    return sum / weight;
  };
  const double moved = centroid(1).x - centroid(0).x;
  const double expected = highlight(centre, radius, light, tile_centre(params, 1)).x -
                          highlight(centre, radius, light, tile_centre(params, 0)).x;
  EXPECT_GT(expected, 30_um);
  // The tails of the lobe extend farther where the sphere turns away, so its centroid is ahead of its peak by some %.
  EXPECT_NEAR(moved / expected, 1, 0.1);
}

TEST(TiledStrategy, ABallInAMirrorIsSeenByTheTilesWhoseWayOverTheMirrorIsOpen) {
  // A mirror at 45° shows a spot at x = −50 mm; a card between mirror and spot covers z > −0.2 + 50 µm there. The
  // image is at z = −0.25, that of the card at z = −0.225, above x = 50 µm. From x_t the line passes it at 0.1·x_t.
  Scene scene;
  scene.materials = {grey(0, 1), ConductorMaterial{}, grey(0)};
  scene.meshes = {make_test_quad({-50_mm, 0, -0.2}, {0, 0, 20_um}, {0, 20_um, 0}, 0),
                  make_test_quad({0, 0, -0.2}, {15_mm, 0, 15_mm}, {0, 20_mm, 0}, 1),
                  make_test_quad({-25_mm, 0, -0.2 + 5.05_mm}, {0, 0, 5_mm}, {0, 5_mm, 0}, 2)};
  const TraceParams params{.strategy = Strategy::tiled,
                           .columns = 1,
                           .rows = 1,
                           .tile_columns = 8,
                           .tile_rows = 1,
                           .paths = 1,
                           .phase = SourcePhase::path};
  const Sources tiled = trace(scene, tiled_panel, green_light, params);
  ASSERT_EQ(tiled.waves.size(), 1u);
  EXPECT_NEAR(tiled.waves[0].origin.z, -0.25, 1e-9);
  int seen = 0;
  for (int t = 0; t < 8; ++t) {
    // The mirror maps z = x_m to x: the card's image covers x_image = z_card + 0.2 > 50 µm at depth 0.225.
    const bool is_hidden = 0.1 * tile_centre(params, t).x > 50_um;
    EXPECT_EQ(tiled.tiles.values[size_t(t)] == 0, is_hidden) << t;
    seen += !is_hidden;
  }
  EXPECT_GT(seen, 4);
  EXPECT_LT(seen, 8);
}

/// The tiles that see the brightest wave, from left to right.
std::string tiles_that_see(const Sources& sources) {
  const auto is_darker = [](const Source& a, const Source& b) { return a.amplitude < b.amplitude; };
  const auto brightest = std::max_element(sources.waves.begin(), sources.waves.end(), is_darker);
  const size_t wave = size_t(brightest - sources.waves.begin()), count = sources.waves.size();
  std::string seen;
  for (size_t t = 0; t * count < sources.tiles.values.size(); ++t)
    seen += sources.tiles.values[t * count + wave] > 0 ? '+' : '-';
  return seen;
}

TEST(TiledStrategy, GlassAndMirrorsHideNothingOfWhatACardCloseToAWallCovers) {
  // A card 2.5 mm in front of a spot at z = −0.3 covers x > 4 µm: the line from (x, 0) passes it at x/120, hidden for
  // x > 0.48 mm, the right two of 8 tiles. Behind 10 mm of glass the spot appears 3.3 mm nearer: x > 0.475 mm.
  const TraceParams params{.strategy = Strategy::tiled,
                           .columns = 1,
                           .rows = 1,
                           .tile_columns = 8,
                           .tile_rows = 1,
                           .paths = 1,
                           .phase = SourcePhase::path};
  Scene open;
  open.materials = {grey(0, 1), grey(0), DielectricMaterial{.is_thin = true}, DielectricMaterial{},
                    ConductorMaterial{}};
  open.meshes = {make_test_quad({0, 0, -0.3}, {20_um, 0, 0}, {0, 20_um, 0}, 0),
                 make_test_quad({5.004_mm, 0, -0.2975}, {5_mm, 0, 0}, {0, 5_mm, 0}, 1)};
  Scene pane = open;
  pane.meshes.push_back(make_wall(-0.25, 10_mm, 10_mm, 2));
  EXPECT_EQ(tiles_that_see(trace(pane, tiled_panel, green_light, params)), "++++++--");

  Scene slab = open;
  slab.meshes.push_back(make_wall(-0.245, 10_mm, 10_mm, 3));
  slab.meshes.push_back(make_test_quad({0, 0, -0.255}, {0, 10_mm, 0}, {10_mm, 0, 0}, 3));
  EXPECT_EQ(tiles_that_see(trace(slab, tiled_panel, green_light, params)), "++++++--");

  // A mirror at 45° at z = −0.25 shows the spot at x = −50 mm; z = x mirrors the card's edge to z = −0.25 + 4 µm.
  Scene mirror = open;
  mirror.meshes = {make_test_quad({-50_mm, 0, -0.25}, {0, 0, 20_um}, {0, 20_um, 0}, 0),
                   make_test_quad({-47.5_mm, 0, -0.25 + 5.004_mm}, {0, 0, 5_mm}, {0, 5_mm, 0}, 1),
                   make_test_quad({0, 0, -0.25}, {10_mm, 0, 10_mm}, {0, 10_mm, 0}, 4)};
  EXPECT_EQ(tiles_that_see(trace(mirror, tiled_panel, green_light, params)), "++++++--");
}

TEST(TiledStrategy, ACurvedMirrorShowsAWallToAllTiles) {
  // A chrome ball shows the wall behind the panel. Its image moves only slightly.
  Scene scene;
  scene.materials = {grey(0, 1), ConductorMaterial{}};
  Mesh ball = make_round_mesh({0, 0, -0.1}, 5_mm, 128);
  for (const Vec3 p : ball.positions) ball.normals.push_back(normalize(p - Vec3{0, 0, -0.1}));
  ball.material = 1;
  scene.meshes = {make_test_quad({0, 0, 0.2}, {-1, 0, 0}, {0, 1, 0.3}), ball};
  const TraceParams params{.strategy = Strategy::tiled,
                           .columns = 12,
                           .rows = 12,
                           .tile_columns = 4,
                           .tile_rows = 3,
                           .field_of_view = 1_deg,
                           .paths = 1,
                           .phase = SourcePhase::path};
  const Sources tiled = trace(scene, tiled_panel, green_light, params);
  EXPECT_GT(tiled.waves.size(), 100u);
  for (const float amplitude : tiled.tiles.values) EXPECT_GT(amplitude, 0);
}

TEST(TiledStrategy, TheSameSourcesComeFromAnyNumberOfThreads) {
  const TraceParams params{.strategy = Strategy::tiled,
                           .pattern = Pattern::random,
                           .samples = 3000,
                           .tile_columns = 4,
                           .tile_rows = 3,
                           .paths = 2};
  Scene scene = make_half_hidden_scene();
  scene.meshes.push_back(make_wall(-0.25, 20_mm, 20_mm, 0));
  std::vector<Sources> results;
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(trace(scene, tiled_panel, green_light, params));
  }
  EXPECT_GT(results[0].waves.size(), 100u);
  for (const size_t i : {1, 2}) {
    EXPECT_EQ(results[0].waves, results[i].waves);
    EXPECT_EQ(results[0].tiles, results[i].tiles);
    EXPECT_EQ(results[0].phase_keys, results[i].phase_keys);
  }
}

// A card 140 mm before a mirror of f = 100 mm at z = −220 mm has its real image at +130 mm. Rays of slope 0.0133 along x pass it, and
// meet it on their way back; those of 0.0067 pass it, too. Every tile sees that image.
TEST(TiledStrategy, ARealImageInFrontIsSeenByAllTiles) {
  Scene scene;
  scene.materials = {grey(0.5, 1), ConductorMaterial{}};
  std::vector<Vec2> profile;
  for (int k = 0; k <= 60; ++k) profile.push_back({0.2 * std::sin(0.005 * k), 0.2 * std::cos(0.005 * k)});
  profile.front().x = 0;
  Mesh bowl = make_lathe(profile, 128);
  transform_mesh({{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, 0, -20_mm}}, bowl);
  bowl.material = 1;
  scene.meshes = {bowl, make_test_quad({0.725_mm, 0, -80_mm}, {0.175_mm, 0, 0}, {0, 8_mm, 0})};
  TraceParams params{.columns = 9, .rows = 9, .field_of_view = 0.03, .paths = 1, .phase = SourcePhase::path};
  params.tile_columns = params.tile_rows = 2;
  params.strategy = Strategy::tiled;
  const Sources sources = trace(scene, tiled_panel, green_light, params);
  const size_t count = sources.waves.size();
  ASSERT_EQ(count, 9u);
  for (size_t i = 0; i < count; ++i) {
    EXPECT_NEAR(sources.waves[i].origin.z, 130_mm, 5_mm);  // facets of 1 mm, spherical aberration at 3 mm from the axis
    for (size_t t = 0; t < 4; ++t) EXPECT_GT(sources.tiles.values[t * count + i], 0) << i << ", " << t;
  }
}

// What is before the panel, and beside all rays, changes no wave behind it.
TEST(TiledStrategy, SurfacesInFrontLeaveMirrorImagesWhereTheyAre) {
  Scene scene;
  scene.materials = {grey(0.5, 1), ConductorMaterial{}};
  scene.meshes = {make_test_quad({-60_mm, 0, -0.2}, {0, 0, 40_mm}, {0, 40_mm, 0}, 0),
                  make_test_quad({0, 0, -0.2}, {15_mm, 0, 15_mm}, {0, 20_mm, 0}, 1)};
  TraceParams params{
      .columns = 5, .rows = 5, .tile_columns = 2, .tile_rows = 2, .paths = 1, .phase = SourcePhase::path};
  for (const Strategy strategy : {Strategy::shared, Strategy::tiled}) {
    params.strategy = strategy;
    const Sources without = trace(scene, tiled_panel, green_light, params);
    Scene more = scene;
    more.meshes.push_back(make_test_quad({0.2, 0, 40_mm}, {1_mm, 0, 0}, {0, 1_mm, 0}, 0));
    const Sources with = trace(more, tiled_panel, green_light, params);
    ASSERT_EQ(with.waves.size(), without.waves.size());
    ASSERT_GT(with.waves.size(), 10u);
    for (size_t i = 0; i < with.waves.size(); ++i) {
      EXPECT_LT(length(with.waves[i].origin - without.waves[i].origin), 1e-8);  // differences at 0.3 m, 1e-8 of it
      const double turn = double(with.waves[i].phase) - without.waves[i].phase;
      EXPECT_NEAR(std::cos(turn), 1, 2e-2) << "3e-9 m of its distance are 0.04 rad";
    }
  }
}

TEST(TiledStrategy, TilesThatThePanelCannotHoldAreErrors) {
  const auto sentence = [](int columns, int rows) {
    return error_of([&] {
      trace(make_half_hidden_scene(), tiled_panel, green_light,
            {.strategy = Strategy::tiled, .tile_columns = columns, .tile_rows = rows});
    });
  };
  EXPECT_EQ(sentence(0, 4), "expected a whole number of 1 or more for \"tile_columns\", got 0");
  EXPECT_EQ(sentence(8, 193),
            "expected 1 to 256 tile_columns and 1 to 192 tile_rows on a panel of that many pixels, got 8 and 193");
}

}  // namespace
}  // namespace holotrace
