#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/trace/geometry/accelerator.h"
#include "holotrace/trace/shared/sampling.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

TEST(Accelerator, HitsAreExactToAHundredthOfAWavelength) {
  // A tilted plane 0.3 m away: 2 triangles in the plane x·n = c, seen obliquely. Single precision would be wrong by
  // 30 nm; 1e-12 m is some 10 000 roundings of 0.3 m in double, far below a wavelength.
  const Vec3 centre{2_mm, -1_mm, -0.3}, u = normalize({1, 0, 0.5}) * 7e-3, v = normalize({0.1, 1, 0.3}) * 5e-3;
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_test_quad(centre, u, v)};
  const Vec3 normal = normalize(cross(u, v));
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    CounterRandom random(1, 0, uint64_t(i));
    const Ray ray{{}, view_direction(0.03 * (random.uniform() - 0.3), 0.03 * (random.uniform() - 0.5))};
    const double distance = dot(centre, normal) / dot(ray.direction, normal);
    const Accelerator accelerator(scene);
    const auto hit = accelerator.closest_hit(ray);
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(hit->distance, distance, 1e-12);
    EXPECT_NEAR(length(hit->point.position - ray.direction * distance), 0, 1e-12);
    EXPECT_GT(dot(hit->point.geometric_normal, -ray.direction), 0);
  }
  EXPECT_GT(hits, 100);
}

TEST(Accelerator, TrianglesWithoutAreaAreNotMet) {
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm), make_wall(-0.29, 10_mm, 10_mm)};
  // Three vertices on a slanted line across the view.
  scene.meshes[1].positions = {{-9_mm, -3_mm, -0.29}, {0, 0, -0.29}, {9_mm, 3_mm, -0.29}, {9_mm, 3_mm, -0.29}};
  for (int i = -800; i <= 800; ++i) {
    const Vec3 target{i * 1e-5, i * 1e-5 / 3, -0.29};
    const Accelerator accelerator(scene);
    const auto hit = accelerator.closest_hit({{}, normalize(target)});
    ASSERT_TRUE(hit);
    ASSERT_NEAR(hit->point.position.z, -0.3, 1e-12);
    ASSERT_TRUE(is_finite(hit->point.normal));
  }
}

TEST(Accelerator, InterpolatesNormalsAndTextureCoordinatesAndTurnsNormalsToTheViewer) {
  Scene scene;
  auto texture = std::make_shared<Image>(1, 1, 3);
  texture->values = {1, 1, 1};
  scene.materials = {DiffuseMaterial{.reflectance = {0.5, 0.5, 0.5}, .texture = texture}};
  Mesh quad = make_wall(-0.3, 10_mm, 10_mm);
  const Vec3 left = normalize({-1, 0, 1}), right = normalize({1, 0, 1});
  quad.normals = {left, right, right, left};
  scene.meshes = {quad};
  const Accelerator accelerator(scene);
  const auto front = accelerator.closest_hit({{5_mm, -5_mm, 0}, {0, 0, -1}});
  ASSERT_TRUE(front);
  // Positions inside a triangle come from Embree, in single precision: some 2⁻²³ of the triangle.
  EXPECT_NEAR(front->point.uv.x, 0.75, 1e-6);
  EXPECT_NEAR(front->point.uv.y, 0.25, 1e-6);
  const Vec3 expected = normalize(left * 0.25 + right * 0.75);
  EXPECT_NEAR(length(front->point.normal - expected), 0, 1e-6);
  const auto back = accelerator.closest_hit({{5_mm, -5_mm, -0.5}, {0, 0, 1}});
  ASSERT_TRUE(back);
  EXPECT_NEAR(length(back->point.normal + expected), 0, 1e-6);
  EXPECT_EQ(back->point.geometric_normal, (Vec3{0, 0, -1}));
}

TEST(Accelerator, OcclusionCountsWhatIsBetweenAndNotWhatIsAtTheEnds) {
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  const Accelerator accelerator(scene);
  EXPECT_TRUE(accelerator.is_occluded({0, 0, 0}, {0, 0, -0.31}));
  EXPECT_FALSE(accelerator.is_occluded({0, 0, 0}, {0, 0, -0.29}));
  EXPECT_FALSE(accelerator.is_occluded({0, 0, 0}, {1_mm, 2_mm, -0.3})) << "a point on the wall is seen";
  EXPECT_FALSE(accelerator.is_occluded({0, 0, 0}, {0.1, 0, -0.31})) << "beside the wall";
}

TEST(Accelerator, ALampFarAwayLeavesTheDetailAsItIs) {
  // Two walls of 2 mm, 10 µm apart. Single precision in a scene of 1 km resolves only 30 µm.
  const auto walls = [] {
    Scene scene;
    scene.materials = {grey(0.5)};
    scene.meshes = {make_wall(-0.1, 1_mm, 1_mm), make_wall(-0.1 + 10_um, 0.5_mm, 0.5_mm)};
    return scene;
  };
  Scene scene = walls();
  const double alone = Accelerator(scene).closest_hit({{0.2_mm, 0.3_mm, 0}, {0, 0, -1}})->point.clearance;
  // A lamp at the back of the view, 200 m wide, and a mesh as far away.
  scene.lights = {RectangleLight{{-100, -100, 1000}, {0, 200, 0}, {200, 0, 0}, {5, 5, 5}}};
  scene.meshes.push_back(make_test_quad({300, 0, -1000}, {10, 0, 0}, {0, 10, 0}));
  for (const Acceleration kind : {Acceleration::embree, Acceleration::grid}) {
    const Accelerator accelerator(scene, kind);
    for (int i = -9; i <= 9; ++i) {
      const double x = i * 0.1_mm, z = std::abs(i) < 5 ? -0.1 + 10_um : -0.1;
      if (std::abs(i) == 5) continue;  // the small wall's edge
      const auto hit = accelerator.closest_hit({{x, 0.1_mm, 0}, {0, 0, -1}});
      ASSERT_TRUE(hit);
      EXPECT_NEAR(hit->point.position.z, z, 1e-15) << i;
      EXPECT_LT(hit->point.clearance, 2 * alone);
      EXPECT_FALSE(accelerator.is_occluded({accelerator.leave(hit->point), {0, 0, 1}}, 1)) << i << " meets itself";
      // From the gap between the walls, a ray from the far wall does not get out.
      const Ray out{{x, 0.1_mm, -0.1 + 1_um}, {0, 0, 1}};
      EXPECT_EQ(accelerator.is_occluded(out, 1), std::abs(i) < 5) << i;
    }
  }
}

TEST(Accelerator, ALampInThePlaneOfAVastCeilingIsMetBeforeIt) {
  // Slanted, so that coordinates are rounded: single precision represents the ceiling's corners, 1 km away, to 30 µm.
  const Vec3 u = normalize({1, 0, 0.3}), v = normalize({0, 1, 0.2}), centre{0, 0, -0.2};
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_test_quad(centre + u * 20 + v * 30, u * 1000, v * 900)};
  const Vec3 half_u = u * 10_mm, half_v = v * 10_mm;
  scene.lights = {RectangleLight{centre - half_u - half_v, half_u * 2, half_v * 2, {5, 5, 5}}};
  const Accelerator accelerator(scene);
  for (int i = 0; i < 200; ++i) {
    CounterRandom random(4, 0, uint64_t(i));
    const double x = 6_mm * (2 * random.uniform() - 1), y = 6_mm * (2 * random.uniform() - 1);
    const auto hit = accelerator.closest_hit({{x, y, 0}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    ASSERT_EQ(hit->point.light, 0) << x << ", " << y;
  }
}

TEST(Accelerator, NoRayAimedAtAnEdgeAndFewRandomRaysPassBetweenTriangles) {
  Scene scene;
  scene.materials = {grey(0.5)};
  const Vec3 centre{0, 0, -0.3}, from = centre + Vec3{0.11e-3, -0.07e-3, 0.05e-3};  // off the symmetries of the sphere
  scene.meshes = {make_round_mesh(centre, 1e-3, 40)};
  const Mesh& mesh = scene.meshes[0];
  const Accelerator accelerator(scene);
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 a = mesh.positions[i], b = mesh.positions[j], c = mesh.positions[k];
    for (const Vec3 target : {(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (2 * a + b) / 3.0}) {
      const Ray ray{from, normalize(target - from)};
      ASSERT_TRUE(accelerator.closest_hit(ray));
      ASSERT_TRUE(accelerator.is_occluded(ray, 1));
    }
  }
  // Places are rounded to some 1e-7 of the radius, and gaps are at most that wide. 9600 edges of about 0.08 radii are
  // 770 radii long, so gaps cover less than 1e-5 of the 4π radii²: two of 200,000 rays. Ten would be a fault.
  int passed = 0;
  for (int i = 0; i < 200'000; ++i) {
    CounterRandom random(1, 0, uint64_t(i));
    const double z = 2 * random.uniform() - 1, angle = 2 * pi * random.uniform(), r = std::sqrt(1 - z * z);
    const Ray ray{from, {r * std::cos(angle), r * std::sin(angle), z}};
    passed += !accelerator.closest_hit(ray, Aim::random) || !accelerator.is_occluded(ray, 1, Aim::random);
  }
  EXPECT_LE(passed, 10);
}

// Some rays end at a place near a surface. Whether they meet it depends on the rounding of their end, 1e-7 m here. Embree asks for
// rays of a packet and single ones in the same numbers; few triangles are asked in others, so that rays end at least 3e-7 m before
// or after the surface there.
void expect_occluded_as_single_ones(const Scene& scene, double nearest_end) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const Acceleration kind : {Acceleration::embree, Acceleration::grid}) {
    const Accelerator accelerator(scene, kind);
    CounterRandom random(2, 0, 0);
    int hidden = 0, seen = 0;
    for (int trial = 0; trial < 600; ++trial) {
      // Some start in front of everything, outside the sphere around the scene; some inside the round mesh.
      LaneVectors origin, direction;
      Lane distance;
      const auto number = [&] { return 2 * random.uniform() - 1; };
      for (size_t i = 0; i < most_together; ++i) {
        const double x = number(), y = number(), z = number();
        origin.set(i, Vec3{x, y, i % 2 ? z : 0} * 30_mm - Vec3{0, 0, i % 2 ? 0.32 : 0});
        direction.set(i, normalize(Vec3{number() * 0.2, number() * 0.2, i % 2 ? number() : -1}));
        distance[i] = i % 3 == 0 ? infinity : trial % 5 ? random.uniform() * 0.4 : 1e-9;
        if (i % 3 < 2) continue;
        const auto hit = accelerator.closest_hit({origin[i], direction[i]}, Aim::random);
        const double beside = number() * 3e-7;
        if (hit) distance[i] = hit->distance + beside + std::copysign(nearest_end, beside);
      }
      const auto asked = uint32_t(random.uniform() * 0x1p16);
      uint32_t expected = 0;
      for (size_t i = 0; i < most_together; ++i)
        if (asked >> i & 1)
          expected |= uint32_t(accelerator.is_occluded({origin[i], direction[i]}, distance[i], Aim::random)) << i;
      for (const bool are_near : {true, false})
        for (const std::string& name : instruction_sets()) {
          const OnInstructionSet only(name);
          EXPECT_EQ(accelerator.occluded({origin, direction, distance}, asked, Aim::random, are_near), expected)
              << name << ", trial " << trial;
        }
      hidden += std::popcount(expected), seen += std::popcount(asked & ~expected);
    }
    EXPECT_GT(hidden, 300);
    EXPECT_GT(seen, 300);
  }
}

TEST(Accelerator, RaysAskedTogetherAreOccludedAsSingleOnesOnEveryInstructionSet) {
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_round_mesh({0, 0, -0.3}, 20_mm, 12), make_wall(-0.35, 10_mm, 10_mm)};
  expect_occluded_as_single_ones(scene, 0);

  Scene small = make_box_scene({0, 0, -0.3}, {20_mm, 15_mm, 25_mm}, grey(0.5));
  small.meshes.push_back(make_test_quad({2_mm, 0, -0.29}, {9_mm, 2_mm, 0}, {0, 8_mm, 5_mm}));
  small.lights = {RectangleLight{{-9_mm, 6_mm, -0.31}, {8_mm, 0, 0}, {0, 0, 6_mm}, {1, 1, 1}}};
  expect_occluded_as_single_ones(small, 3e-7);
}

// In a scene with trees, in one of few triangles, and in a grid: the same hits as by single aimed rays, but where rounding decides.
TEST(Accelerator, RaysAskedTogetherMeetWhatSingleOnesMeet) {
  Scene many = make_box_scene({0, 0, -0.3}, {20_mm, 15_mm, 25_mm}, grey(0.5)), few = many;
  many.meshes.push_back(make_round_mesh({0, 0, -0.3}, 8_mm, 12));
  const Mesh leaning = make_test_quad({2_mm, 0, -0.29}, {9_mm, 2_mm, 0}, {0, 8_mm, 5_mm});
  few.meshes.push_back(leaning);
  for (const Scene* scene : {&many, &few})
    for (const Acceleration kind : {Acceleration::embree, Acceleration::grid}) {
      const Accelerator accelerator(*scene, kind);
      CounterRandom random(4, 0, 0);
      int met = 0, missed = 0, differ = 0;
      for (int trial = 0; trial < 300; ++trial) {
        LaneVectors origin, direction;
        const auto number = [&] { return 2 * random.uniform() - 1; };
        const double x = number(), y = number(), z = number();
        for (size_t i = 0; i < most_together; ++i) {
          // From the panel, or from inside of the box.
          origin.set(i, trial % 3 ? Vec3{18_mm * x, 14_mm * y, 24_mm * z - 0.3} : Vec3{4_mm * x, 4_mm * y, 0});
          direction.set(i, normalize(trial % 3 ? Vec3{number(), number(), number()}
                                               : Vec3{0.12 * number(), 0.12 * number(), -1}));
        }
        const auto asked = uint32_t(random.uniform() * 0x1p16);
        for (const bool are_near : {true, false}) {
          std::array<Hit, most_together> hits;
          const uint32_t found =
              accelerator.closest_hits({origin, direction, without_end}, asked, Aim::random, are_near, hits);
          EXPECT_EQ(found & ~asked, 0U);
          for (size_t i = 0; i < most_together; ++i) {
            if (!(asked >> i & 1)) continue;
            const auto single = accelerator.closest_hit({origin[i], direction[i]});
            if (!single || !(found >> i & 1)) {
              differ += bool(single) != bool(found >> i & 1);
              ++missed;
              continue;
            }
            ++met;
            // At an edge either of two triangles is found; they meet there to 2e-7 of the distance from the centre.
            const bool is_same = hits[i].point.mesh == single->point.mesh;
            differ += !is_same;
            if (!is_same) continue;
            EXPECT_NEAR(hits[i].distance, single->distance, 1e-9);
            EXPECT_LT(length(hits[i].point.position - single->point.position), 1e-9);
          }
        }
      }
      EXPECT_GT(met, 2000);
      EXPECT_GT(missed, 50);
      EXPECT_LE(differ, 2);
    }
}

TEST(Accelerator, RandomRaysMeetTheSameSurfacesAsAimedOnes) {
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_round_mesh({1_mm, 0, -0.3}, 4e-3, 30), make_wall(-0.31, 5_mm, 5_mm),
                  make_round_mesh({-3_mm, 1_mm, -0.29}, 1e-3, 100)};
  const Accelerator accelerator(scene);
  int hits = 0, differ = 0;
  for (int i = 0; i < 20'000; ++i) {
    CounterRandom random(2, 0, uint64_t(i));
    const Ray ray{{}, view_direction(0.04 * (random.uniform() - 0.5), 0.04 * (random.uniform() - 0.5))};
    const auto aimed = accelerator.closest_hit(ray), drawn = accelerator.closest_hit(ray, Aim::random);
    differ += accelerator.is_occluded(ray, 0.3) != accelerator.is_occluded(ray, 0.3, Aim::random);
    if (!aimed || !drawn) {
      differ += bool(aimed) != bool(drawn);
      continue;
    }
    ++hits;
    // Both trees may name either of two triangles at an edge; their planes meet there to the rounding of single precision.
    EXPECT_NEAR(aimed->distance, drawn->distance, 1e-9);
    EXPECT_EQ(aimed->point.mesh, drawn->point.mesh);
  }
  EXPECT_LE(differ, 2) << "one ray in a million may pass between two triangles";
  EXPECT_GT(hits, 10'000);
}

// A point 5 mm in front of the panel, at x = 1 mm, is seen through the panel's middle by viewers at x = 2 mm, z = 10 mm and beyond.
TEST(Accelerator, WhatIsBeforeAPointInFrontOfThePanelHidesIt) {
  const auto is_hidden = [](double x, double z) {
    Scene scene;
    scene.materials = {grey(0.5)};
    scene.meshes = {make_test_quad({x, 0, z}, {0.3_mm, 0, 0}, {0, 0.3_mm, 0}),
                    make_test_quad({30_mm, 0, 12_mm}, {0.3_mm, 0, 0}, {0, 0.3_mm, 0})};
    return Accelerator(scene).is_hidden({}, {1_mm, 0, 5_mm});
  };
  EXPECT_TRUE(is_hidden(2_mm, 10_mm));
  EXPECT_FALSE(is_hidden(0, 10_mm));
  EXPECT_FALSE(is_hidden(0.5_mm, 2.5_mm));  // between panel and point: the viewer is on the other side
  EXPECT_FALSE(is_hidden(-1_mm, -5_mm));
}

TEST(Accelerator, RefusesWhatItCannotTrace) {
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  const auto sentence = [&](const std::function<void(Scene&)>& spoil) {
    Scene bad = scene;
    spoil(bad);
    const Accelerator accelerator(scene);
    return error_of([&] { Accelerator accelerator(bad); });
  };
  EXPECT_EQ(sentence([](Scene& s) {
              s.lights = {RectangleLight{{}, {1, 0, 0}, {2, 0, 0}, {1, 1, 1}}};
            }),
            "expected edges of light 0 that span an area, got 0 m²");
  EXPECT_EQ(sentence([](Scene& s) {
              s.lights = {PointLight{{}, {1, -1, 1}}};
            }),
            "expected an intensity of 0 W/sr or more in light 0, got (1, -1, 1)");
  EXPECT_EQ(sentence([](Scene& s) {
              s.background = {0, 0, -1};
            }),
            "expected a background of 0 W/m²/sr or more, got (0, 0, -1)");
  EXPECT_EQ(sentence([](Scene& s) {
              s.materials = {DiffuseMaterial{{1, 1, 1}, std::make_shared<Image>(2, 2, 3), {}}};
              s.meshes[0].texture_coordinates.clear();
            }),
            "expected texture coordinates in mesh \"quad\", whose material has a texture, got none; add them or use a "
            "material without a texture");
  EXPECT_EQ(sentence([](Scene& s) {
              s.materials = {DiffuseMaterial{{1, 1, 1}, std::make_shared<Image>(2, 2, 2), {}}};
            }),
            "expected a texture of at least 1 × 1 pixels with 1 or 3 channels in material 0, got 2 × 2 with 2");
  EXPECT_EQ(sentence([](Scene& s) {
              s.meshes[0].positions.assign(4, {0, 0, -0.3});
            }),
            "expected meshes that fill some space, got all vertices in one place");
}

// A wall of opacity 0.3 before an opaque one, in each structure and asked together or one by one. Of n rays, 0.3·n ± 4·√(0.21·n) stop at
// the first.
TEST(Accelerator, ASurfaceStopsAsManyRaysAsItsOpacitySays) {
  Scene scene;
  scene.materials = {grey(0.5), grey(0.5)};
  scene.materials[1].opacity = 0.3;
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm), make_wall(-0.2, 50_mm, 50_mm, 1)};
  Scene many = scene;  // more than FewTriangles has
  many.meshes.push_back(make_round_mesh({0, 0, 0.5}, 10_mm, 16));
  const auto few_and_many = std::array{&scene, &many};
  for (const Scene* one : few_and_many)
    for (const Acceleration kind : {Acceleration::embree, Acceleration::grid}) {
      const Accelerator accelerator(*one, kind);
      CounterRandom random(7, 0, 0);
      int stopped = 0, rays = 0;
      for (int trial = 0; trial < 500; ++trial) {
        LaneVectors origin, direction;
        for (size_t i = 0; i < most_together; ++i) {
          origin.set(i, {});
          direction.set(i, normalize({0.2 * (random.uniform() - 0.5), 0.2 * (random.uniform() - 0.5), -1}));
        }
        std::array<Hit, most_together> hits;
        Lane between, beyond;
        between.fill(0.25), beyond.fill(0.4);
        constexpr uint32_t all = (1U << most_together) - 1;
        const Lane without_end = [] {
          Lane lane;
          lane.fill(std::numeric_limits<double>::infinity());
          return lane;
        }();
        EXPECT_EQ(accelerator.closest_hits({origin, direction, without_end}, all, Aim::random, true, hits), all);
        const uint32_t occluded = accelerator.occluded({origin, direction, between}, all, Aim::random, true);
        EXPECT_EQ(accelerator.occluded({origin, direction, beyond}, all, Aim::random, true), all);
        for (size_t i = 0; i < most_together; ++i) {
          const Ray ray{origin[i], direction[i]};
          const bool is_first = hits[i].point.mesh == 1;
          stopped += is_first;
          ++rays;
          EXPECT_NEAR(hits[i].distance * -ray.direction.z, is_first ? 0.2 : 0.3, 1e-9);
          EXPECT_EQ(occluded >> i & 1, uint32_t(is_first));
          EXPECT_EQ(accelerator.is_occluded(ray, 0.25), is_first);
          const auto alone = accelerator.closest_hit(ray);
          ASSERT_TRUE(alone);
          EXPECT_EQ(alone->point.mesh, hits[i].point.mesh);
          EXPECT_NEAR(alone->distance, hits[i].distance, 1e-12);
        }
      }
      EXPECT_NEAR(stopped, 0.3 * rays, 4 * std::sqrt(0.21 * rays));
    }
}

// The left half of the picture is 0.4, the right half 0.6; a cutoff of 0.5 makes them 0 and 1. Bilinear filtering blends the middle.
TEST(Accelerator, AMaskHasSharpEdges) {
  auto picture = std::make_shared<Image>(1, 2, 1);
  picture->values = {0.4F, 0.6F};
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.materials[0].opacity_texture = picture;
  scene.materials[0].opacity_cutoff = 0.5;
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  const Accelerator accelerator(scene);
  for (int i = -90; i < 90; ++i) {
    if (std::abs(i) < 2 || std::abs(i) > 88) continue;  // the borders of the picture repeat it
    const double x = i * 1e-4 + 3e-5;
    const bool is_right = x > 0;
    // Between the middles of both pixels, x = ±5 mm, the opacity rises through 0.5 at 0; outside it falls back to 0.5 at the border.
    EXPECT_EQ(accelerator.closest_hit({{}, normalize({x, 0.0, -0.3})}).has_value(), is_right) << x;
  }
}

// A mesh of more than a million triangles that differ has no maps: its texture is asked at each place. The left half is open.
TEST(Accelerator, ATextureOnVeryManyTrianglesStopsTheSameRays) {
  constexpr uint32_t side = 708;
  Scene scene;
  scene.materials = {grey(0.5)};
  auto picture = std::make_shared<Image>(1, 2, 1);
  (*picture)(0, 1) = 1;
  picture->sampling.is_stepped = true;
  scene.materials[0].opacity_texture = picture;
  Mesh& mesh = scene.meshes.emplace_back();
  for (uint32_t j = 0; j <= side; ++j)
    for (uint32_t i = 0; i <= side; ++i) {
      const double u = double(i) / side, v = double(j) / side;
      mesh.positions.push_back({(u - 0.5) * 20_mm, (v - 0.5) * 20_mm, -0.3});
      mesh.texture_coordinates.push_back({u, v});
    }
  for (uint32_t j = 0; j < side; ++j)
    for (uint32_t i = 0; i < side; ++i) {
      const uint32_t k = j * (side + 1) + i, above = k + side + 1;
      mesh.triangles.push_back({k, k + 1, above + 1});
      mesh.triangles.push_back({k, above + 1, above});
    }
  ASSERT_GT(mesh.triangles.size(), 1'000'000U);
  const Accelerator accelerator(scene);
  for (const double x : {-9_mm, -1_mm, 1_mm, 9_mm})
    EXPECT_EQ(accelerator.closest_hit({{x, 1_mm, 0}, {0, 0, -1}}).has_value(), x > 0) << x;
}

// A wall of 8 × 8 squares, each open, closed or of opacity 0.3, as a texture that repeats twice each way: open ones stop no ray, closed
// ones all, and the others 0.3·n ± 4·√(0.21·n), or all or none if that is asked for.
TEST(Accelerator, ATextureStopsTheRaysThatItsOpacitySays) {
  constexpr std::array squares{0.F, 1.F, 0.3F, 1.F, 1.F, 0.F, 0.F, 0.3F, 0.3F, 0.3F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.3F};
  constexpr int side = 16;  // of a square in texels
  auto picture = std::make_shared<Image>(4 * side, 4 * side, 1);
  for (int j = 0; j < 4 * side; ++j)
    for (int i = 0; i < 4 * side; ++i) (*picture)(j, i) = squares[size_t(4 * (j / side) + i / side)];
  picture->sampling.is_stepped = true;
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.materials[0].opacity_texture = picture;
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  for (Vec2& uv : scene.meshes[0].texture_coordinates) uv = uv * 2;
  for (const Acceleration kind : {Acceleration::embree, Acceleration::grid}) {
    const Accelerator accelerator(scene, kind);
    CounterRandom random(8, 0, 0);
    int between = 0, stopped = 0;
    for (int n = 0; n < 4000; ++n) {
      const double u = 8 * random.uniform(), v = 8 * random.uniform();                         // in squares
      if (std::abs(u - std::round(u)) < 1e-3 || std::abs(v - std::round(v)) < 1e-3) continue;  // rounding decides
      const Ray ray{{}, normalize({(u - 4) * 2.5_mm, (v - 4) * 2.5_mm, -0.3})};
      const double opacity = double(squares[size_t(4 * (3 - int(v) % 4) + int(u) % 4)]);
      const auto stops = [&](Veils veils) { return accelerator.closest_hit(ray, Aim::exact, veils).has_value(); };
      EXPECT_EQ(stops({Veils::Kind::met}), opacity > 0);
      EXPECT_EQ(stops({Veils::Kind::passed}), opacity == 1);
      const auto hit = accelerator.closest_hit(ray);
      EXPECT_EQ(accelerator.is_occluded(ray, 1), hit.has_value());
      if (hit) {
        EXPECT_NEAR(hit->point.uv.x, u / 4, 1e-6);  // of Embree's single precision
        EXPECT_NEAR(hit->point.uv.y, v / 4, 1e-6);
      }
      if (opacity == 0 || opacity == 1) {
        EXPECT_EQ(hit.has_value(), opacity == 1);
      } else {
        ++between;
        stopped += hit.has_value();
      }
    }
    EXPECT_NEAR(stopped, 0.3 * between, 4 * std::sqrt(0.21 * between));
  }
}

}  // namespace
}  // namespace holotrace
