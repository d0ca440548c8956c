#include <gtest/gtest.h>

#include "holotrace/run/scene_light.h"

namespace holotrace::test {
namespace {

Sources one_wave(double wavelength, const std::string& name) {
  Sources set;
  set.wavelength = wavelength;
  set.label.name = name;
  set.label.cone_wavelength = 450e-9;
  set.waves = {{{0, 0, -0.05}, 1, 0}};
  return set;
}

// The encoder, the camera and further programs learn from the field which part of it has light.
TEST(SceneLight, FieldsKeepNameFrameAndCone) {
  SceneLight light;
  light.sources = {one_wave(638e-9, "direct"), one_wave(450e-9, "mirrored")};
  const std::vector<Field> fields = fields_of_frame(light, 3, {16, 12, 8e-6}, {});
  ASSERT_EQ(fields.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(fields[i].wavelength, light.sources[i].wavelength);
    EXPECT_EQ(fields[i].label.name, light.sources[i].label.name);
    EXPECT_EQ(fields[i].label.frame, 3u);
    EXPECT_EQ(fields[i].label.cone_wavelength, 450e-9);
  }
}

}  // namespace
}  // namespace holotrace::test
