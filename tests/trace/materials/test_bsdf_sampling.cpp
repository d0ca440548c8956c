#include <gtest/gtest.h>

#include "holotrace/base/random.h"
#include "support/statistics.h"
#include "trace/surfaces.h"

// The directions that a BSDF draws compared with its stated density, for every lobe.

namespace holotrace {
namespace {

constexpr double level = 0.01;  // probability that correct samplers fail somewhere in one test (the seed is fixed)

/// Directions of one lobe on one side.
struct Draws {
  CounterRandom random;
  const Bsdf& bsdf;
  Vec3 outgoing;
  Lobe lobe;
  bool is_transmission;

  std::optional<Vec3> operator()() {
    const double u_lobe = random.uniform(), u = random.uniform();
    const auto way = sample_bsdf(bsdf, outgoing, u_lobe, {u, random.uniform()});
    if (!way || way->lobe != lobe || way->is_transmission != is_transmission) return std::nullopt;
    return way->direction;
  }
};

/// A map with small cells where the directions are: around their middle or, if they are widely spread, around the
/// normal, whose horizon is then a line of cells. No map if there are no directions.
std::optional<SphereMap> map_of(Draws draws) {
  std::vector<Vec3> directions;
  Vec3 sum;
  for (int i = 0; i < 2000; ++i)
    if (const auto direction = draws()) {
      directions.push_back(*direction);
      sum += *direction;
    }
  if (directions.empty()) return std::nullopt;
  const Vec3 middle = normalize(sum);
  double spread = 0;
  for (Vec3 d : directions) spread += (1 - dot(d, middle)) / 2 / double(directions.size());
  return spread > 0.05 ? SphereMap({0, 0, 1}, 1e6) : SphereMap(middle, spread);
}

void expect_sampler_of(const std::vector<NamedSurface>& surfaces, int draws_of_each = 100000, int midpoints = 16) {
  const int tests = 2 * int(surfaces.size()) * int(std::size(view_angles));
  for (const NamedSurface& surface : surfaces)
    for (double angle : view_angles)
      for (Lobe lobe : {Lobe::diffuse, Lobe::glossy})
        for (bool is_transmission : {false, true}) {
          const Vec3 outgoing = view_direction_at(angle);
          const Draws draws{CounterRandom(7, 0, uint64_t(angle * 100)), surface.bsdf, outgoing, lobe, is_transmission};
          const auto map = map_of(draws);
          if (!map) continue;
          const LobeSet set = lobes_of(surface.bsdf);
          EXPECT_TRUE(lobe == Lobe::diffuse ? set.has_diffuse : set.has_glossy) << surface.name;
          const auto density = [&](Vec3 incoming) {
            return (incoming.z < 0) == is_transmission ? pdf_bsdf(surface.bsdf, outgoing, incoming, lobe) : 0;
          };
          const SphereTest test = test_sphere_sampling(*map, draws_of_each, Draws(draws), density, midpoints);
          EXPECT_GT(test.chi_square.p_value, sidak_level(level, tests))
              << surface.name << " at " << angle << "°, lobe " << int(lobe) << ", transmission " << is_transmission
              << ": χ² " << test.chi_square.statistic << " of " << test.chi_square.degrees_of_freedom << " degrees";
          // The density integrates to 1 less the specular part, rejected directions and other lobes. 4.5 standard
          // errors are exceeded once in 150,000 cases.
          EXPECT_LT(test.deviation, 4.5) << surface.name << " at " << angle << "°, transmission " << is_transmission
                                         << ": drawn " << test.drawn << ", integral " << test.integral;
        }
}

TEST(BsdfSampling, DiffuseDirectionsFollowTheirDensity) { expect_sampler_of(diffuse_surfaces()); }
TEST(BsdfSampling, ConductorsDirectionsFollowTheirDensity) { expect_sampler_of(conductor_surfaces()); }
TEST(BsdfSampling, DielectricsDirectionsFollowTheirDensity) { expect_sampler_of(dielectric_surfaces()); }
TEST(BsdfSampling, MetallicRoughnessDirectionsFollowTheirDensity) { expect_sampler_of(metallic_surfaces()); }

TEST(BsdfSampling, LayeredDirectionsFollowTheirDensity) { expect_sampler_of(principled_surfaces(), 30000, 8); }

// Particles have no sides: all directions together.
TEST(BsdfSampling, ScatteredDirectionsFollowTheirDensity) {
  const auto particles = scatterers();
  for (const NamedSurface& particle : particles) {
    const Vec3 outgoing = view_direction_at(45);
    const Draws draws{CounterRandom(7, 0, 1), particle.bsdf, outgoing, Lobe::glossy, false};
    const auto map = map_of(draws);
    ASSERT_TRUE(map);
    const auto density = [&](Vec3 incoming) { return pdf_bsdf(particle.bsdf, outgoing, incoming, Lobe::glossy); };
    const SphereTest test = test_sphere_sampling(*map, 100000, Draws(draws), density);
    EXPECT_GT(test.chi_square.p_value, sidak_level(level, int(particles.size()))) << particle.name;
    EXPECT_LT(test.deviation, 4.5) << particle.name << ": drawn " << test.drawn << ", integral " << test.integral;
  }
}

TEST(BsdfSampling, TheChiSquareTestRejectsAWrongDensity) {
  // A deviation that the test must detect: directions by cosθ/π against a density 5 % too large on one side.
  CounterRandom random(3, 0, 0);
  const auto sample = [&]() -> std::optional<Vec3> {
    const double u = random.uniform();
    return sample_cosine({0, 0, 1}, u, random.uniform());
  };
  const auto right = [](Vec3 d) { return pdf_cosine({0, 0, 1}, d); };
  const auto wrong = [&](Vec3 d) { return right(d) * (d.x > 0 ? 1.05 : 0.95); };
  const SphereMap map({0, 0, 1}, 1e6);
  EXPECT_GT(test_sphere_sampling(map, 100000, sample, right).chi_square.p_value, level);
  EXPECT_LT(test_sphere_sampling(map, 100000, sample, wrong).chi_square.p_value, 1e-6);
  // Tables of χ²: 3.841 at one degree and 124.342 at a hundred leave 5 %.
  EXPECT_NEAR(chi_square_tail(3.841459, 1), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_tail(124.342113, 100), 0.05, 1e-6);
  EXPECT_NEAR(sidak_level(0.01, 2), 1 - std::sqrt(0.99), 1e-15);
}

TEST(BsdfSampling, AWeightIsTheValueOverTheDensity) {
  for (const auto& surface : all_surfaces())
    for (double angle : {0.0, 30.0, 60.0, 85.0, 89.9}) {
      const Vec3 outgoing = view_direction_at(angle);
      CounterRandom random(1, 0, 0);
      for (int i = 0; i < 500; ++i) {
        const double u_lobe = random.uniform(), u = random.uniform();
        const auto way = sample_bsdf(surface.bsdf, outgoing, u_lobe, {u, random.uniform()});
        if (!way) continue;
        EXPECT_NEAR(length(way->direction), 1, 1e-12);
        if (way->lobe == Lobe::specular) {
          EXPECT_EQ(pdf_bsdf(surface.bsdf, outgoing, way->direction, Lobe::specular), 0);
          EXPECT_EQ(eval_bsdf(surface.bsdf, outgoing, way->direction, Lobe::specular), Vec3{});
          continue;
        }
        // A lobe of width α amplifies the direction's rounding of 1e-16 to 1e-16/α², more so at grazing angles.
        const double tolerance = 1e-9 + 1e-13 / (surface.alpha * surface.alpha * outgoing.z);
        const double density = pdf_bsdf(surface.bsdf, outgoing, way->direction, way->lobe);
        EXPECT_NEAR(density / way->pdf, 1, tolerance) << surface.name << " at " << angle;
        const Vec3 value = eval_bsdf(surface.bsdf, outgoing, way->direction, way->lobe);
        const double brightest = std::fmax(1e-6, max_component(way->weight));
        EXPECT_LT(length(value / density - way->weight) / brightest, tolerance) << surface.name << " at " << angle;
      }
    }
}

TEST(BsdfSampling, BranchesAreWhatIsDrawn) {
  std::vector<NamedSurface> surfaces = specular_surfaces();
  for (const NamedSurface& surface : smooth_layers()) surfaces.push_back(surface);
  for (const auto& surface : surfaces)
    for (double angle : {0.0, 45.0, 80.0}) {
      const Vec3 outgoing = view_direction_at(angle);
      const SpecularBranches both = specular_branches(surface.bsdf, outgoing);
      ASSERT_GT(both.count, 0) << surface.name;
      // Evenly spread choices draw each branch as often as its probability says, to one part in their number.
      constexpr int tries = 10000;
      for (int k = 0; k < both.count; ++k) {
        const BsdfSample& way = both.ways[size_t(k)];
        EXPECT_EQ(way.pdf, 1);
        int drawn = 0;
        double probability = 0;
        for (int i = 0; i < tries; ++i) {
          const auto sample = sample_bsdf(surface.bsdf, outgoing, (i + 0.5) / tries, {0.3, 0.7});
          if (!sample || sample->lobe != Lobe::specular || sample->is_transmission != way.is_transmission) continue;
          ++drawn;
          probability = sample->pdf;
          EXPECT_NEAR(length(sample->direction - way.direction), 0, 1e-12);
          EXPECT_NEAR(length(sample->weight * sample->pdf - way.weight), 0, 1e-12);
          EXPECT_EQ(sample->phase, way.phase);
          EXPECT_EQ(sample->squared_index_ratio, way.squared_index_ratio);
        }
        EXPECT_NEAR(double(drawn) / tries, probability, 1.0 / tries) << surface.name << " at " << angle;
      }
    }
}

TEST(BsdfSampling, NothingLeaksThroughASurfaceNorBreaksAtItsEdges) {
  // Shading normals that lean by up to 95° from the triangle's, viewers down to its plane, any roughness.
  CounterRandom random(11, 0, 0);
  for (const Material& material : sample_materials())
    for (int i = 0; i < 400; ++i) {
      SurfacePoint point = flat_point(i % 2 == 0);
      const double lean = random.uniform() * 95 * pi / 180, turn = 2 * pi * random.uniform();
      point.normal = {std::sin(lean) * std::cos(turn), std::sin(lean) * std::sin(turn), std::cos(lean)};
      point = shading_point(material, point);
      EXPECT_GT(dot(point.normal, point.geometric_normal), 0);
      const double cosine = i % 4 ? random.uniform() : std::pow(10, -12 * random.uniform());
      const double sine = std::sqrt(1 - cosine * cosine);
      const Vec3 outgoing{sine, 0, cosine};
      const Bsdf bsdf = make_bsdf(material, point, Lines{});
      const auto* layers = std::get_if<PrincipledMaterial>(&material.surface);
      const bool transmits = std::holds_alternative<DielectricMaterial>(material.surface) ||
                             std::holds_alternative<FilterMaterial>(material.surface) ||
                             (layers && layers->transmission.value + layers->diffuse_transmission.value > 0);
      for (int j = 0; j < 20; ++j) {
        const double u_lobe = random.uniform(), u = random.uniform();
        const auto way = sample_bsdf(bsdf, outgoing, u_lobe, {u, random.uniform()});
        if (!way) continue;
        ASSERT_TRUE(is_finite(way->direction) && is_finite(way->weight) && is_finite(way->phase));
        ASSERT_TRUE(std::isfinite(way->pdf) && way->pdf > 0);
        ASSERT_GE(std::fmin(way->weight.x, std::fmin(way->weight.y, way->weight.z)), 0);
        ASSERT_EQ(way->direction.z < 0, way->is_transmission);
        if (!transmits) {
          ASSERT_FALSE(way->is_transmission);
        }
        for (Vec3 incoming : {way->direction, -way->direction, Vec3{1, 0, 0}, Vec3{0, 0, -1}, Vec3{0, 0, 1}, -outgoing})
          for (Lobe lobe : {Lobe::diffuse, Lobe::glossy, Lobe::specular}) {
            const Vec3 value = eval_bsdf(bsdf, outgoing, incoming, lobe);
            const double density = pdf_bsdf(bsdf, outgoing, incoming, lobe);
            ASSERT_TRUE(is_finite(value) && std::isfinite(density) && density >= 0);
            if (incoming.z < 0 && !transmits) {
              ASSERT_EQ(value, Vec3{});
              ASSERT_EQ(density, 0);
            }
          }
      }
    }
}

}  // namespace
}  // namespace holotrace
