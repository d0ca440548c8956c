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
  // Linear over 1/24 of the ratios and a sixteenth of the levels, where spectra of saturated colours bend: at most 1 %, as measured
  // over 1500 colours. Most colours are far from there.
  EXPECT_LT(largest, 0.012);
  EXPECT_LT(sum / count, 0.001);
}

TEST(ReflectanceTable, LeavesGreysGrey) {
  // All of the spectrum is the grey itself, between places of the raster, too. The fit ends at 1e-7 of squared error; darker than
  // 1e-3 the table goes on in proportion.
  const ReflectanceTable& table = reflectance_table(lasers);
  for (const double grey : {1e-4, 2e-3, 0.0101, 0.0152, 0.03, 0.0501, 0.18, 0.37, 0.63, 0.9, 0.987, 0.999}) {
    const Vec3 found = table.at({grey, grey, grey});
    for (const double value : {found.x, found.y, found.z}) EXPECT_NEAR(value / grey, 1, 1e-3) << grey;
  }
  EXPECT_EQ(table.at({0, 0, 0}), Vec3{});
}

TEST(ReflectanceTable, KeepsDarkColours) {
  // Relative to the brightest of the three lines, 2 %: the steps of the raster are ratios of the components.
  const ReflectanceTable& table = reflectance_table(lasers);
  CounterRandom random(3, 0, 0);
  for (int k = 0; k < 100; ++k) {
    const double r = 0.3 + 0.7 * random.uniform(), g = 0.3 + 0.7 * random.uniform(), b = 0.3 + 0.7 * random.uniform();
    const Vec3 rgb = Vec3{r, g, b} * (0.005 + 0.05 * random.uniform());
    const SmoothReflectance exact = fit_reflectance(rgb);
    const Vec3 wanted{exact.at(lasers[0]), exact.at(lasers[1]), exact.at(lasers[2])};
    const Vec3 error = table.at(rgb) - wanted;
    EXPECT_LT(std::max({std::abs(error.x), std::abs(error.y), std::abs(error.z)}),
              0.02 * std::max({wanted.x, wanted.y, wanted.z}));
  }
}

TEST(ReflectanceTable, IsTakenForSurfacesIfTheSceneAsksForIt) {
  Scene scene = make_corner();
  const Vec3 orange{0.5, 0.25, 0.125};  // on the raster
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
