#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "holotrace/trace/focal_stack.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/trace.h"
#include "trace/follow.h"
#include "trace/scenes.h"

// Light with polarization in pictures, stacks and waves, against closed forms.

namespace holotrace {
namespace {

const Grid polarized_panel{64, 64, 8e-6};

Material filter(double degrees, double leakage = 0, double delay = 0) {
  const double a = degrees * pi / 180;
  return FilterMaterial{{std::cos(a), std::sin(a), 0}, 1, leakage, delay, 0};
}

double mean_of_polarized(const Image& image) {
  double sum = 0;
  for (const float value : image.values) sum += double(value);
  return sum / double(image.values.size());
}

RenderParams few_paths(int paths = 4) { return {.columns = 8, .rows = 8, .paths = paths}; }

/// A white sky behind sheets that fill the view.
Scene sheets(const std::vector<Material>& filters) {
  Scene scene;
  scene.background = {1, 1, 1};
  scene.materials = {grey(0)};
  scene.meshes = {make_wall(-0.9, 1e-6, 1e-6)};  // a scene has an object
  for (size_t i = 0; i < filters.size(); ++i) {
    scene.materials.push_back(filters[i]);
    scene.meshes.push_back(make_wall(-0.1 - 0.05 * double(i), 100_mm, 100_mm, int(i) + 1));
  }
  return scene;
}

constexpr double of_floats = 1e-6;  // pictures are floats, and rays are up to 2 degrees off the axis: 1 − cos² of φ⁴

TEST(PolarizedLight, SheetsInARowPassWhatMalusSays) {
  const auto seen = [](const std::vector<Material>& filters, std::optional<StokesVector> analyser = std::nullopt) {
    Scene scene = sheets(filters);
    scene.analyser = analyser;
    return mean_of_polarized(render(scene, polarized_panel, green_light, few_paths()));
  };
  EXPECT_NEAR(seen({filter(20)}), 0.5, of_floats);
  EXPECT_NEAR(seen({filter(20), filter(80)}), 0.125, 1e-5) << "cos²60°/2";
  EXPECT_NEAR(seen({filter(0), filter(90)}), 0, 1e-5) << "rays at 2° see crossed sheets slightly open: φ⁴/4";
  EXPECT_NEAR(seen({filter(0), filter(45), filter(90)}), 1.0 / 8, 1e-5);
  EXPECT_NEAR(seen({filter(0)}, linear_polariser(pi / 3)), 0.125, 1e-5);
  EXPECT_NEAR(seen({filter(45, 1, pi / 2), filter(0)}, left_polariser), 0.5, 1e-5);
  EXPECT_NEAR(seen({filter(45, 1, pi / 2), filter(0)}, right_polariser), 0, 1e-5);
  EXPECT_NEAR(seen({}, linear_polariser(0)), 0.5, of_floats);
}

/// Stokes parameters of a picture's middle pixel [W/m²/sr], in green.
std::array<double, 4> stokes_of(Scene scene, const RenderParams& params) {
  std::array<double, 4> found{};
  for (size_t i = 0; i < 4; ++i) {
    StokesVector row{};
    row[i] = 1;
    scene.analyser = row;
    const Image image = render(scene, polarized_panel, green_light, params);
    found[i] = double(image(image.ny / 2, image.nx / 2, 1));
  }
  return found;
}

/// A plate in the middle of the view, turned about the axis x so that the ray from the panel meets it at an angle [degrees], and a
/// bright wall that only its reflection shows.
Scene tilted_mirror(const Material& material, double degrees) {
  const double a = degrees * pi / 180;
  Scene scene;
  scene.materials = {material, grey(0, 1)};
  const Vec3 up{0, std::cos(a), -std::sin(a)};
  scene.meshes = {make_test_quad({0, 0, -0.3}, {20_mm, 0, 0}, up * 0.05)};
  const Vec3 on{0, std::sin(2 * a), std::cos(2 * a)};
  const Vec3 half = cross(on, Vec3{1, 0, 0});
  scene.meshes.push_back(make_test_quad(Vec3{0, 0, -0.3} + on * 0.2, {100_mm, 0, 0}, half * 0.1, 1));
  return scene;
}

TEST(PolarizedLight, WaterPolarisesWhatItReflectsAcrossThePlaneOfIncidence) {
  const double n = 1.33;
  for (double degrees : {30.0, 53.061, 75.0}) {
    const double in = degrees * pi / 180, on = std::asin(std::sin(in) / n);
    const double s = std::pow(std::sin(in - on) / std::sin(in + on), 2),
                 p = std::pow(std::tan(in - on) / std::tan(in + on), 2);
    RenderParams params = few_paths(256);
    params.field_of_view = 1e-3;
    const auto stokes = stokes_of(tilted_mirror(DielectricMaterial{constant_index(n)}, degrees), params);
    ASSERT_GT(stokes[0], 0);
    // The plane of incidence is that of y and z, so s is along x. The pixel spans 1e-3/4 rad: d changes by less than 1e-3.
    EXPECT_NEAR(stokes[1] / stokes[0], (s - p) / (s + p), 1e-3) << degrees;
    EXPECT_NEAR(stokes[2] / stokes[0], 0, 1e-3);
    EXPECT_NEAR(stokes[3] / stokes[0], 0, 1e-9);
  }
}

TEST(PolarizedLight, DiffuseSurfacesHaveNone) {
  Scene scene = make_corner();
  const auto stokes = stokes_of(scene, few_paths(16));
  EXPECT_GT(stokes[0], 0);
  for (size_t i = 1; i < 4; ++i) EXPECT_EQ(stokes[i], 0);
}

/// Surfaces of many kinds between lamps of all kinds.
Scene many_surfaces() {
  Scene scene = make_corner();
  PrincipledMaterial layers;
  layers.base_color.value = {0.6, 0.3, 0.2};
  layers.clearcoat.value = 1;
  layers.iridescence.value = 0.5;
  PrincipledMaterial sheet;
  sheet.is_thin = true;
  sheet.transmission.value = 0.9;
  sheet.roughness.value = 0;
  scene.materials.insert(
      scene.materials.end(),
      {Material(ConductorMaterial{metal_index("Au"), 0.3}), Material(layers),
       Material(DielectricMaterial{constant_index(1.5)}), Material(ConductorMaterial{}), Material(sheet), filter(30),
       filter(70, 1, 1.2), Material(DielectricMaterial{constant_index(1.5), 0.3})});
  const auto add = [&](Vec3 place, Vec3 half_u, Vec3 half_v, int material) {
    scene.meshes.push_back(make_test_quad(place, half_u, half_v, material));
  };
  add({-6_mm, 2_mm, -0.292}, {4_mm, 0, 2_mm}, {0, 4_mm, 1_mm}, 2);
  add({6_mm, 2_mm, -0.292}, {4_mm, 0, -3_mm}, {0, 4_mm, 1_mm}, 3);
  add({0, 6_mm, -0.29}, {4_mm, 0, 0}, {0, 1_mm, 4_mm}, 5);
  add({-4_mm, -2_mm, -0.28}, {4_mm, 0, 0}, {0, 4_mm, 1_mm}, 6);
  add({3_mm, -1_mm, -0.285}, {3_mm, 0, 1_mm}, {0, 5_mm, 0}, 7);
  add({1_mm, 0, -0.283}, {4_mm, 0, 0}, {0, 5_mm, 0}, 8);
  Mesh ball = make_round_mesh({0, -3_mm, -0.293}, 3e-3, 2);
  ball.material = 4;
  scene.meshes.push_back(ball);
  ball = make_round_mesh({8_mm, -3_mm, -0.293}, 3e-3, 2);
  ball.material = 9;
  scene.meshes.push_back(ball);
  scene.lights.emplace_back(PointLight{{-8_mm, 8_mm, -0.28}, {1e-3, 1e-3, 1e-3}});
  return scene;
}

TEST(PolarizedLight, EveryPathBringsPhysicalLight) {
  std::array<Scene, 4> scenes;
  std::vector<std::unique_ptr<PathScene>> prepared;
  for (size_t k = 0; k < 4; ++k) {
    StokesVector row{};
    row[k] = 1;
    scenes[k] = many_surfaces();
    scenes[k].analyser = row;
    prepared.push_back(
        std::make_unique<PathScene>(scenes[k], Lines{}, std::vector<std::string>{}, PathParams{.caustic_rays = 64}));
  }
  int polarised = 0;
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 24; ++i) {
      const Ray ray{{0, 0, 0}, normalize({(i - 11.5) * 1e-3, (j - 11.5) * 0.7e-3, -0.29})};
      std::array<double, 4> s{};
      for (size_t k = 0; k < 4; ++k) {
        LowDiscrepancy numbers(1, 0, uint64_t(j * 24 + i));
        numbers.start(0);
        Vec3 light;
        PathCounts counts;
        add_radiance(*prepared[k], ray, numbers, {&light, 1}, counts);
        s[k] = light.y;
      }
      const double polarization = std::sqrt(s[1] * s[1] + s[2] * s[2] + s[3] * s[3]);
      EXPECT_LE(polarization, s[0] * (1 + 1e-9)) << i << " " << j;
      polarised += polarization > 0.1 * s[0];
    }
  EXPECT_GT(polarised, 50) << "otherwise this would test nothing";
}

/// A rough metal that a lamp lights through a polariser, and by a mirror of glass.
Scene lit_by_mirror(const Light& lamp) {
  Scene scene;
  scene.materials = {ConductorMaterial{metal_index("Cr"), 0.5},
                     Material(DielectricMaterial{constant_index(1.5), 0, true}), filter(0)};
  scene.meshes = {make_test_quad({0, 0, -0.3}, {20_mm, 0, 0}, {0, 20_mm, 0}),
                  make_test_quad({0, -30_mm, -0.27}, {60_mm, 0, 0}, {0, 0, 60_mm}, 1),
                  make_test_quad({-25_mm, 10_mm, -0.27}, {0, 16_mm, 0}, {12_mm, 0, 10_mm}, 2)};
  scene.lights = {lamp};
  return scene;
}

// Point lamps are sampled by the mirror's image and through sheets; a rectangle as small is also met by paths, which find the same
// light by other code. The noise of the ratios is measured, 0.2 %.
TEST(PolarizedLight, SampledLampsAndLampsThatPathsMeetArriveWithTheSamePolarization) {
  const Vec3 place{-50_mm, 20_mm, -0.24};
  const double side = 4e-3, radiance = 100;
  const Vec3 way = normalize(Vec3{0, 0, -0.3} - place), u = normalize(cross(way, Vec3{0, 1, 0})) * side,
             v = normalize(cross(way, u)) * side;
  const Vec3 n = normalize(cross(u, v));
  const Vec3 edge_v = dot(n, way) > 0 ? v : -v;
  const RectangleLight rectangle{place - u / 2 - edge_v / 2, u, edge_v, Vec3{1, 1, 1} * radiance, false};
  const PointLight point{place, Vec3{1, 1, 1} * (radiance * side * side)};  // along its axis
  RenderParams params{.columns = 8, .rows = 8, .paths = 512};
  const auto mean_stokes = [&](const Light& lamp) {
    std::array<double, 4> found{};
    for (size_t i = 0; i < 4; ++i) {
      Scene scene = lit_by_mirror(lamp);
      StokesVector row{};
      row[i] = 1;
      scene.analyser = row;
      found[i] = mean_of_polarized(render(scene, polarized_panel, green_light, params));
    }
    return found;
  };
  const auto sampled = mean_stokes(point), met = mean_stokes(rectangle);
  EXPECT_GT(std::hypot(sampled[1], sampled[2]), 0.05 * sampled[0]) << "otherwise this would test nothing";
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(met[i] / met[0], sampled[i] / sampled[0], 0.02) << i;
  EXPECT_NEAR(met[0], sampled[0], 0.05 * sampled[0]) << "the lamp has a size, and radiates by its cosine";
}

TEST(PolarizedLight, AnalysersAtRightAnglesShowAllLightTogether) {
  Scene scene = many_surfaces();
  const auto seen = [&](std::optional<StokesVector> analyser) {
    scene.analyser = analyser;
    return render(scene, polarized_panel, green_light, few_paths());
  };
  const Image all = seen(all_light);
  for (double angle : {0.0, 0.7}) {
    const Image one = seen(linear_polariser(angle)), other = seen(linear_polariser(angle + pi / 2));
    for (size_t i = 0; i < all.values.size(); ++i)
      EXPECT_NEAR(one.values[i] + other.values[i], all.values[i], 1e-5F * (1 + all.values[i])) << "the same paths";
  }
}

// Unpolarised light that meets one surface on its way is as bright with polarization as without it. Both have noise of 1 % of the mean,
// measured, from other paths: groups of paths share their lamp samples.
TEST(PolarizedLight, OneReflectionOfUnpolarisedLightIsAsBrightAsEver) {
  Scene scene;
  PrincipledMaterial layers;
  layers.clearcoat.value = 0.5;
  layers.roughness.value = 0.5;
  scene.materials = {layers};
  scene.meshes = {make_wall(-0.3, 20_mm, 20_mm)};
  scene.background = {1, 1, 1};
  const double plain = mean_of_polarized(render(scene, polarized_panel, green_light, few_paths(256)));
  scene.analyser = all_light;
  EXPECT_NEAR(mean_of_polarized(render(scene, polarized_panel, green_light, few_paths(256))), plain, 0.02 * plain);
  EXPECT_GT(plain, 0.5);
}

/// An emitting wall behind a sheet.
Scene shining_sheet(double degrees) {
  Scene scene = make_bright_wall();
  scene.materials.push_back(filter(degrees));
  scene.meshes.push_back(make_wall(-0.2, 60_mm, 60_mm, 1));
  return scene;
}

TEST(PolarizedLight, StacksAndWavesShowWhatTheAnalyserLetsPass) {
  for (const double degrees : {0.0, 60.0, 90.0}) {
    Scene scene = shining_sheet(0);
    scene.analyser = linear_polariser(degrees * pi / 180);
    const double c = std::cos(degrees * pi / 180), passed = c * c / 2;
    RenderParams params{.paths = 4};
    const auto stack = trace_focal_stack(scene, polarized_panel, green_light, {0.3}, params);
    EXPECT_NEAR(mean_of_polarized(stack.pictures.front()), passed, 1e-4) << "rays of ±2°";
    // Waves that begin behind the sheet, and those that begin on it: their squared amplitudes are the radiance.
    for (const SourcePhase phase : {SourcePhase::path, SourcePhase::random}) {
      TraceParams waves{.columns = 8, .rows = 8, .paths = 4, .phase = phase};
      const auto power = [&](const Scene& one) {
        double sum = 0;
        for (const Source& wave : trace(one, polarized_panel, green_light, waves).waves)
          sum += double(wave.amplitude) * wave.amplitude;
        return sum;
      };
      EXPECT_NEAR(power(scene), passed * power(make_bright_wall()), 1e-3 * power(make_bright_wall())) << degrees;
    }
  }
  TraceParams laser{.columns = 4, .rows = 4, .phase = SourcePhase::laser};
  EXPECT_EQ(
      error_of([&] { trace(shining_sheet(0), polarized_panel, green_light, laser); }),
      "expected a phase other than laser in a scene with polarization, got laser; take phase path, or leave out the "
      "analyser, polarisers and retarders");
}

TEST(PolarizedLight, SeparatePolarizationsShareTheLightAndHavePhasesOfTheirOwn) {
  TraceParams params{.columns = 8, .rows = 8, .paths = 4, .separate_polarizations = true};
  const std::vector<double> colours{638e-9, green_light};
  const auto sets = trace(shining_sheet(30), polarized_panel, colours, params);
  ASSERT_EQ(sets.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(sets[i].wavelength, colours[i / 2]);
    EXPECT_EQ(sets[i].label.name, i % 2 == 0 ? "horizontal" : "vertical");
  }
  // cos²30° = 3/4 of the light behind a sheet at 30° is horizontal.
  const auto power = [](const Sources& set) {
    double sum = 0;
    for (const Source& wave : set.waves) sum += double(wave.amplitude) * wave.amplitude;
    return sum;
  };
  EXPECT_NEAR(power(sets[0]) / (power(sets[0]) + power(sets[1])), 0.75, 1e-3);
  ASSERT_EQ(sets[2].waves.size(), sets[3].waves.size());
  int same = 0;
  for (size_t i = 0; i < sets[2].waves.size(); ++i)
    same += std::abs(std::remainder(sets[2].waves[i].phase - sets[3].waves[i].phase, 2 * pi)) < 0.01;
  EXPECT_LT(same, 4) << "of 64 by chance 0.2";
  Scene analysed = shining_sheet(30);
  analysed.analyser = linear_polariser(0);
  EXPECT_EQ(error_of([&] { trace(analysed, polarized_panel, colours, params); }),
            "expected an analyser or separate_polarizations, got both; an analyser leaves one polarization");
}

}  // namespace
}  // namespace holotrace
