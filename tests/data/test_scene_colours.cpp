#include <gtest/gtest.h>

#include "holotrace/data/job.h"

namespace holotrace {
namespace {

Scene grey_scene() {
  Scene scene;
  scene.materials = {DiffuseMaterial{{0.5, 0.5, 0.5}}, ConductorMaterial{metal_index("Ag")}, DielectricMaterial{},
                     MetallicRoughnessMaterial{}};
  scene.meshes.resize(1);
  scene.meshes[0].colours = {{0.2, 0.2, 0.2}};
  scene.lights = {PointLight{{}, {1, 1, 1}}};
  scene.background = {0.3, 0.3, 0.3};
  return scene;
}

TEST(SceneColours, AGreySceneHasOneWavelength) {
  EXPECT_FALSE(has_colours(grey_scene()));
  EXPECT_EQ(wavelengths_for(grey_scene()), (std::vector<double>{532e-9}));
}

TEST(SceneColours, AnythingColouredGivesThree) {
  std::vector<Scene> scenes(7, grey_scene());
  scenes[0].background = {0.3, 0.3, 0.4};
  scenes[1].lights = {PointLight{{}, {1, 0.9, 0.8}}};
  scenes[2].meshes[0].colours = {{0.2, 0.2, 0.2}, {0.1, 0.2, 0.2}};
  scenes[3].materials = {ConductorMaterial{metal_index("Au")}};
  scenes[4].materials[0].emission = {1, 0, 0};
  auto texture = std::make_shared<Image>(2, 2, 3);
  texture->values[0] = 0.5F;  // one red pixel
  scenes[5].materials = {DiffuseMaterial{{1, 1, 1}, texture}};
  scenes[6].environment = Environment{texture};
  for (size_t i = 0; i < scenes.size(); ++i) {
    EXPECT_TRUE(has_colours(scenes[i])) << i;
    EXPECT_EQ(wavelengths_for(scenes[i]).size(), 3u);
  }
}

// JPEG makes single pixels of a grey picture coloured.
TEST(SceneColours, AFewPixelsOfATextureMakeNoColour) {
  Scene scene = grey_scene();
  auto texture = std::make_shared<Image>(64, 64, 3);
  for (float& value : texture->values) value = 0.5F;
  for (size_t i = 0; i < 4; ++i) texture->values[300 * i] = 1;  // 4 of 4096, below 1 in 1000
  scene.materials = {DiffuseMaterial{{1, 1, 1}, texture}};
  EXPECT_FALSE(has_colours(scene));
  texture->values[3000] = 1;  // 5
  EXPECT_TRUE(has_colours(scene));
}

}  // namespace
}  // namespace holotrace
