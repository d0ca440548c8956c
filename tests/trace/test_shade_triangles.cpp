#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/trace/shade_triangles.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const Grid shaded_panel{64, 48, 8e-6};
const TraceParams direct{.paths = 1, .max_depth = 1};

Triangles shade(const Scene& scene, Shading shading = Shading::flat, TrianglePhase phase = TrianglePhase::random,
                const TraceParams& params = direct) {
  return shade_triangles(scene, shaded_panel, {green_light}, params, shading, phase).front();
}

// A wall of radiance 1 that fills the panel's view sends it the panel's étendue, area·(λ/p)². Triangles send a² times
// their area. They use the solid angle at their centroid. Their sides are 1/64 of the view, so where the box
// crosses the panel's edges the midpoint rule has an error of some 1e-3; sines for tangents add 1e-3.
TEST(ShadeTriangles, ABrightWallSendsThePanelItsEtendue) {
  for (const Shading shading : {Shading::flat, Shading::smooth}) {
    const Triangles triangles = shade(make_bright_wall(-0.05), shading);
    double power = 0;
    for (const Triangle& t : triangles.triangles) {
      EXPECT_EQ(t.amplitudes[0], t.amplitudes[1]);  // equal at all corners on an even wall
      power += double(t.amplitudes[0]) * t.amplitudes[0] * area_along_direction(t);
    }
    const double etendue = shaded_panel.width() * shaded_panel.height() * std::pow(green_light / shaded_panel.pitch, 2);
    EXPECT_NEAR(power / etendue, 1, 5e-3);
  }
}

// The longest side is at most 1/64 of the view's height, and more than half of that for the mean triangle.
TEST(ShadeTriangles, LargeFacesAreCut) {
  const Triangles triangles = shade(make_bright_wall(-0.05));
  const double most = 2 * acceptance_tangent(green_light, shaded_panel.pitch) * 0.05 / 64;
  double area = 0;
  for (const Triangle& t : triangles.triangles) {
    for (size_t j = 0; j < 3; ++j) EXPECT_LE(length(t.corners[j] - t.corners[(j + 1) % 3]), most * 1.0000001);
    area += length(cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0])) / 2;
  }
  EXPECT_GT(area / double(triangles.triangles.size()), most * most / 16);
}

// A sliver of 1 μm that reaches from 30 mm to 1 km behind the panel: its long sides are 1/64 of the view's height, 2·T of
// the depth, after 700 cuts per factor of two of depth. Cutting the longer of two long sides in turn makes about the
// square of that: half a million pieces for each of 15 factors of two, and there are 4 slivers.
TEST(ShadeTriangles, SliversThatComeToTooManyPiecesAreRefused) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  Mesh mesh;
  mesh.name = "needles";
  mesh.positions = {{0, 0, -0.03}, {1e-6, 1e-6, -0.03}, {0, 0, -1000}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}};
  scene.meshes = {mesh, make_wall(-0.06, 0.002, 0.002, 0)};
  try {
    shade(scene);
    FAIL() << "expected an Error";
  } catch (const Error& error) {
    const std::string sentence = error.what();
    EXPECT_NE(sentence.find("16777216 pieces or fewer"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("of \"needles\", from z = -1000 m to -30 mm"), std::string::npos) << sentence;
  }
}

Scene sphere_before_wall() {
  Scene scene;
  scene.materials = {grey(0, 1), grey(0, 4)};
  scene.meshes = {make_round_mesh({0, 0, -0.05}, 0.0004, 12), make_wall(-0.06, 0.002, 0.002, 1)};
  return scene;
}

// Of the sphere, the side that faces the panel (z above its centre); of the wall, the part outside the sphere's shadow,
// whose radius is 0.48 mm there. Triangles at the shadow's edge may have a corner in it, but not their centroid.
TEST(ShadeTriangles, HiddenOnesDoNotShine) {
  const Triangles triangles = shade(sphere_before_wall());
  int of_sphere = 0, of_wall = 0;
  for (const Triangle& t : triangles.triangles) {
    const Vec3 c = centroid(t);
    if (c.z > -0.055) {
      EXPECT_GT(c.z, -0.05);
      ++of_sphere;
    } else {
      EXPECT_GT(std::hypot(c.x, c.y), 0.0004 * 0.95 * 0.06 / 0.05);  // a sphere of 24 flat sides is 1 % smaller
      ++of_wall;
    }
  }
  EXPECT_GT(of_sphere, 100);
  EXPECT_GT(of_wall, 1000);
}

// At a hidden corner the amplitude is 0, so the light of smooth triangles ends at the shadow's edge.
TEST(ShadeTriangles, SmoothOnesAreDarkAtHiddenCorners) {
  const Triangles triangles = shade(sphere_before_wall(), Shading::smooth);
  const auto is_mixed = [](const Triangle& t) {
    return t.corners[0].z < -0.055 && *std::min_element(t.amplitudes.begin(), t.amplitudes.end()) == 0;
  };
  const auto mixed = std::count_if(triangles.triangles.begin(), triangles.triangles.end(), is_mixed);
  EXPECT_GT(mixed, 10);
  EXPECT_LT(mixed, int64_t(triangles.triangles.size()) / 10);
}

TEST(ShadeTriangles, OneSidedFacesAreDarkFromBehind) {
  Scene scene = make_bright_wall(-0.05);
  for (auto& triangle : scene.meshes[0].triangles) std::swap(triangle[1], triangle[2]);
  EXPECT_FALSE(shade(scene).triangles.empty());
  scene.materials[0].two_sided = false;
  EXPECT_TRUE(shade(scene).triangles.empty());
}

TEST(ShadeTriangles, RefusesSurfacesThroughThePanel) {
  Scene scene = make_bright_wall(-20_mm);
  scene.meshes[0].positions[1].z = 5_mm;
  EXPECT_EQ(
      error_of([&] { shade(scene); }),
      "expected surfaces behind the panel (z < 0) or in front of it (z > 0) for the method triangles, got triangle 0 of "
      "\"quad\" from z = -20 mm to 5 mm; cut it at the panel, or use another method");
}

// A wall in front of the panel has the light of one as far behind it. A card between it and the viewer hides the part that the eye
// behind the panel's centre would see through it; one between panel and wall is hidden itself.
TEST(ShadeTriangles, SurfacesInFrontShineAsThoseBehind) {
  const auto power_of = [](const Triangles& triangles) {
    double power = 0;
    for (const Triangle& t : triangles.triangles) {
      EXPECT_GT(t.direction.z, 0);
      power += double(t.amplitudes[0]) * t.amplitudes[0] * area_along_direction(t);
    }
    return power;
  };
  const double behind = power_of(shade(make_bright_wall(-0.05)));
  Scene scene = make_bright_wall(0.05);
  const Triangles in_front = shade(scene);
  EXPECT_NEAR(power_of(in_front) / behind, 1, 1e-6);  // floats
  // Light comes to each triangle from the panel's part in its box.
  for (const Triangle& t : in_front.triangles) {
    const Vec3 c = centroid(t), from = c - t.direction * (c.z / t.direction.z);
    EXPECT_LE(std::abs(from.x), shaded_panel.width() / 2 + std::abs(c.x) * 1e-9 + 1e-9 +
                                    std::max(0.0, std::abs(c.x) - shaded_panel.width() / 2));
  }
  scene.meshes.push_back(make_wall(0.03, 0.2_mm, 0.2_mm, 0));
  EXPECT_NEAR(power_of(shade(scene)) / behind, 1, 1e-6);
  scene.meshes.back() = make_wall(0.06, 0.2_mm, 0.2_mm, 0);
  int hidden = 0, shown = 0;
  for (const Triangle& t : shade(scene).triangles) {
    const Vec3 c = centroid(t);
    if (c.z > 0.055) continue;
    const bool is_covered = std::abs(c.x) < 0.16_mm && std::abs(c.y) < 0.16_mm;  // 0.2 mm · 5/6, less a triangle
    hidden += is_covered;
    shown += !is_covered;
  }
  EXPECT_EQ(hidden, 0);
  EXPECT_GT(shown, 100);
}

// Light goes straight ahead from triangles before the panel, and from others to what they can light of it: the
// part within their box, away from its ends by an eighth of it or by the width of the beam.
TEST(ShadeTriangles, LightGoesToThePanel) {
  // Triangles of 52 µm, 1/64 of the view of 3.3 mm; beams of 0.7 mm; a panel of 4.1 mm: all cases occur.
  const Grid wide{512, 16, shaded_panel.pitch};
  const double depth = 0.05, radius = depth * acceptance_tangent(green_light, wide.pitch), half = wide.width() / 2;
  int straight = 0, aside = 0;
  const auto sets =
      shade_triangles(make_bright_wall(-depth), wide, {green_light}, direct, Shading::flat, TrianglePhase::random);
  for (const Triangle& t : sets[0].triangles) {
    const Vec3 c = centroid(t), e = t.direction;
    EXPECT_NEAR(length(e), 1, 1e-12);
    const double area = length(cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0])) / 2;
    const double low = std::max(-half, c.x - radius), high = std::min(half, c.x + radius);
    if (low >= high) continue;
    const double eighth = (high - low) / 8, beam = green_light * depth / std::sqrt(2 * area);
    const double margin = std::min(std::max(eighth, beam), 4 * eighth), there = c.x + e.x / e.z * depth;
    constexpr double rounding = 1e-12;
    EXPECT_GE(there, low + margin - rounding);
    EXPECT_LE(there, high - margin + rounding);
    const bool is_before = c.x >= low + margin && c.x <= high - margin;
    if (is_before) {
      EXPECT_EQ(e.x, 0);
    } else {
      EXPECT_NEAR(there, c.x < 0 ? low + margin : high - margin, rounding);
    }
    (is_before ? straight : aside) += 1;
  }
  EXPECT_GT(straight, 0);
  EXPECT_GT(aside, 0);
}

TEST(ShadeTriangles, PhasesAreThoseOfTheirKeysOrConstant) {
  const Triangles random = shade(make_bright_wall(-0.05)),
                  constant = shade(make_bright_wall(-0.05), Shading::flat, TrianglePhase::constant);
  ASSERT_EQ(random.phase_keys.size(), random.triangles.size());
  for (size_t i = 0; i < random.triangles.size(); ++i)
    EXPECT_EQ(random.triangles[i].phase, float(random_phase(random.seed, 0, random.phase_keys[i])));
  EXPECT_TRUE(constant.phase_keys.empty());
  for (const Triangle& t : constant.triangles) EXPECT_EQ(t.phase, 0);
}

// A set for each wavelength, with the light of its colour: red light of a red wall, no blue.
TEST(ShadeTriangles, EachWavelengthHasItsColour) {
  Scene scene = make_bright_wall(-0.05);
  scene.materials[0].emission = {1, 0, 0};
  const auto sets =
      shade_triangles(scene, shaded_panel, {638e-9, 450e-9}, direct, Shading::flat, TrianglePhase::random);
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_EQ(sets[0].wavelength, 638e-9);
  EXPECT_FALSE(sets[0].triangles.empty());
  EXPECT_TRUE(sets[1].triangles.empty());
}

TEST(ShadeTriangles, TheSameOnAnyNumberOfThreads) {
  const auto on = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    TraceParams params = direct;
    params.paths = 3;
    std::vector<float> values;
    for (const Triangle& t : shade(sphere_before_wall(), Shading::smooth, TrianglePhase::random, params).triangles)
      values.insert(values.end(), {t.amplitudes[0], t.amplitudes[1], t.amplitudes[2], t.phase});
    return values;
  };
  const auto one = on(1);
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(one, on(5));
}

TEST(ShadeTriangles, WhatHasNoTrianglesIsRefusedOrWarnedOf) {
  Scene points;
  points.points = {{{0, 0, -0.05}}};
  EXPECT_EQ(error_of([&] { shade(points); }).substr(0, 57),
            "expected a scene with meshes for the method triangles, go");
  TraceParams tiled = direct;
  tiled.strategy = Strategy::tiled;
  EXPECT_EQ(error_of([&] { shade(make_bright_wall(), Shading::flat, TrianglePhase::random, tiled); }).substr(0, 69),
            "expected the strategy shared with the method triangles, got tiled; tr");
  Scene both = make_bright_wall(-0.05);
  both.points = points.points;
  Record heard;
  shade_triangles(both, shaded_panel, {green_light}, direct, Shading::flat, TrianglePhase::random, heard.observer);
  ASSERT_FALSE(heard.warnings.empty());
  EXPECT_EQ(heard.warnings[0].substr(0, 33), "1 luminous points are left out: t");
}

}  // namespace
}  // namespace holotrace
