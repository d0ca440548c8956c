#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/trace/geometry/media.h"
#include "holotrace/trace/materials/scattering_bsdf.h"
#include "holotrace/trace/paths/specular.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/trace.h"
#include "trace/follow.h"
#include "trace/scenes.h"

// Light of media by mirrors, through grids of hard contrasts, in narrow peaks, and from infinity, against closed forms.

namespace holotrace {
namespace {

/// Fills all space behind the panel, or a box.
Medium& add_fog(Scene& scene, Vec3 extinction, const ScatteringMaterial& particles, std::optional<MediumBox> box = {}) {
  scene.materials.emplace_back(particles);
  return scene.media.emplace_back(Medium{.name = "fog",
                                         .extinction = extinction,
                                         .material = int(scene.materials.size()) - 1,
                                         .is_open = true,
                                         .box = box});
}

Vec3 share_after(Vec3 extinction, double distance) {
  return {std::exp(-extinction.x * distance), std::exp(-extinction.y * distance), std::exp(-extinction.z * distance)};
}

void expect_same(Vec3 value, Vec3 expected, double relative) {
  EXPECT_NEAR(value.x, expected.x, relative * expected.x);
  EXPECT_NEAR(value.y, expected.y, relative * expected.y);
  EXPECT_NEAR(value.z, expected.z, relative * expected.z);
}

constexpr Vec3 colours_of_fog{1, 3, 8};  // [1/m]

// A mirror at 45° shows a lamp that is not met by rays: fog dims it on its 0.3 m + 0.1 m, not by what lies behind it. Nothing is
// drawn; rays begin some 0.1 um off the mirror.
TEST(MediaLight, ALampInAMirrorIsDimmedByTheFogBeforeIt) {
  const auto light_of_lamp = [](bool has_fog, bool has_wall) {
    Scene scene;
    scene.materials = {ConductorMaterial{}, grey(0)};
    scene.meshes = {make_test_quad({0, 0, -0.3}, {20_mm, 0, -20_mm}, {0, 20_mm, 0})};
    if (has_wall) scene.meshes.push_back(make_test_quad({0.5, 0, -0.3}, {0, 1, 0}, {0, 0, 1}, 1));
    scene.lights = {RectangleLight{{100_mm, -20_mm, -0.32}, {0, 0, 40_mm}, {0, 40_mm, 0}, {1, 1, 1}, false}};
    if (has_fog) add_fog(scene, colours_of_fog, {.albedo = {}});
    const PathScene path_scene(scene, Lines{}, {}, {.max_depth = 8});
    PathCounts counts;
    Vec3 sum;
    for (const SpecularLeaf& leaf : follow_specular(path_scene, {{}, {0, 0, -1}}, counts))
      if (leaf.kind == LeafKind::light) sum += leaf.weight;
    return sum;
  };
  for (const bool has_wall : {false, true}) {
    const Vec3 clear = light_of_lamp(false, has_wall);
    EXPECT_GT(clear.x, 0.5);
    expect_same(light_of_lamp(true, has_wall), clear * share_after(colours_of_fog, 0.4), 1e-6);
  }
}

// A wall at z = −0.3 m, and a mirror in the plane x = −20 mm that shows it a point light. Both parts of the way are dimmed, together as
// long as the way to the image of the lamp.
TEST(MediaLight, FogDimsBothPartsOfAWayByAMirror) {
  const auto light_of_wall = [](bool has_fog) {
    Scene scene;
    scene.materials = {grey(0.6), ConductorMaterial{}};
    scene.meshes = {make_wall(-0.3, 15_mm, 15_mm), make_test_quad({-20_mm, 0, -0.2}, {0, 90_mm, 0}, {0, 0, 95_mm}, 1)};
    scene.lights = {PointLight{{30_mm, 5_mm, -0.2}, {1, 1, 1}}};
    if (has_fog) add_fog(scene, colours_of_fog, {.albedo = {}});
    const PathScene path_scene(scene, Lines{}, {"EDSL"}, {.max_depth = 2});
    std::vector<Vec3> sums(size_t(path_scene.sums()));
    PathCounts counts;
    const auto wall = path_scene.accelerator.closest_hit({{}, {0, 0, -1}}, Aim::exact, {.has_media = false});
    mean_radiance(path_scene, {wall.value().point, {0, 0, 1}, path_scene.automaton.start(), 1}, 20, 0, sums, counts);
    return sums.back();
  };
  const Vec3 image{-70_mm, 5_mm, -0.2}, clear = light_of_wall(false);
  EXPECT_GT(clear.x, 0);
  // Rays begin some 0.1 um off the wall and the mirror.
  expect_same(light_of_wall(true), clear * share_after(colours_of_fog, length(image - Vec3{0, 0, -0.3})), 1e-5);
}

/// A cube of 0.1 m behind the panel with a grid of densities.
struct GridScene {
  Scene scene;
  static constexpr int cells = 16;

  template <class Density>
  GridScene(double extinction, const Density& density) {
    Medium& fog =
        add_fog(scene, Vec3{1, 1, 1} * extinction, {.albedo = {}}, MediumBox{{-0.05, -0.05, -0.3}, {0.05, 0.05, -0.2}});
    Image grid(cells * cells, cells, 1);
    for (int k = 0; k < cells; ++k)
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) grid(cells * k + j, i) = density(i, j, k);
    fog.density = {std::make_shared<Image>(std::move(grid)), cells};
  }
};

// Beside one cell that is as thick as any may be, there are steps to no particle, but a bounded number. Interpolation ends one cell
// away. Through that cell nothing comes.
TEST(MediaLight, AThickCellOfAGridIsOpaqueAndTheOthersClear) {
  const double width = 0.1 / GridScene::cells;
  const GridScene grid(1,
                       [&](int i, int j, int k) { return i == 8 && j == 8 && k == 8 ? float(0.999e4 / width) : 0.0F; });
  const Accelerator accelerator(grid.scene);
  const auto passing = [&](double x) { return accelerator.transmittance({{x, width / 2, 0}, {0, 0, -1}}, 1).x; };
  for (int i = 0; i < GridScene::cells; ++i) EXPECT_EQ(passing((i + 0.5) * width - 0.05), i == 8 ? 0 : 1) << i;
}

// The largest number of single precision as the density, of particles so few that 2 mean free paths lie in the box: majorants stay
// finite. Each ray passes (1) or not: 4·√(T(1 − T)/n) for n = 20,000.
TEST(MediaLight, DensitiesMayBeAsLargeAsTheirNumbers) {
  constexpr float largest = std::numeric_limits<float>::max();
  const GridScene grid(20 / double(largest), [](int, int, int) { return largest; });
  const Accelerator accelerator(grid.scene);
  Statistics passing;
  for (int i = 0; i < 20'000; ++i)
    passing.add(accelerator.transmittance({{(i / 20'000.0 - 0.5) * 0.09, 0.01, 0}, {0, 0, -1}}, 1).x);
  EXPECT_NEAR(passing.mean(), std::exp(-2.0), 0.01);
}

// On one ray, the mean over seeds is what passes: densities rise along x and y, so their mean on the ray is that at the cell's middle.
// Ratio tracking varies by less than real flights: 4·√(T(1 − T)/n) for n = 10,000 is 0.018.
TEST(MediaLight, ParticlesDifferFromSeedToSeed) {
  const GridScene grid(1, [](int i, int j, int) { return 0.5F * float(i) + 0.25F * float(j); });
  const double width = 0.1 / GridScene::cells;
  const Ray ray{{4.5 * width - 0.05, 8.5 * width - 0.05, 0}, {0, 0, -1}};
  Statistics passing;
  for (uint64_t seed = 0; seed < 10'000; ++seed) passing.add(Media(grid.scene, {}, seed).transmittance(ray, 1).x);
  EXPECT_NEAR(passing.mean(), std::exp(-0.1 * (0.5 * 4 + 0.25 * 8)), 0.018);
}

// The seed of a tracing reaches them.
TEST(MediaLight, WavesThroughAGridDifferFromSeedToSeed) {
  GridScene grid(10, [](int i, int j, int k) { return float(i + j + k) / 8; });
  grid.scene.materials.push_back(grey(0, 1));
  grid.scene.meshes = {make_wall(-0.4, 50_mm, 50_mm, int(grid.scene.materials.size()) - 1)};
  const auto first_amplitude = [&](int64_t seed) {
    TraceParams params{.columns = 2, .rows = 2, .paths = 1};
    params.seed = seed;
    return trace(grid.scene, Grid{64, 64, 8e-6}, green_light, params).waves.at(0).amplitude;
  };
  EXPECT_EQ(first_amplitude(1), first_amplitude(1));
  EXPECT_NE(first_amplitude(1), first_amplitude(2));
}

// The peak of the phase function, (1 + |g|)/(4π·(1 − |g|)²), and its other end, up to a few roundings of 1 − |g|, which is exact.
TEST(MediaLight, PhaseFunctionsHavePrecisePeaks) {
  for (const double g : {0.5, 0.9, 0.999, -0.5, -0.999}) {
    const double size = std::abs(g), ahead = g > 0 ? 1 : -1;
    const double peak = (1 + size) / (4 * pi * (1 - size) * (1 - size)),
                 back = (1 - size) / (4 * pi * (1 + size) * (1 + size));
    EXPECT_NEAR(phase_function(g, ahead) / peak, 1, 1e-14) << g;
    EXPECT_NEAR(phase_function(g, -ahead) / back, 1, 1e-14) << g;
    EXPECT_TRUE(std::isfinite(phase_function(g, ahead * (1 + 1e-15)))) << g;  // a cosine may be above 1 by rounding
  }
}

// Light along the axis does not come through a medium without end, and the warning says so. From the viewer's side it does: so far into
// black fog as a wall at 0.1 m, which it reaches and leaves dimmed by exp(−2·σ·0.1 m).
TEST(MediaLight, LightFromInfinityComesOnlyFromTheViewersSide) {
  const auto picture = [](double direction, double extinction, Record& record) {
    Scene scene;
    scene.materials = {DiffuseMaterial{.reflectance = {0.5, 0.5, 0.5}, .transmittance = {0.3, 0.3, 0.3}}};
    scene.meshes = {make_wall(-0.1, 50_mm, 50_mm)};
    scene.lights = {DirectionalLight{{0, 0, direction}, {pi, pi, pi}}};
    add_fog(scene, Vec3{1, 1, 1} * extinction, {.albedo = {}});
    RenderParams params{.columns = 8, .rows = 8, .paths = 256};
    params.field_of_view = 0.01;
    return render(scene, Grid{64, 64, 8e-6}, green_light, params, record.observer);
  };
  Record behind;
  const Image dark = picture(1, 4, behind);
  EXPECT_EQ(*std::max_element(dark.values.begin(), dark.values.end()), 0);
  ASSERT_EQ(behind.warnings.size(), 1U);
  EXPECT_NE(behind.warnings[0].find(
                "the medium \"fog\" has no end behind the panel, so light from infinitely far away reaches "
                "nothing there, unless it comes from the viewer's side; give the medium a box"),
            std::string::npos)
      << behind.warnings[0];
  Record front;
  const Image lit = picture(-1, 4, front);
  double sum = 0;
  for (const float value : lit.values) sum += double(value);
  // Paths fly through with T = exp(−0.4) = 0.67: 4·√((1 − T)/T/n) = 0.022 of the mean for n = 64·256.
  EXPECT_NEAR(sum / double(lit.values.size()) / (0.5 * std::exp(-0.8)), 1, 0.022);
  EXPECT_TRUE(front.warnings.empty());
}

}  // namespace
}  // namespace holotrace
