#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "holotrace/base/random.h"
#include "holotrace/data/cie.h"
#include "holotrace/trace/lights/emitters.h"
#include "holotrace/trace/lights/sky.h"
#include "support/statistics.h"
#include "trace/lights/wall_scene.h"

namespace holotrace {
namespace {

constexpr Sky noon{.turbidity = 3, .elevation = pi / 4, .azimuth = 0.3, .has_sun = true};

// XYZ of the sky along a direction, from its radiance at every fifth nanometre.
Vec3 xyz_along(const Sky& sky, Vec3 direction) {
  return xyz_of([&](double wavelength) {
    return SkyModel(sky, make_lines(wavelength, wavelength, wavelength)).sky_radiance(direction).x;
  });
}

TEST(Sky, HasPreethamsLuminanceAndColourAtTheZenith) {
  // The formulas of the paper for T = 3 and a sun 45° from the zenith, computed apart: Y = 7.32036 kcd/m², x = 0.245678,
  // y = 0.251476.
  const Vec3 xyz = xyz_along(noon, {0, 1, 0});
  EXPECT_NEAR(lumens_per_watt * xyz.y / 7320.36, 1, 1e-5);  // six digits; the sums are the same
  // The components of daylight give a chromaticity to 2e-3: they are fitted to measured skies.
  EXPECT_NEAR(xyz.x / (xyz.x + xyz.y + xyz.z), 0.245678, 2e-3);
  EXPECT_NEAR(xyz.y / (xyz.x + xyz.y + xyz.z), 0.251476, 2e-3);
}

TEST(Sky, TheSunStandsWhereItsAnglesSay) {
  const SkyModel sky(noon, Lines{});
  const Vec3 sun = sky.sun_direction(),
             expected{std::sqrt(0.5) * std::sin(0.3), std::sqrt(0.5), -std::sqrt(0.5) * std::cos(0.3)};
  EXPECT_LT(length(sun - expected), 1e-15);
  // Its disc of 0.533° is brighter than the sky by four orders and ends there.
  const EnvironmentLight light({.sky = noon}, Lines{});
  const Frame frame = frame_from_normal(sun);
  const auto off = [&](double degrees) {
    return light.radiance(sun * std::cos(degrees * pi / 180) + frame.x * std::sin(degrees * pi / 180)).y;
  };
  EXPECT_GT(off(0.26), 1e4 * off(0.27));
  EXPECT_EQ(light.radiance({0, -0.1, -1}), Vec3()) << "below the horizon";
  const EnvironmentLight hazy({.sky = Sky{3, pi / 4, 0.3, false}}, Lines{});
  EXPECT_EQ(hazy.radiance(sun), SkyModel(noon, Lines{}).sky_radiance(sun));
}

TEST(Sky, SunlightOutsideOfHazeIsNearlyThatOfABlackBody) {
  // At the zenith the mass of the air is 1 (1.0006 by Kasten's formula). At 532 nm and T = 2 the optical depth is
  // 0.008735·0.532^−4.08 + 0.04630·0.532^−1.3 + 0.35·0.0645 = 0.11470 + 0.10518 + 0.02275, of which the ozone is between two
  // rows of its table.
  const Sky sky{.turbidity = 2, .elevation = pi / 2};
  const Vec3 sun = SkyModel(sky, Lines{}).sun_radiance();
  EXPECT_NEAR(sun.y / (planck(532e-9, 5778) * 1e-9 * std::exp(-0.2426)), 1, 2e-3);
  // Irradiance of the disc: 1.85 W/m²/nm at 532 nm outside of the air (ASTM E490), of which exp(−0.24) is left. The sun is no
  // black body: 5 %.
  EXPECT_NEAR(sun.y * sun_solid_angle / (1.85 * std::exp(-0.2426)), 1, 0.05);
}

TEST(Sky, ALowSunIsRed) {
  const Vec3 sun = SkyModel({.turbidity = 3, .elevation = 0.02}, Lines{}).sun_radiance();
  EXPECT_GT(sun.x, 5 * sun.y);
  EXPECT_GT(sun.y, 5 * sun.z);
}

TEST(Sky, TheAirOfALowSunIsThatOfKasten) {
  // 1/(sin h + 0.15·(h + 3.885°)^−1.253): 10.3231 at 5°, 2.8999 at 20° and 0.9995 at 90°, computed apart to five digits. The depth of
  // the air is the same for all, so the logarithms of the sun's light differ by the masses alone.
  const auto light_at = [](double degrees) {
    return SkyModel({.turbidity = 4, .elevation = degrees * pi / 180}, Lines{}).sun_radiance();
  };
  const Vec3 low = light_at(5), middle = light_at(20), high = light_at(90);
  const double expected = (10.3231 - 2.8999) / (2.8999 - 0.9995);
  EXPECT_NEAR(std::log(middle.x / low.x) / std::log(high.x / middle.x), expected, 2e-4 * expected);
  EXPECT_NEAR(std::log(middle.z / low.z) / std::log(high.z / middle.z), expected, 2e-4 * expected);
}

TEST(Sky, LightsAWallByTheIrradianceOfItsDisc) {
  // A sun in front of the wall, and the same sky without it: the difference is E·cosθ·ρ/π, E = L·Ω.
  Scene scene = wall_scene();
  Sky sky{.turbidity = 3, .elevation = 0.5, .azimuth = pi};  // behind the viewer
  scene.environment = Environment{.sky = sky};
  const Statistics both = follow(scene, onto_the_wall, 20000, unlimited);
  sky.has_sun = false;
  scene.environment = Environment{.sky = sky};
  const Statistics of_sky = follow(scene, onto_the_wall, 20000, unlimited);
  sky.has_sun = true;
  const double expected = SkyModel(sky, Lines{}).sun_radiance().y * 2 * pi * (1 - std::cos(0.533 / 2 * pi / 180)) *
                          std::cos(0.5) * 0.6 / pi;
  const double error = std::hypot(both.standard_error(), of_sky.standard_error());
  EXPECT_LT(error, 0.01 * expected) << "the disc is drawn, not met by chance";
  EXPECT_NEAR(both.mean() - of_sky.mean(), expected, 4 * error);
}

TEST(Sky, DirectionsAreDrawnWithTheirDensity) {
  const EnvironmentLight light({.sky = Sky{4, 0.4, 2.0, false}}, Lines{});
  CounterRandom random(5, 0, 0);
  const auto draw = [&]() -> std::optional<Vec3> {
    const double u = random.uniform(), v = random.uniform();
    const LightSample way = light.sample({u, v});
    EXPECT_NEAR(way.pdf / light.pdf(way.direction), 1, 1e-9);
    return way.direction;
  };
  const Vec3 sun = SkyModel({4, 0.4, 2.0, false}, Lines{}).sun_direction();
  const SphereTest test =
      test_sphere_sampling(SphereMap(sun, 0.3), 100000, draw, [&](Vec3 direction) { return light.pdf(direction); });
  EXPECT_NEAR(test.integral, 1, 2e-3) << "pixels of even density, by midpoints that do not keep to their edges";
  EXPECT_GT(test.chi_square.p_value, 1e-4);
}

TEST(Sky, TheSunsDiscIsDrawnEvenlyAndInItsShare) {
  const EnvironmentLight light({.sky = Sky{4, 0.4, 2.0, true}}, Lines{});
  const Vec3 sun = SkyModel({4, 0.4, 2.0, true}, Lines{}).sun_direction();
  const double omega = 2 * pi * (1 - std::cos(0.533 / 2 * pi / 180)), share = light.pdf(sun) * omega;
  const int count = 20000;
  int inside = 0, inner = 0;
  for (uint64_t k = 0; k < count; ++k) {
    CounterRandom random(5, 0, k);
    const double u = random.uniform(), v = random.uniform();
    const LightSample way = light.sample({u, v});
    ASSERT_NEAR(way.pdf / light.pdf(way.direction), 1, 1e-9);
    const double angle = std::acos(std::min(1.0, dot(way.direction, sun))) * 180 / pi;
    inside += angle < 0.533 / 2;
    inner += angle < 0.533 / 2 * std::sqrt(0.5);  // half of its area
  }
  EXPECT_GT(share, 0.2) << "much of the light is the sun's";
  EXPECT_NEAR(inside, share * count, 4 * std::sqrt(share * (1 - share) * count));
  EXPECT_NEAR(inner, inside / 2.0, 4 * std::sqrt(inside / 4.0));
}

TEST(Sky, ValuesOutOfRangeSayWhatWasExpected) {
  const auto error = [](const Sky& sky) {
    Scene scene = wall_scene();
    scene.environment = Environment{.sky = sky};
    return error_of([&] { follow(scene, onto_the_wall, 1, unlimited); });
  };
  EXPECT_EQ(error({.turbidity = 1}), "expected a turbidity of the sky from 1.7 to 10, got 1");
  EXPECT_EQ(error({.elevation = -pi / 180}),
            "expected a sun from the horizon (0 deg) to the zenith (90 deg), got an elevation of -1 deg");
  Scene scene = wall_scene();
  scene.environment = Environment{.sky = noon};
  EXPECT_EQ(error_of([&] { Emitters(scene, make_lines(532e-9, 1064e-9, 460e-9)); }),
            "expected wavelengths from 380 nm to 780 nm, those of the sky, got 1.064 µm");
}

}  // namespace
}  // namespace holotrace
