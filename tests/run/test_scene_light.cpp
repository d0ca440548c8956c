#include <gtest/gtest.h>

#include "holotrace/run/scene_light.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/synthesize.h"

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

// Of waves on both sides of the panel, spherical and astigmatic, by every method.
TEST(SceneLight, EveryMethodKeepsTheLabel) {
  Sources set = one_wave(638e-9, "direct");
  set.waves.push_back({{0, 0, 0.05}, 1, 0});
  set.label.frame = 7;
  for (const SynthesisMethod method : {SynthesisMethod::exact, SynthesisMethod::tiled, SynthesisMethod::planes,
                                       SynthesisMethod::layers, SynthesisMethod::automatic})
    EXPECT_EQ(synthesize(set, {16, 12, 8e-6}, {.method = method, .tolerance = 1e-2}).label, set.label);
  set.second_foci = {{{0, 0, -0.1}, {1, 0, 0}}, {}};
  EXPECT_EQ(synthesize(set, {16, 12, 8e-6}, {.tolerance = 1e-2}).label, set.label);
  const Field field = synthesize(set, {16, 12, 8e-6}, {.tolerance = 1e-2});
  EXPECT_EQ(propagate(field, 0.01).label, set.label);
  PropagateParams shifted;
  shifted.centre_x = 8e-6;
  EXPECT_EQ(propagate(field, 0, shifted).label, set.label);
  Slm slm;
  slm.grid = field.grid;
  const Hologram hologram = encode(field, slm, {.method = Encoding::phase});
  EXPECT_EQ(hologram.label, set.label);
  EXPECT_EQ(show(hologram, slm, {}).label, set.label);
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
