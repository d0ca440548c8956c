#include <gtest/gtest.h>

#include <memory>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/trace/lights/emitters.h"
#include "holotrace/trace/materials/bsdf.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

TEST(EmissiveTriangles, ASampleHasTheTexturesLightAtItsPlace) {
  auto texture = std::make_shared<Image>(4, 4, 3);
  CounterRandom random(3, 0, 0);
  for (float& value : texture->values) value = float(0.1 + random.uniform());
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].emission = {5, 3, 2};
  scene.materials[0].emission_texture = texture;
  scene.meshes = {make_test_quad({5_mm, -3_mm, -0.28}, {20_mm, 0, 0}, {0, 10_mm, 0})};
  const EmissiveTriangles lamps(scene, Lines{});
  const Vec3 from{1_mm, 2_mm, -0.1};
  int in_lower = 0;
  for (int i = 0; i < 64; ++i) {
    const double s = random.uniform(), t = random.uniform();
    const LightSample sample = lamps.sample(from, {s, t});
    const Vec3 place = from + sample.direction * sample.distance;
    // The quad spans (−15, −13) to (25, 7) mm, and its texture spans the quad.
    const double u = (place.x + 15_mm) / 40_mm, v = (place.y + 13_mm) / 20_mm;
    const Vec3 expected = scene.materials[0].emission * eval_texture(*texture, {u, v});
    // Rounding of u and v by the distance, 0.2 m · 2⁻⁵², over 20 mm, times a slope of 4 texels of 5 W/m²/sr.
    EXPECT_LT(length(sample.radiance - expected), 1e-12) << u << " " << v;
    in_lower += v < u;
  }
  EXPECT_TRUE(in_lower > 8 && in_lower < 56) << "both triangles are drawn";
}

}  // namespace
}  // namespace holotrace
