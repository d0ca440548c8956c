#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/data/shapes.h"
#include "trace/scenes.h"

// In which medium a ray is, against lengths known from the geometry. Optical thicknesses are sums of a few lengths times extinctions:
// 1e-12 is far above their rounding.

namespace holotrace {
namespace {

constexpr double rounding_of_lengths = 1e-12;

/// A box with its middle at `centre`, of the material `material`.
Mesh box_at(Vec3 centre, Vec3 size, int material) {
  Mesh mesh = make_box(size);
  for (Vec3& p : mesh.positions) p += centre;
  mesh.material = material;
  return mesh;
}

/// A scene whose material i is filled with a medium of the extinction i [1/m], behind an interface; material 0 is clear glass.
Scene scene_of_inks(int count) {
  Scene scene;
  scene.materials.emplace_back(DielectricMaterial{});
  for (int i = 1; i <= count; ++i) {
    Material boundary = grey(0);
    boundary.opacity = 0;
    boundary.medium = i - 1;
    scene.materials.push_back(boundary);
    scene.media.push_back({"ink " + std::to_string(i), Vec3{1, 1, 1} * i});
  }
  for (Medium& medium : scene.media) {
    medium.material = int(scene.materials.size());
    scene.materials.emplace_back(ScatteringMaterial{.albedo = {}});
  }
  return scene;
}

/// Lets the medium of that extinction fill a box, or all of space.
void open_ink(Scene& scene, int extinction, std::optional<MediumBox> box) {
  scene.media[size_t(extinction) - 1].is_open = true;
  scene.media[size_t(extinction) - 1].box = box;
}

/// Optical thickness between two places, which is the same in both directions, as a viewer on either side sees it.
double thickness(const Scene& scene, Vec3 from, Vec3 to) {
  const Accelerator accelerator(scene);
  const auto along = [&](Vec3 a, Vec3 b) {
    return -std::log(accelerator.transmittance({a, normalize(b - a)}, length(b - a)).x);
  };
  const double there = along(from, to);
  EXPECT_NEAR(along(to, from), there, rounding_of_lengths);
  // Parts add up: a ray that begins on the way knows where it is.
  const Vec3 middle = from + (to - from) * 0.371;
  EXPECT_NEAR(along(from, middle) + along(middle, to), there, rounding_of_lengths);
  return there;
}

// Boxes that share a face, and a gap below and above the offset with which rays leave surfaces. The ray through the middle meets the
// diagonals of the faces.
TEST(MediaRegions, BoundariesThatTouchAreBothMet) {
  for (const double x : {0.0, 1.3e-3})
    for (const double gap : {0.0, 1e-12, 1e-9, 1e-6, 1e-4}) {
      Scene scene = scene_of_inks(3);
      for (int i = 0; i < 3; ++i)
        scene.meshes.push_back(box_at({0, 0, -0.3 - i * (0.02 + gap)}, {0.04, 0.04, 0.02}, i + 1));
      EXPECT_NEAR(thickness(scene, {x, 0, -0.1}, {x, 0, -0.5}), 0.02 * (1 + 2 + 3), rounding_of_lengths) << gap;
    }
}

// Media in boxes, beside each other and beside a mesh.
TEST(MediaRegions, BoxesThatTouchAreBothMet) {
  Scene scene = scene_of_inks(3);
  open_ink(scene, 1, MediumBox{{-1, -1, -0.31}, {1, 1, -0.29}});
  open_ink(scene, 2, MediumBox{{-1, -1, -0.33}, {1, 1, -0.31}});
  scene.meshes = {box_at({0, 0, -0.34}, {0.04, 0.04, 0.02}, 3)};
  EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.5}), 0.02 * (1 + 2 + 3), rounding_of_lengths);
}

// Glass of the same shape as the medium in it does not empty it, whichever comes first.
TEST(MediaRegions, AMediumFillsGlassOfTheSameShape) {
  Scene scene = scene_of_inks(1);
  scene.meshes = {box_at({0, 0, -0.3}, {0.04, 0.04, 0.02}, 0), box_at({0, 0, -0.3}, {0.04, 0.04, 0.02}, 1)};
  EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.5}), 0.02, rounding_of_lengths);
  std::swap(scene.meshes[0], scene.meshes[1]);
  EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.5}), 0.02, rounding_of_lengths);
}

// A mesh counts before a box, the smaller of two before the larger one, and any before the rest of space: also where one sticks out of
// the other, whichever way a ray goes.
TEST(MediaRegions, OverlapsHaveOneOrder) {
  for (const double z :
       {-0.29, -0.299, -0.3, -0.301, -0.31, -0.33}) {  // ink 3 from wholly outside of box 1 to wholly inside
    Scene scene = scene_of_inks(3);
    open_ink(scene, 1, MediumBox{{-1, -1, -0.35}, {1, 1, -0.3}});
    scene.meshes = {box_at({0, 0, z}, {0.008, 0.008, 0.008}, 3)};
    const double inside = std::clamp((-0.3 - (z - 0.004)) / 0.008, 0.0, 1.0);
    EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.5}), 3 * 0.008 + 0.05 - 0.008 * inside, rounding_of_lengths);
    scene.meshes[0].material = 0;  // glass empties what it fills
    EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.5}), 0.05 - 0.008 * inside, rounding_of_lengths);
  }
  // From the outermost to the innermost: the rest of space, a large and a small box, a large and a small mesh.
  Scene scene = scene_of_inks(5);
  open_ink(scene, 1, {});
  open_ink(scene, 3, MediumBox{{-1, -1, -0.35}, {1, 1, -0.25}});
  open_ink(scene, 2, MediumBox{{-2, -2, -0.4}, {2, 2, -0.3}});
  scene.meshes = {box_at({0, 0, -0.24}, {0.1, 0.1, 0.06}, 4), box_at({0, 0, -0.28}, {0.05, 0.1, 0.06}, 5)};
  const double expected = 0.11 * 1 + 0.04 * 4 + 0.06 * 5 + 0.04 * 3 + 0.05 * 2 + 0.1 * 1;
  EXPECT_NEAR(thickness(scene, {1e-3, 0, -0.1}, {1e-3, 0, -0.5}), expected, rounding_of_lengths);
}

// Two overlapping shells in one mesh; and a mesh with its inside out, alone and in fog.
TEST(MediaRegions, AMeshIsInsideWhereItWindsAround) {
  Scene scene = scene_of_inks(2);
  Mesh both = box_at({0, 0, -0.3}, {0.04, 0.04, 0.02}, 2);
  const Mesh second = box_at({0.003, 0.001, -0.315}, {0.03, 0.05, 0.02}, 2);
  for (auto [i, j, k] : second.triangles) {
    const auto first = uint32_t(both.positions.size());
    both.triangles.push_back({first + i, first + j, first + k});
  }
  both.positions.insert(both.positions.end(), second.positions.begin(), second.positions.end());
  both.normals.clear();
  scene.meshes = {both};
  EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.5}), 2 * 0.035, rounding_of_lengths);
  open_ink(scene, 1, {});
  for (auto& [i, j, k] : scene.meshes[0].triangles) std::swap(j, k);
  EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.5}), 2 * 0.035 + 0.365, rounding_of_lengths);
}

TEST(MediaRegions, ARayMeetsAnyNumberOfThem) {
  Scene scene = scene_of_inks(2);
  open_ink(scene, 1, MediumBox{{-1, -1, -0.65}, {1, 1, -0.2}});
  for (int i = 0; i < 200; ++i) scene.meshes.push_back(box_at({0, 0, -0.21 - i * 0.002}, {0.04, 0.04, 0.001}, 2));
  EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.7}), 0.2 * 2 + 0.25 * 1, rounding_of_lengths);
}

// Rays at the corners of a sphere, at the middles of its edges and of its triangles, along its axes and in the planes of none, cross it
// once from inside. Outside of it, the sum of steps is that of a ray that misses: 0. Fog in it is as thick as the way is long.
TEST(MediaRegions, RaysThroughEdgesAndCornersCrossOneFace) {
  const Vec3 centre{0, 0, -0.25};
  Mesh sphere = make_round_mesh(centre, 0.125, 8);
  sphere.material = 1;
  Scene scene = scene_of_inks(1);
  scene.meshes = {sphere};
  const Accelerator accelerator(scene);
  for (const auto& triangle : sphere.triangles) {
    const Vec3 a = sphere.positions[triangle[0]], b = sphere.positions[triangle[1]], c = sphere.positions[triangle[2]];
    for (const Vec3& aim : {a, b, (a + b) * 0.5, (b + c) * 0.5, (a + c) * 0.5, (a + b + c) / 3}) {
      const double radius = length(aim - centre);
      const Vec3 direction = (aim - centre) / radius;
      EXPECT_NEAR(-std::log(accelerator.transmittance({centre, direction}, 1).x), radius, rounding_of_lengths);
      // From far outside, through the centre: two corners, edges or faces that lie opposite each other, as the sphere is symmetric.
      const double through = -std::log(accelerator.transmittance({aim + direction, -direction}, 3).x);
      EXPECT_NEAR(through, 2 * radius, rounding_of_lengths);
      EXPECT_EQ(accelerator.transmittance({aim + direction, direction}, 3).x, 1);
    }
  }
}

// Glass without a medium may have holes: its inside, which is empty, lies between a face that a ray enters and the next one. A ray
// that never leaves it is not in it, and neither is one that meets a single sheet of it.
// A sheet or a bowl of glass holds no air: fog goes on through it, whichever side is seen. Solids that absorb are in
// test_absorbing_solids.cpp.
TEST(MediaRegions, GlassWithHolesIsNotEmpty) {
  Scene scene = scene_of_inks(1);
  open_ink(scene, 1, {});
  scene.meshes = {box_at({0, 0, -0.3}, {0.04, 0.04, 0.02}, 0)};
  auto& triangles = scene.meshes[0].triangles;
  const auto is_right_side = [&](const std::array<uint32_t, 3>& t) {
    const auto& p = scene.meshes[0].positions;
    return p[t[0]].x > 0 && p[t[1]].x > 0 && p[t[2]].x > 0;
  };
  ASSERT_EQ(std::erase_if(triangles, is_right_side), 2U);
  EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.5}), 0.4, rounding_of_lengths);
  const auto passed = [&](Vec3 from, Vec3 direction, double distance) {
    return -std::log(Accelerator(scene).transmittance({from, direction}, distance).x);
  };
  EXPECT_NEAR(passed({-0.1, 0, -0.3}, {1, 0, 0}, 0.2), 0.2, rounding_of_lengths);  // in, and out by the hole
  EXPECT_NEAR(passed({0, 0, -0.3}, {0, 0, -1}, 0.2), 0.2, rounding_of_lengths);    // from inside
  scene.meshes = {make_wall(-0.3, 1, 1)};
  EXPECT_NEAR(passed({0, 0, -0.1}, {0, 0, -1}, 0.4), 0.4, rounding_of_lengths);
  EXPECT_NEAR(passed({0, 0, -0.5}, {0, 0, 1}, 0.4), 0.4, rounding_of_lengths);
}

// A murky tank: a box of ink in a ball or block of glass that is larger.
TEST(MediaRegions, ABoxInGlassIsFull) {
  Scene scene = scene_of_inks(1);
  open_ink(scene, 1, MediumBox{{-0.01, -0.01, -0.31}, {0.01, 0.01, -0.29}});
  scene.meshes = {box_at({0, 0, -0.3}, {0.04, 0.04, 0.04}, 0)};
  EXPECT_NEAR(thickness(scene, {0, 0, -0.1}, {0, 0, -0.5}), 0.02, rounding_of_lengths);
}

// The medium of the rest of space begins behind the panel: a viewer in front of it looks through clear air to z = 0.
TEST(MediaRegions, TheMediumOfTheSceneBeginsBehindThePanel) {
  Scene scene = scene_of_inks(1);
  open_ink(scene, 1, {});
  scene.meshes = {make_wall(-0.5, 1, 1)};
  EXPECT_NEAR(thickness(scene, {0, 0, 0.3}, {0, 0, -0.3}), 0.3, rounding_of_lengths);
  EXPECT_NEAR(thickness(scene, {0, 0, 0.3}, {0.3, 0, -0.1}), 0.125, rounding_of_lengths);  // a quarter of 0.5 m
  EXPECT_NEAR(thickness(scene, {0, 0, 0}, {0, 0, -0.3}), 0.3, rounding_of_lengths);
  EXPECT_EQ(Accelerator(scene).transmittance({{0, 0, -0.2}, {0, 0, 1}}, 1e9).x, std::exp(-0.2));
}

}  // namespace
}  // namespace holotrace
