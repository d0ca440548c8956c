#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/trace/stack_planes.h"

namespace holotrace {
namespace {

const Grid rays_panel{40, 20, 10e-6};  // 0.4 mm × 0.2 mm

TEST(PanelRays, StartEvenlyOnThePartOfThePanelThatThePlaceSees) {
  // Slopes up to 0.01: at 10 mm the reach is 0.1 mm, less than half of the width and all of the height's half.
  const PanelRays near(rays_panel, 0.01, {{rays_panel, 0.01}}, 16);
  const Vec2 middle{20, 10};  // in pixels: the axis
  for (const double u : {0.0, 0.25, 0.5, 1.0}) {
    const auto ray = near.ray(0, middle, {u, 0.5});
    ASSERT_TRUE(ray);
    EXPECT_NEAR(ray->from.x, (2 * u - 1) * 0.1e-3, 1e-12);
    EXPECT_NEAR(ray->at(0.01).x, 0, 1e-12);
    EXPECT_NEAR(ray->at(0.01).y, 0, 1e-12);
  }
  // From the left end of the window half of the box is off the panel.
  EXPECT_FALSE(near.ray(0, {0, 10}, {0.49, 0.5}));
  EXPECT_TRUE(near.ray(0, {0, 10}, {0.51, 0.5}));
  // At 30 mm the reach is 0.3 mm: places are even over the panel, and those beyond the reach are left out.
  const PanelRays far(rays_panel, 0.01, {{rays_panel, 0.03}}, 16);
  for (const double u : {0.0, 0.3, 0.7}) {
    const auto ray = far.ray(0, {0, 10}, {u, 0.25});
    ASSERT_TRUE(ray);
    EXPECT_NEAR(ray->from.x, (u - 0.5) * 0.4e-3, 1e-12);
    EXPECT_NEAR(ray->from.y, -0.25 * 0.2e-3, 1e-12);
  }
  EXPECT_FALSE(far.ray(0, {0, 10}, {0.76, 0.25}));
}

TEST(PanelRays, AreKeptWithTheDensityThatEarlierPlanesLack) {
  // The whole panel is seen from all planes: ρ grows as d².
  const PanelRays rays(rays_panel, 1, {{rays_panel, 0.2}, {rays_panel, 0.3}, {rays_panel, 0.19}}, 100);
  const PanelRay central{{0, 0}, {0, 0}};
  const double lacking = 1 - 0.2 * 0.2 / (0.3 * 0.3);
  EXPECT_EQ(rays.candidates(0, 10, 20), 100);
  EXPECT_EQ(rays.keep_probability(0, central, 100), 1);
  EXPECT_EQ(rays.candidates(1, 10, 20), int(std::ceil(100 * lacking)));
  EXPECT_NEAR(rays.keep_probability(1, central, 56), lacking * 100 / 56, 1e-12);
  EXPECT_EQ(rays.candidates(2, 10, 20), 0) << "all rays of a central pixel cross the window at 0.2 m";
  EXPECT_EQ(rays.candidates(2, 0, 0), 100);
  EXPECT_EQ(rays.keep_probability(2, central, 100), 0);
  const PanelRay outward{{0, 0}, {0.2e-3 / 0.195, 0}};  // crosses the window at 0.19 m and no other one
  EXPECT_EQ(rays.keep_probability(2, outward, 100), 1);
  // Weights are inverse densities, relative to that of the first plane.
  EXPECT_NEAR(rays.weight(central), 0.2 * 0.2 / (0.3 * 0.3), 1e-12);
  EXPECT_NEAR(rays.weight(outward), 0.2 * 0.2 / (0.19 * 0.19), 1e-12);
}

}  // namespace
}  // namespace holotrace
