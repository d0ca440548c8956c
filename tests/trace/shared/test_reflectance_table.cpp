#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/random.h"
#include "holotrace/data/smooth_reflectance.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/path_scene.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

// Yellow and orange, where colours of three lines say little, and blue.
constexpr std::array<double, 3> lasers{589e-9, 610e-9, 488e-9};

TEST(ReflectanceTable, IsNearTheSpectraOfAllColours) {
  const ReflectanceTable& table = reflectance_table(lasers);
  CounterRandom random(2, 0, 0);
  double largest = 0, sum = 0;
  const int count = 300;
  for (int k = 0; k < count; ++k) {
    const double r = random.uniform(), g = random.uniform(), b = random.uniform();
    const SmoothReflectance exact = fit_reflectance({r, g, b});
    const Vec3 found = table.at({r, g, b});
    const double error = std::max({std::abs(found.x - exact.at(lasers[0])), std::abs(found.y - exact.at(lasers[1])),
                                   std::abs(found.z - exact.at(lasers[2]))});
    largest = std::max(largest, error);
    sum += error;
  }
  // Linear over 1/32 of a curve between 0 and 1 that rises in an eighth: f''·h²/8 = 64/1024/8 = 8e-3 at its knees, for three
  // axes. Most colours are far from them.
  EXPECT_LT(largest, 0.024);
  EXPECT_LT(sum / count, 0.002);
}

TEST(ReflectanceTable, IsTakenForSurfacesIfTheSceneAsksForIt) {
  Scene scene = make_corner();
  const Vec3 orange{0.75, 0.375, 0.125};  // on the raster
  scene.materials[1] = DiffuseMaterial{orange, nullptr, {}};
  const Lines lines = make_lines(lasers[0], lasers[1], lasers[2]);
  SurfacePoint point;
  point.normal = point.geometric_normal = {0, 0, 1};
  const auto seen = [&] {
    const PathScene prepared(scene, lines, {}, {});
    return *diffuse_reflectance(scene.materials[1], point, prepared.lines);
  };
  EXPECT_EQ(seen(), lines.from_rgb(orange));
  scene.reflectances = Reflectances::smooth;
  const SmoothReflectance spectrum = fit_reflectance(orange);
  EXPECT_NEAR(seen().x, spectrum.at(lasers[0]), 1e-12);
  EXPECT_NEAR(seen().y, spectrum.at(lasers[1]), 1e-12);
  EXPECT_NEAR(seen().z, spectrum.at(lasers[2]), 1e-12);
}

}  // namespace
}  // namespace holotrace
