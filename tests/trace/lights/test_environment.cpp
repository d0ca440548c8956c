#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "holotrace/base/random.h"
#include "holotrace/trace/lights/emitters.h"
#include "support/statistics.h"
#include "trace/lights/wall_scene.h"

namespace holotrace {
namespace {

std::shared_ptr<Image> random_map(int ny) {
  auto map = std::make_shared<Image>(ny, 2 * ny, 3);
  CounterRandom random(7, 0, 0);
  for (float& value : map->values) value = float(std::pow(random.uniform(), 4));
  return map;
}

TEST(EnvironmentLight, PlacesOnTheMapAreWhereTheSceneFormatPutsThem) {
  const auto near = [](Vec3 a, Vec3 b) { return length(a - b) < 1e-15; };
  EXPECT_TRUE(near(environment_direction({0.5, 0.5}, 0), {0, 0, -1})) << "its middle behind the scene";
  EXPECT_TRUE(near(environment_direction({0.75, 0.5}, 0), {1, 0, 0})) << "its right half toward +x";
  EXPECT_TRUE(near(environment_direction({0.3, 0}, 0), {0, 1, 0})) << "its top +y";
  const Vec3 direction = normalize({0.3, -0.5, 0.2});
  for (const double turn : {0.0, 0.7, -4.0}) {
    const Vec2 place = environment_place(direction, turn);
    EXPECT_LT(length(environment_direction(place, turn) - direction), 1e-14);
    const Vec3 turned = transform_vector(rotation_y(turn), environment_direction(place, 0));
    EXPECT_LT(length(turned - direction), 1e-14) << "the map is turned right-handed about +y";
  }
}

TEST(EnvironmentLight, DirectionsAreDrawnWithTheirDensity) {
  const int ny = 16, nx = 2 * ny, count = 200000;
  const Environment environment{random_map(ny), {1, 2, 0.5}, 0.4};
  const EnvironmentLight light(environment, Lines{});
  std::vector<double> observed(size_t(nx * ny)), expected;
  CounterRandom random(1, 0, 0);
  for (int k = 0; k < count; ++k) {
    const double u = random.uniform(), v = random.uniform();
    const LightSample way = light.sample({u, v});
    const Vec2 place = environment_place(way.direction, environment.turn);
    ++observed[size_t(int(place.y * ny) * nx + int(place.x * nx))];
    if (k < 1000) {
      ASSERT_NEAR(way.pdf / light.pdf(way.direction), 1, 1e-12);
      ASSERT_NEAR(length(way.radiance - light.radiance(way.direction)), 0, 1e-6 * length(way.radiance));
    }
  }
  double total = 0;
  for (int row = 0; row < ny; ++row)
    for (int column = 0; column < nx; ++column) {
      const double solid_angle = 2 * pi / nx * (std::cos(pi * row / ny) - std::cos(pi * (row + 1) / ny));
      expected.push_back(count * solid_angle *
                         light.pdf(environment_direction({(column + 0.5) / nx, (row + 0.5) / ny}, environment.turn)));
      total += expected.back();
    }
  EXPECT_NEAR(total / count, 1, 1e-12) << "the density integrates to 1";
  EXPECT_GT(chi_square(observed, expected).p_value, 1e-4);
}

TEST(EnvironmentLight, AnEvenMapIsDrawnEvenlyAndIsTheBackground) {
  auto map = std::make_shared<Image>(4, 8, 1);
  for (float& value : map->values) value = 0.5F;
  const EnvironmentLight light({map, {4, 4, 4}, 1}, Lines{});
  EXPECT_NEAR(light.pdf(normalize({1, 2, 3})) * 4 * pi, 1, 1e-6);
  EXPECT_NEAR(light.radiance(normalize({1, 2, 3})).y, 2, 1e-12);

  Scene scene = wall_scene();
  scene.environment = {map, {4, 4, 4}, 1};
  const Statistics found = follow(scene, onto_the_wall, 20000, unlimited);
  EXPECT_NEAR(found.mean(), 0.6 * 2, 4 * found.standard_error()) << "a white sky on albedo 0.6";
  scene.background = {1, 1, 1};
  const Statistics both = follow(scene, onto_the_wall, 20000, unlimited);
  EXPECT_NEAR(both.mean(), 0.6 * 3, 4 * both.standard_error()) << "they add";
}

TEST(EnvironmentLight, InsideAPixelDirectionsAreEvenOverItsSolidAngle) {
  // Pixels a quarter turn high. For directions uniform over the sphere |y| is uniform in [0, 1]: mean 1/2, mean square
  // 1/3. Uniform over the angle they would be 2/π and 1/2.
  auto map = std::make_shared<Image>(2, 4, 1);
  for (float& value : map->values) value = 1;
  const EnvironmentLight light({map, {1, 1, 1}, 0}, Lines{});
  Statistics height, square;
  for (uint64_t i = 0; i < 20000; ++i) {
    CounterRandom random(8, 0, i);
    const double u = random.uniform(), v = random.uniform();
    const double y = std::abs(light.sample({u, v}).direction.y);
    height.add(y);
    square.add(y * y);
  }
  EXPECT_NEAR(height.mean(), 0.5, 4 * height.standard_error());
  EXPECT_NEAR(square.mean(), 1.0 / 3, 4 * square.standard_error());
}

TEST(EnvironmentLight, ASunInTheMapLightsTheWallByItsIntegral) {
  auto map = std::make_shared<Image>(64, 128, 1);
  for (float& value : map->values) value = 0.1F;
  (*map)(20, 3) = 3000;  // a pixel of 2.8°, up and toward +z
  Scene scene = wall_scene();
  scene.environment = {map, {1, 1, 1}, 0.2};
  const EnvironmentLight light(*scene.environment, Lines{});
  // ρ/π ∫ L cosθ dω by midpoints, 16 × 16 in a pixel.
  double integral = 0;
  const int rows = 64 * 16, columns = 2 * rows;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const Vec3 direction = environment_direction({(i + 0.5) / columns, (j + 0.5) / rows}, 0.2);
      if (direction.z > 0)
        integral += light.radiance(direction).y * direction.z * std::sin(pi * (j + 0.5) / rows) *
                    (2 * pi * pi / (double(columns) * rows));
    }
  const double expected = 0.6 / pi * integral;
  const Statistics found = follow(scene, onto_the_wall, 20000, 1);
  EXPECT_NEAR(found.mean(), expected, 4 * found.standard_error() + 1e-4 * expected);
  // If only met by chance, a sun of 1/5000 of the sphere would give about 0.5.
  EXPECT_LT(found.standard_error(), 0.02 * expected);
}

TEST(EnvironmentLight, ABlackMapGivesNothing) {
  Scene scene = wall_scene();
  scene.environment = {std::make_shared<Image>(4, 8, 3), {1, 1, 1}, 0};
  EXPECT_EQ(follow(scene, onto_the_wall, 100, unlimited).mean(), 0);
}

TEST(EnvironmentLight, IsThePixelInItsMiddleAndLinearBetweenTwo) {
  const int ny = 8, nx = 2 * ny;
  const auto map = random_map(ny);
  const double turn = 0.4;
  const EnvironmentLight light({map, {1, 1, 1}, turn}, Lines{});
  const auto at = [&](double column, double row) {
    return light.radiance(environment_direction({(column + 0.5) / nx, (row + 0.5) / ny}, turn)).y;
  };
  const auto pixel = [&](int column, int row) { return double((*map)(row, column, map->channels / 2)); };
  for (int row = 0; row < ny; ++row)
    for (int column = 0; column < nx; ++column) {
      // Directions are exact to some 1e-15; a pixel differs from the next one by less than its brightest value.
      const double tolerance = 1e-11 * *std::max_element(map->values.begin(), map->values.end());
      EXPECT_NEAR(at(column, row), pixel(column, row), tolerance);
      EXPECT_NEAR(at(column + 0.25, row), 0.75 * pixel(column, row) + 0.25 * pixel((column + 1) % nx, row), tolerance);
      if (row + 1 < ny) {
        EXPECT_NEAR(at(column, row + 0.25), 0.75 * pixel(column, row) + 0.25 * pixel(column, row + 1), tolerance);
      }
    }
}

}  // namespace
}  // namespace holotrace
