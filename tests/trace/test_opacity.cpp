#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/trace/render.h"
#include "holotrace/trace/shade_triangles.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

// Surfaces that let rays through, against closed forms.

namespace holotrace {
namespace {

const Grid opacity_panel{64, 64, 8e-6};

Material sheet_of(double opacity, double emission = 0) {
  Material material = grey(0, emission);
  material.opacity = opacity;
  return material;
}

double mean_of(const Image& image) {
  double sum = 0;
  for (const float value : image.values) sum += double(value);
  return sum / double(image.values.size());
}

// Light goes through a black sheet to a wall and back: (ρ/π)·E·(1 − o)². Each path has that light or none, with p = 0.36: 4·√(p(1 − p)/n)
// of 100 pixels with 400 paths each are 1 % of ρE/π.
TEST(Opacity, ASheetDimsWhatIsBehindItTwice) {
  Scene scene;
  scene.materials = {grey(0.5), sheet_of(0.4)};
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm), make_wall(-0.2, 50_mm, 50_mm, 1)};
  scene.lights = {DirectionalLight{{0, 0, -1}, {2, 2, 2}}};
  for (const Acceleration kind : {Acceleration::embree, Acceleration::grid}) {
    RenderParams params{.columns = 10, .rows = 10, .paths = 400};
    params.accelerator = kind;
    const double whole = 0.5 / pi * 2;
    EXPECT_NEAR(mean_of(render(scene, opacity_panel, green_light, params)), 0.36 * whole, 0.01 * whole);
  }
}

// A lamp of opacity o shines o times as brightly: on what it lights, whether paths meet it or send shadow rays, and in the view.
TEST(Opacity, ALampShinesAsMuchAsItIsThere) {
  const auto seen = [](const Material& lamp) {
    Scene scene;
    scene.materials = {grey(0.8), lamp};
    scene.meshes = {make_wall(-0.3, 12_mm, 12_mm), make_test_quad({0, 9_mm, -0.29}, {12_mm, 0, 0}, {0, 0, 9_mm}, 1)};
    return mean_of(render(scene, opacity_panel, green_light, {.columns = 16, .rows = 16, .paths = 1024}));
  };
  const double whole = seen(sheet_of(1, 0.3));
  EXPECT_GT(whole, 0.01);
  EXPECT_NEAR(seen(sheet_of(0.3, 1)), whole, 0.02 * whole);  // the noise of both, measured: 0.3 % each
}

// Each ray of the raster meets the sheet or the wall behind it: a wave begins there.
TEST(Opacity, WavesBeginOnTheSheetAndBehindIt) {
  Scene scene;
  scene.materials = {grey(0, 1), sheet_of(0.3, 1)};
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm), make_wall(-0.2, 50_mm, 50_mm, 1)};
  const Sources sources = trace(scene, opacity_panel, green_light, {.columns = 100, .rows = 100, .paths = 1});
  const double rays = 1e4;
  ASSERT_EQ(double(sources.waves.size()), rays);
  double on_sheet = 0;
  for (const Source& wave : sources.waves) {
    EXPECT_TRUE(std::abs(wave.origin.z + 0.2) < 1e-9 || std::abs(wave.origin.z + 0.3) < 1e-9);
    on_sheet += wave.origin.z > -0.25;
  }
  EXPECT_NEAR(on_sheet, 0.3 * rays, 4 * std::sqrt(0.21 * rays));
}

// A veil is drawn once for each wave, by all strategies alike: the light of a wall behind it is 1 − o of the wall's. Tiles see it by
// rays of their own.
TEST(Opacity, TilesDrawAVeilOnce) {
  const auto power_of = [](double opacity) {
    Scene scene;
    scene.materials = {grey(0, 1), sheet_of(opacity)};
    scene.meshes = {make_wall(-0.3, 50_mm, 50_mm), make_wall(-0.2, 50_mm, 50_mm, 1)};
    TraceParams params{
        .strategy = Strategy::tiled, .columns = 60, .rows = 60, .tile_columns = 2, .tile_rows = 2, .paths = 1};
    const Sources sources = trace(scene, opacity_panel, green_light, params);
    double power = 0;
    for (const float amplitude : sources.tiles.values) power += double(amplitude) * double(amplitude);
    return power;
  };
  // 4·√(o(1 − o)/n) of n = 3600 waves.
  const double whole = power_of(0);
  EXPECT_NEAR(power_of(0.5) / whole, 0.5, 0.034);
  EXPECT_NEAR(power_of(0.9) / whole, 0.1, 0.02);
}

// A mirror of opacity o before nothing shows o of its image, in tiles as well.
TEST(Opacity, TilesMeetAVeilThatIsAMirror) {
  const auto power_of = [](double opacity) {
    Scene scene;
    Material mirror = ConductorMaterial{.index = constant_index(1e-6)};
    mirror.opacity = opacity;
    scene.materials = {grey(0, 1), mirror};
    const double half = 50_mm / std::sqrt(2.0);  // at 45°: it shows the wall beside it
    scene.meshes = {make_test_quad({0.1, 0, -0.2}, {0, 0, 50_mm}, {0, 50_mm, 0}),
                    make_test_quad({0, 0, -0.2}, {half, 0, -half}, {0, 50_mm, 0}, 1)};
    TraceParams params{
        .strategy = Strategy::tiled, .columns = 60, .rows = 60, .tile_columns = 2, .tile_rows = 2, .paths = 1};
    params.phase = SourcePhase::path;
    const Sources sources = trace(scene, opacity_panel, green_light, params);
    double power = 0;
    for (const float amplitude : sources.tiles.values) power += double(amplitude) * double(amplitude);
    return power;
  };
  const double whole = power_of(1);
  EXPECT_GT(whole, 0);
  EXPECT_NEAR(power_of(0.5) / whole, 0.5, 0.034);
}

// By the method triangles a triangle shines by the part of its opacity, and is hidden, or not, by the veils before it.
TEST(Opacity, TrianglesShineByTheirOpacity) {
  const auto power_of = [](double opacity, double of_veil) {
    Scene scene;
    scene.materials = {sheet_of(opacity, 1), sheet_of(of_veil)};
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 20; ++i)
        scene.meshes.push_back(
            make_test_quad({(i - 9.5) * 0.1_mm, (j - 9.5) * 0.1_mm, -0.3}, {0.04_mm, 0, 0}, {0, 0.04_mm, 0}));
    if (of_veil > 0) scene.meshes.push_back(make_wall(-0.2, 50_mm, 50_mm, 1));
    double power = 0;
    for (const Triangles& set :
         shade_triangles(scene, opacity_panel, {green_light}, {.paths = 1}, Shading::flat, TrianglePhase::random))
      for (const Triangle& triangle : set.triangles)
        power += double(triangle.amplitudes[0]) * double(triangle.amplitudes[0]);
    return power;
  };
  const double whole = power_of(1, 0);
  EXPECT_NEAR(power_of(0.3, 0) / whole, 0.3, 1e-6);
  EXPECT_NEAR(power_of(1, 0.5) / whole, 0.5, 0.07);  // 4·√(o(1 − o)/n) of n = 800 triangles
}

TEST(Opacity, NumbersBeyondARangeAreRefused) {
  for (const double bad : {-0.1, 1.1, std::nan("")}) {
    Scene scene = make_bright_wall();
    scene.materials[0].opacity = bad;
    EXPECT_NE(error_of([&] {
                render(scene, opacity_panel, green_light, {.rows = 2, .paths = 1});
              }).find("expected a share of opacity from 0 to 1 in material 0"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace holotrace
