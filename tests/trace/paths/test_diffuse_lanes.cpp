// What paths do on diffuse surfaces in vector lanes, against the functions for single paths.

#include <gtest/gtest.h>

#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/trace/lights/emitters.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/diffuse_bsdf.h"
#include "holotrace/trace/paths/diffuse_lanes.h"
#include "holotrace/trace/paths/path.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

class Numbers {
 public:
  double operator()(double most) { return most * (2 * random_.uniform() - 1); }
  Vec3 vector(double most) {
    const double x = (*this)(most), y = (*this)(most), z = (*this)(most);
    return {x, y, z};
  }
  uint32_t bits() { return uint32_t(random_.uniform() * 0x1p32); }

 private:
  CounterRandom random_{5, 0, 0};
};

// Fewer than the lanes in each third trial.
DiffuseSurfaces random_surfaces(int trial, Numbers& numbers) {
  DiffuseSurfaces at;
  at.count = trial % 3 == 0 ? 13 : most_together;
  for (size_t i = 0; i < most_together; ++i) {
    const Vec3 position = numbers.vector(1), normal = normalize(numbers.vector(1));
    const Vec3 geometric_normal = normalize(normal + numbers.vector(0.5));
    at.position.set(i, position);
    at.normal.set(i, normal);
    at.geometric_normal.set(i, geometric_normal);
    at.clearance[i] = 2e-5 + 1e-6 * double(i);
    at.start.set(i, position + geometric_normal * at.clearance[i]);
  }
  return at;
}

struct OneSample {
  Vec3 direction;
  double distance = 0, share = 0;
};

// As direct_light.h has it. A lamp's shadow ray ends before the lamp by its lift and by 2e-6 of the distance of its
// corners, more at grazing angles.
OneSample finish_one(const DiffuseSurfaces& at, size_t i, const LightSample& way, double lift, Vec3 centre) {
  if (way.radiance.x == 0) return {};
  const DiffuseBsdf surface{at.normal[i], at.geometric_normal[i], {1, 1, 1}, {}};
  const double f = eval(surface, {}, way.direction, Lobe::diffuse).x;
  OneSample one{way.direction, way.distance - at.clearance[i],
                f / way.pdf * shared_weight(way.pdf, pdf(surface, {}, way.direction, Lobe::diffuse))};
  if (way.cosine > 0) {
    const Vec3 end = at.position[i] + way.direction * way.distance, rest = end - at.start[i];
    one.direction = rest / length(rest);
    one.distance = length(rest) - (lift + 2e-6 * (length(end - centre) + way.size)) / std::max(way.cosine, 0.01);
  }
  return one;
}

struct Found {
  int lit = 0, unlit = 0;

  void expect_many_of_both() const {
    EXPECT_GT(lit, 300);
    EXPECT_GT(unlit, 300);
  }
};

void expect_same(const LightSamples& samples, size_t i, const OneSample& one, Found& found) {
  ASSERT_NEAR(samples.share[i], one.share, 1e-12 * one.share);
  ++(one.share == 0 ? found.unlit : found.lit);
  if (one.share == 0) return;
  // Rounding of a few sums of numbers of order 1; at grazing angles of a hundredth a hundred times as much.
  EXPECT_NEAR(samples.distance[i], one.distance, 1e-13);
  EXPECT_LT(length(samples.direction[i] * samples.distance[i] - one.direction * one.distance), 1e-13);
}

// way_of(i) is the sample of path i by itself.
template <class WayOf>
void expect_as_one_by_one(const DiffuseSurfaces& at, const LightLanes& lanes, const PlaceLanes& places, Vec3 centre,
                          Found& found, const WayOf& way_of) {
  LightSamples samples;
  sample_lights(at, lanes, places, centre, samples);
  for (size_t i = 0; i < size_t(at.count); ++i)
    expect_same(samples, i, finish_one(at, i, way_of(i), lanes.lift, centre), found);
}

TEST(DiffuseLanes, OfARectangleAreThoseOfSinglePathsOnEveryInstructionSet) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    Numbers numbers;
    Found found;
    for (int trial = 0; trial < 200; ++trial) {
      const DiffuseSurfaces at = random_surfaces(trial, numbers);
      const RectangleLight light{numbers.vector(1), numbers.vector(1), numbers.vector(1), {1, 1, 1}, trial % 2 == 0};
      const LightLanes lanes = lanes_of(light, 1e-5);
      PlaceLanes places;
      for (size_t i = 0; i < most_together; ++i) places.set(i, {numbers.bits() * 0x1p-32, numbers.bits() * 0x1p-32});
      places.u[0] = 0, places.v[1] = 1 - 0x1p-32;
      SCOPED_TRACE(name + ", trial " + std::to_string(trial));
      expect_as_one_by_one(at, lanes, places, numbers.vector(0.1), found, [&](size_t i) {
        return sample_light(light, at.position[i], {places.u[i], places.v[i]});
      });
    }
    found.expect_many_of_both();
  }
}

TEST(DiffuseLanes, OfEmissiveTrianglesAreThoseOfSinglePathsOnEveryInstructionSet) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    Numbers numbers;
    Found found;
    for (int trial = 0; trial < 200; ++trial) {
      const DiffuseSurfaces at = random_surfaces(trial, numbers);
      Scene scene;  // a one-sided and a two-sided lamp, of different power and shape
      scene.materials = {grey(0.5, 1), grey(0.5, 7)};
      scene.materials[1].two_sided = false;
      scene.meshes = {make_test_quad(numbers.vector(1), numbers.vector(1), numbers.vector(1), 0),
                      make_test_quad(numbers.vector(1), numbers.vector(1), numbers.vector(1), 1)};
      const EmissiveTriangles lamps(scene, Lines{});
      ASSERT_TRUE(lamps.are_even());
      LightLanes lanes;
      lanes.are_triangles = true;
      PlaceLanes places;
      std::array<Vec2, most_together> u;
      for (size_t i = 0; i < u.size(); ++i) {
        u[i] = {numbers.bits() * 0x1p-32, numbers.bits() * 0x1p-32};
        lamps.select(u[i], i, lanes, places);
      }
      SCOPED_TRACE(name + ", trial " + std::to_string(trial));
      expect_as_one_by_one(at, lanes, places, numbers.vector(0.1), found, [&](size_t i) {
        const LightSample way = lamps.sample(at.position[i], u[i]);
        if (way.radiance.x > 0) {
          EXPECT_EQ(lanes.radiance[i], way.radiance);
        }
        return way;
      });
    }
    found.expect_many_of_both();
  }
}

// All of its light comes by sampling, weight 1: f·cosθ·I/d². A surface at the light gets none.
TEST(DiffuseLanes, OfAPointLightAreThoseOfSinglePathsOnEveryInstructionSet) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    Numbers numbers;
    Found found;
    for (int trial = 0; trial < 200; ++trial) {
      DiffuseSurfaces at = random_surfaces(trial, numbers);
      const PointLight light{numbers.vector(1), {1, 2, 3}};
      at.position.set(5, light.position);
      LightSamples samples;
      sample_lights(at, lanes_of(light), {}, numbers.vector(0.1), samples);
      SCOPED_TRACE(name + ", trial " + std::to_string(trial));
      for (size_t i = 0; i < size_t(at.count); ++i) {
        const LightSample way = sample_light(light, at.position[i], {});
        const DiffuseBsdf surface{at.normal[i], at.geometric_normal[i], {1, 1, 1}, {}};
        const double light_of_one = way.radiance.x * eval(surface, {}, way.direction, Lobe::diffuse).x;
        expect_same(samples, i, {way.direction, way.distance - at.clearance[i], light_of_one}, found);
      }
    }
    found.expect_many_of_both();
  }
}

// From so near its plane the density of a place is above the largest number, and its weight would be ∞/∞.
TEST(DiffuseLanes, ARectangleSeenEdgeOnIsDarkOnEveryInstructionSet) {
  const LightLanes lanes = lanes_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}, true}, 1e-5);
  PlaceLanes places;
  for (size_t i = 0; i < most_together; ++i) places.set(i, {double(i) / most_together, 0.5});
  DiffuseSurfaces at;
  at.count = most_together;
  at.position.fill({2, 0, 1e-310});
  at.start.fill({2, 0, 1e-310});
  at.normal.fill({-1, 0, 0});
  at.geometric_normal.fill({-1, 0, 0});
  at.clearance.fill(0);
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    LightSamples samples;
    sample_lights(at, lanes, places, {}, samples);
    for (size_t i = 0; i < most_together; ++i) EXPECT_EQ(samples.share[i], 0) << name << ", path " << i;
  }
}

TEST(DiffuseLanes, DirectionsAreThoseOfSinglePathsOnEveryInstructionSet) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    Numbers numbers;
    int outside = 0, inside = 0;
    for (int trial = 0; trial < 200; ++trial) {
      const DiffuseSurfaces at = random_surfaces(trial, numbers);
      std::array<uint32_t, most_together> u, v;
      for (uint32_t& bits : u) bits = numbers.bits();
      for (uint32_t& bits : v) bits = numbers.bits();
      u[0] = 0, u[1] = 0xffffffff;
      for (uint32_t eighth = 0; eighth < 8; ++eighth) v[eighth] = eighth << 29;  // ends and middles of all quarters
      v[8] = 0xffffffff;
      DiffuseSamples samples;
      sample_directions(at, u.data(), v.data(), samples);
      for (size_t i = 0; i < size_t(at.count); ++i) {
        const DiffuseBsdf surface{at.normal[i], at.geometric_normal[i], {1, 1, 1}, {}};
        const auto one = sample(surface, {}, 0, {u[i] * 0x1p-32, v[i] * 0x1p-32});
        ++(one ? outside : inside);
        // Rounding of a few products of numbers up to 1.
        ASSERT_NEAR(samples.pdf[i], one ? one->pdf : 0, 2e-15) << name << ", trial " << trial;
        if (one) {
          ASSERT_LT(length(samples.direction[i] - one->direction), 4e-15);
        }
      }
    }
    EXPECT_GT(outside, 300);
    EXPECT_GT(inside, 30);
  }
}

}  // namespace
}  // namespace holotrace
