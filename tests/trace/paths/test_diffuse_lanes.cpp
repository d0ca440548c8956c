// Samples of a rectangle in vector lanes, against the functions for single samples.

#include <gtest/gtest.h>

#include "holotrace/base/instruction_set.h"
#include "holotrace/base/random.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/diffuse_bsdf.h"
#include "holotrace/trace/paths/path_weights.h"
#include "holotrace/trace/paths/rectangle_samples.h"

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

struct OneSample {
  Vec3 direction;
  double distance = 0, share = 0;
};

// As direct_light.h has it. A lamp's shadow ray ends before the lamp by its lift and by 2e-6 of the distance of its
// corners, more at grazing angles.
OneSample sample_one(const RectangleAndSurface& pair, Vec2 u) {
  const RectangleLight light{pair.corner, pair.edge_u, pair.edge_v, {1, 1, 1}, pair.is_visible};
  const LightSample way = sample_light(light, {}, u);
  if (way.radiance.x == 0) return {};
  const DiffuseBsdf surface{pair.normal, pair.geometric_normal, {1, 1, 1}, {}};
  const double f = eval(surface, {}, way.direction, Lobe::diffuse).x;
  OneSample one{way.direction, way.distance - pair.clearance,
                f / way.pdf * shared_weight(way.pdf, pdf(surface, {}, way.direction, Lobe::diffuse))};
  if (pair.is_visible) {
    const Vec3 end = way.direction * way.distance, rest = end - pair.geometric_normal * pair.clearance;
    one.direction = rest / length(rest);
    one.distance =
        length(rest) - (pair.lift + 2e-6 * (length(end - pair.centre) + way.size)) / std::max(way.cosine, 0.01);
  }
  return one;
}

TEST(RectangleSamples, AreThoseOfSinglePathsOnEveryInstructionSet) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    Numbers numbers;
    int lit = 0, behind = 0;
    for (int trial = 0; trial < 200; ++trial) {
      RectangleAndSurface pair{.corner = numbers.vector(1), .edge_u = numbers.vector(1), .edge_v = numbers.vector(1)};
      pair.is_visible = trial % 2 == 0;
      pair.lift = 1e-5;
      pair.normal = normalize(numbers.vector(1));
      pair.geometric_normal = normalize(pair.normal + numbers.vector(0.5));
      pair.clearance = 2e-5;
      pair.centre = numbers.vector(0.1);
      std::array<uint32_t, most_shadow_rays> u, v;
      for (uint32_t& bits : u) bits = numbers.bits();
      for (uint32_t& bits : v) bits = numbers.bits();
      u[0] = 0, v[1] = 0xffffffff;
      RectangleSamples samples;
      sample_rectangle(pair, u.data(), v.data(), samples);
      for (size_t i = 0; i < u.size(); ++i) {
        const OneSample one = sample_one(pair, {u[i] * 0x1p-32, v[i] * 0x1p-32});
        ASSERT_NEAR(samples.share[i], one.share, 1e-12 * one.share) << name << ", trial " << trial;
        const Vec3 to = Vec3{samples.x[i], samples.y[i], samples.z[i]} * samples.distance[i];
        if (one.share == 0) {
          ++behind;
          continue;
        }
        ++lit;
        // Rounding of a few sums of numbers of order 1; at grazing angles of a hundredth a hundred times as much.
        EXPECT_NEAR(samples.distance[i], one.distance, 1e-13);
        EXPECT_LT(length(to - one.direction * one.distance), 1e-13);
      }
    }
    EXPECT_GT(lit, 300);
    EXPECT_GT(behind, 300);
  }
}

}  // namespace
}  // namespace holotrace
