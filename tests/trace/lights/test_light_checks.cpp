#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "holotrace/base/random.h"
#include "holotrace/trace/lights/emitters.h"
#include "support/statistics.h"
#include "trace/lights/wall_scene.h"

namespace holotrace {
namespace {

TEST(SceneChecks, SayWhichLightOrMaterialCannotBeUsedAndWhy) {
  const auto sentence = [](const std::function<void(Scene&)>& spoil) {
    Scene scene = wall_scene();
    spoil(scene);
    return error_of([&] { const Accelerator accelerator(scene); });
  };
  const auto with_light = [&](const Light& light) { return sentence([&](Scene& s) { s.lights = {light}; }); };
  const auto with_material = [&](const Material& material) {
    return sentence([&](Scene& s) { s.materials = {material}; });
  };
  const auto with_map = [&](const Image& map) {
    return sentence([&](Scene& s) { s.environment = {std::make_shared<Image>(map), {1, 1, 1}, 0}; });
  };
  EXPECT_EQ(sentence([](Scene&) {}), "no error");
  EXPECT_EQ(with_light(SpotLight{{}, {0, 0, -1}, {1, 1, 1}, 0.5, 0.25}).substr(0, 86),
            "expected angles 0 ≤ inner ≤ outer ≤ 180 deg of the cone of light 0, got an inner");
  EXPECT_EQ(with_light(SpotLight{{}, {0, 0, 0}, {1, 1, 1}, 0.5, 0.6}),
            "expected a direction of length 1 in light 0, got (0, 0, 0) of length 0");
  EXPECT_EQ(with_light(DirectionalLight{{0, 0, 2}, {1, 1, 1}}),
            "expected a direction of length 1 in light 0, got (0, 0, 2) of length 2");
  EXPECT_EQ(with_light(DirectionalLight{{0, 0, 1}, {1, 1, 1}, {}, 0}),
            "expected a radius above 0 m of the beam of light 0, got 0 m");
  EXPECT_EQ(with_light(DirectionalLight{{0, 0, 1}, {1, -1, 1}}),
            "expected an irradiance of 0 W/m² or more in light 0, got (1, -1, 1)");
  EXPECT_EQ(with_light(PointLight{{NAN, 0, 0}, {1, 1, 1}}), "expected a finite position of light 0");

  EXPECT_EQ(with_material(MetallicRoughnessMaterial{.roughness = 1.5}),
            "expected a roughness from 0 to 1 in material 0, got 1.5");
  EXPECT_EQ(with_material(MetallicRoughnessMaterial{.metallic = -1}),
            "expected a metallic from 0 to 1 in material 0, got -1");
  EXPECT_EQ(with_material(ConductorMaterial{RefractiveIndex{}, 0}),
            "expected a refractive index in material 0, got one without samples");
  EXPECT_EQ(with_material(DielectricMaterial{constant_index(0), 0}),
            "expected a refractive index n + ik with n > 0 and k ≥ 0 in material 0, got 0 + 0i at " +
                fmt::format("{} m", constant_index(0).samples[0].wavelength));
  EXPECT_EQ(with_material(DiffuseMaterial{{0.8, 0.8, 0.8}, nullptr, {0.5, 0, 0}}),
            "expected a reflectance and a transmittance of at most 1 together in material 0, got 1.3");
  EXPECT_EQ(with_material({DiffuseMaterial{}, {1, -2, 1}}),
            "expected an emission of 0 W/m²/sr or more in material 0, got (1, -2, 1)");

  const auto with_layers = [&](const std::function<void(PrincipledMaterial&)>& change) {
    PrincipledMaterial layers;
    change(layers);
    return with_material(layers);
  };
  EXPECT_EQ(with_material(DielectricMaterial{constant_index(2e4), 0}),
            "expected an index of at most 10000 in material 0, got 20000");
  EXPECT_EQ(with_layers([](PrincipledMaterial& m) { m.iridescence_index = 1e308; }),
            "expected an index from 1 to 10000 of the thin film in material 0, got 1e+308");
  EXPECT_EQ(with_layers([](PrincipledMaterial& m) { m.clearcoat_index = 0.5; }),
            "expected an index from 1 to 10000 of the clear coat in material 0, got 0.5");
  EXPECT_EQ(with_layers([](PrincipledMaterial& m) { m.film_thickness = 2e-3; }),
            "expected a thin film of 0 m to 1 mm in material 0, got 2 mm");
  for (const double number : {1e7, -1e7, double(NAN), double(INFINITY)})
    EXPECT_EQ(
        with_layers([&](PrincipledMaterial& m) {
          m.roughness.texture = {std::make_shared<Image>(1, 1, 1), number};
        }),
        fmt::format("expected a texture in material 0 that is scaled and moved by at most 1e+06, got {:g}", number));
  EXPECT_EQ(sentence([](Scene& s) {
              s.materials[0].emission_texture = std::make_shared<Image>(1, 1, 1);
              s.meshes[0].texture_coordinates.assign(s.meshes[0].positions.size(), {1e10, 0});
            }),
            "expected texture coordinates of at most 1e+09 in mesh \"quad\", got (1e+10, 0)");
  EXPECT_EQ(sentence([](Scene& s) {
              s.materials[0].emission_texture = std::make_shared<Image>(1, 1, 1);
              s.meshes[0].texture_coordinates.clear();
            }).substr(0, 75),
            "expected texture coordinates in mesh \"quad\", whose material has a texture, ");

  EXPECT_EQ(with_map(Image(4, 4, 3)),
            "expected an environment map of all directions, twice as wide as high, with 1 or 3 channels, got 4 × 4 "
            "pixels with 3");
  Image bad(2, 4, 1);
  bad(1, 2) = -1;
  EXPECT_EQ(with_map(bad), "expected an environment map of finite values of 0 or more, got -1 in row 1, column 2");
  bad(1, 2) = NAN;
  EXPECT_EQ(with_map(bad), "expected an environment map of finite values of 0 or more, got nan in row 1, column 2");
  EXPECT_EQ(sentence([](Scene& s) { s.environment = Environment{}; }), "expected a map in the environment, got none");
}

}  // namespace
}  // namespace holotrace
