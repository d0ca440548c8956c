#include <gtest/gtest.h>

#include "holotrace/base/random.h"
#include "trace/surfaces.h"

// Energy: what a surface sends back of an even light, and that the way there and back are alike.

namespace holotrace {
namespace {

constexpr double angles[] = {0, 20, 40, 60, 75, 85, 89};
constexpr double all_roughnesses[] = {0.02, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1};

/// Mean weight of the directions drawn, over 2¹⁴ points of an additive recurrence (Roberts' R₃): of smooth weights
/// known to about 3e-4. `radiance(way)` is what comes along it.
template <class Radiance>
Vec3 received(const Bsdf& bsdf, Vec3 outgoing, const Radiance& radiance) {
  constexpr int count = 1 << 14;
  constexpr double root = 1.2207440846057596;  // x⁴ = x + 1
  Vec3 sum;
  for (int i = 0; i < count; ++i) {
    const auto coordinate = [&](double step) { return std::fmod(0.5 + (i + 1) * step, 1.0); };
    const double u_lobe = coordinate(1 / (root * root * root));
    const auto way = sample_bsdf(bsdf, outgoing, u_lobe, {coordinate(1 / root), coordinate(1 / (root * root))});
    if (way) sum += way->weight * radiance(*way);
  }
  return sum / count;
}

Vec3 albedo(const Bsdf& bsdf, Vec3 outgoing) {
  return received(bsdf, outgoing, [](const BsdfSample&) { return 1.0; });
}

/// The equilibrium of an enclosure: radiance n², n = 1 on the near side.
Vec3 furnace(const Bsdf& bsdf, Vec3 outgoing, double far_over_near) {
  return received(bsdf, outgoing,
                  [&](const BsdfSample& way) { return way.is_transmission ? far_over_near * far_over_near : 1; });
}

constexpr double quadrature = 1e-3;  // three times what `received` says

/// A metal that reflects everything: 1 − F = 4n/k² = 4e-12 head-on.
ConductorMaterial perfect_metal(double roughness) { return {{{{532e-9, 1, 1e6}}}, roughness}; }

void expect_white(Vec3 value, double tolerance, const std::string& what) {
  EXPECT_NEAR(value.x, 1, tolerance) << what;
  EXPECT_NEAR(value.y, 1, tolerance) << what;
  EXPECT_NEAR(value.z, 1, tolerance) << what;
}

TEST(BsdfEnergy, AWhitePaperReflectsAndTransmitsEverything) {
  const DiffuseMaterial paper{.reflectance = {0.7, 0.5, 0.2}, .transmittance = {0.3, 0.5, 0.8}};
  for (double angle : angles)
    expect_white(albedo(make_bsdf(paper, flat_point(), Lines{}), view_direction_at(angle)), quadrature, "paper");
}

TEST(BsdfEnergy, AWhiteMirrorReflectsEverything) {
  for (double angle : angles) {
    const auto mirror = specular_branches(make_bsdf(perfect_metal(0), flat_point(), Lines{}), view_direction_at(angle));
    ASSERT_EQ(mirror.count, 1);
    expect_white(mirror.ways[0].weight, 1e-9, "mirror");  // 4n/(k²·cosθ) at 89°
  }
}

TEST(BsdfEnergy, AWhiteRoughMetalReflectsEverything) {
  // Kulla and Conty's lobe returns what single scattering loses, up to what the table of albedos is off between its
  // entries: 0.01. Without it a metal of roughness 1 loses half (EGSR 2016, Heitz et al., fig. 1).
  for (double roughness : all_roughnesses)
    for (double angle : angles)
      expect_white(albedo(make_bsdf(perfect_metal(roughness), flat_point(), Lines{}), view_direction_at(angle)), 0.01,
                   "roughness " + std::to_string(roughness) + " at " + std::to_string(angle));
}

TEST(BsdfEnergy, AWhiteVarnishedBaseReflectsEverything) {
  // A white dielectric of the metallic-roughness model: coat and base add up to 1 by their coupling, to the table's
  // 0.01.
  for (double roughness : all_roughnesses)
    for (double angle : angles) {
      const MetallicRoughnessMaterial white{.metallic = 0, .roughness = roughness};
      expect_white(albedo(make_bsdf(white, flat_point(), Lines{}), view_direction_at(angle)), 0.01,
                   "roughness " + std::to_string(roughness) + " at " + std::to_string(angle));
    }
  const MetallicRoughnessMaterial smooth{.metallic = 0, .roughness = 0};
  for (double angle : angles)  // the smooth one has its albedo in closed form
    expect_white(albedo(make_bsdf(smooth, flat_point(), Lines{}), view_direction_at(angle)), quadrature, "smooth");
}

TEST(BsdfEnergy, SmoothGlassIsInBalanceWithItsFurnace) {
  for (double n : {1.33, 1.5, 2.4})
    for (bool is_front : {true, false})
      for (double angle : angles) {
        const Bsdf glass = make_bsdf(DielectricMaterial{constant_index(n)}, flat_point(is_front), Lines{});
        const double ratio = is_front ? n : 1 / n;
        const SpecularBranches both = specular_branches(glass, view_direction_at(angle));
        Vec3 sum;
        for (int k = 0; k < both.count; ++k) {
          const BsdfSample& way = both.ways[size_t(k)];
          EXPECT_EQ(way.squared_index_ratio, way.is_transmission ? 1 / (ratio * ratio) : 1);
          sum += way.weight * (way.is_transmission ? ratio * ratio : 1);
        }
        expect_white(sum, 1e-12, "glass");
        expect_white(furnace(glass, view_direction_at(angle), ratio), 1e-9, "glass, drawn");
      }
}

TEST(BsdfEnergy, APaneReflectsAndTransmitsEverythingStraightOn) {
  for (double angle : angles) {
    const Vec3 outgoing = view_direction_at(angle);
    const SpecularBranches both = specular_branches(
        make_bsdf(DielectricMaterial{.index = constant_index(1.5), .is_thin = true}, flat_point(), Lines{}), outgoing);
    ASSERT_EQ(both.count, 2);
    expect_white(both.ways[0].weight + both.ways[1].weight, 1e-12, "pane");
    // R + T²R/(1 − R²) of the two faces, summed by hand.
    const double r = reflectance_dielectric(outgoing.z, 1.5), t = 1 - r;
    EXPECT_NEAR(both.ways[0].weight.x, r + t * t * r / (1 - r * r), 1e-12);
    EXPECT_EQ(both.ways[1].direction, -outgoing);
    EXPECT_EQ(both.ways[0].phase, (Vec3{pi, pi, pi}));  // off the first face, from air
    EXPECT_EQ(both.ways[1].phase, Vec3{});
  }
}

TEST(BsdfEnergy, RoughGlassLosesWhatMeetsTwoMicrofacetsAndNoMore) {
  // What single scattering keeps of a furnace at n = 1.5, as dielectric_bsdf.h says: up to 60° from the normal seen
  // from air and from inside, and at any angle.
  const struct {
    double roughness, from_air, from_inside, anywhere;
  } kept[] = {{0.02, 0.999, 0.999, 0.999}, {0.1, 0.999, 0.999, 0.90}, {0.2, 0.998, 0.99, 0.90},
              {0.35, 0.98, 0.94, 0.85},    {0.5, 0.95, 0.82, 0.79},   {0.7, 0.88, 0.65, 0.64},
              {0.85, 0.79, 0.55, 0.50},    {1, 0.67, 0.41, 0.36}};
  for (bool is_front : {true, false})
    for (const auto& row : kept)
      for (double angle : angles) {
        const DielectricMaterial rough{constant_index(1.5), row.roughness};
        const Bsdf glass = make_bsdf(rough, flat_point(is_front), Lines{});
        const double all = furnace(glass, view_direction_at(angle), is_front ? 1.5 : 1 / 1.5).x;
        EXPECT_LT(all, 1 + quadrature) << row.roughness << " at " << angle;
        EXPECT_GT(all, angle > 60 ? row.anywhere
                       : is_front ? row.from_air
                                  : row.from_inside)
            << row.roughness << " at " << angle << " front " << is_front;
      }
}

TEST(BsdfEnergy, NoSurfaceSendsBackMoreThanItReceives) {
  for (double roughness : all_roughnesses)
    for (double angle : angles) {
      const Vec3 outgoing = view_direction_at(angle);
      for (const std::string& name : metal_names()) {
        const Vec3 metal =
            albedo(make_bsdf(ConductorMaterial{metal_index(name), roughness}, flat_point(), Lines{}), outgoing);
        EXPECT_LT(max_component(metal), 1 + quadrature) << name;
      }
      for (double metallic : {0.0, 0.3, 1.0})
        for (double base : {0.04, 0.5, 1.0}) {
          const MetallicRoughnessMaterial paint{
              .base_color = Vec3{1, 1, 1} * base, .metallic = metallic, .roughness = roughness};
          const double back = albedo(make_bsdf(paint, flat_point(), Lines{}), outgoing).x;
          EXPECT_LT(back, 1 + 5 * quadrature) << metallic << " " << base << " " << roughness << " " << angle;
        }
    }
}

/// A random direction of the upper hemisphere, evenly over cosθ.
Vec3 random_direction(CounterRandom& random) {
  const double cosine = 0.01 + 0.99 * random.uniform(), turn = 2 * pi * random.uniform();
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(turn), sine * std::sin(turn), cosine};
}

TEST(BsdfEnergy, ReflectionIsTheSameThereAndBack) {
  // Helmholtz: f(o, i) = f(i, o). Rounding grows where a lobe is narrow: 1e-16/α² = 3e-14 of the narrowest here.
  CounterRandom random(5, 0, 0);
  for (const NamedSurface& surface : all_surfaces()) {
    if (surface.name.find("leaning") == 0) continue;  // in whose frame the directions may lie below
    for (int k = 0; k < 200; ++k) {
      const Vec3 a = random_direction(random), b = random_direction(random);
      for (Lobe lobe : {Lobe::diffuse, Lobe::glossy}) {
        const Vec3 there = eval_bsdf(surface.bsdf, a, b, lobe) / b.z, back = eval_bsdf(surface.bsdf, b, a, lobe) / a.z;
        EXPECT_LT(length(there - back), 1e-9 * (1e-3 + length(there))) << surface.name;
      }
    }
  }
}

TEST(BsdfEnergy, RefractionThereAndBackDiffersByTheSquareOfTheIndices) {
  // f(o, i)/n_o² = f(i, o)/n_i² (Veach, PhD thesis 1997, eq. 5.14): light fills n² as much solid angle.
  CounterRandom random(6, 0, 0);
  for (double n : {1.33, 1.5, 2.4})
    for (double roughness : {0.3, 0.6, 1.0}) {
      const DielectricMaterial material{constant_index(n), roughness};
      const Bsdf outside = make_bsdf(material, flat_point(true), Lines{});
      SurfacePoint below = flat_point(false);
      below.normal = below.geometric_normal = {0, 0, -1};
      const Bsdf inside = make_bsdf(material, below, Lines{});
      int transmitted = 0;
      for (int k = 0; k < 500; ++k) {
        const Vec3 a = random_direction(random), b = -random_direction(random);
        const double seen_from_air = eval_bsdf(outside, a, b, Lobe::glossy).x / -b.z;
        const double seen_from_glass = eval_bsdf(inside, b, a, Lobe::glossy).x / a.z;
        EXPECT_NEAR(seen_from_air, seen_from_glass / (n * n), 1e-9 * (1e-3 + seen_from_air));
        transmitted += seen_from_air > 0;
      }
      EXPECT_GT(transmitted, 50);  // the test has something to test
    }
}

TEST(BsdfEnergy, RefractionObeysSnell) {
  for (double angle : angles) {
    const Vec3 outgoing = view_direction_at(angle);
    const auto both = specular_branches(make_bsdf(DielectricMaterial{}, flat_point(), Lines{}), outgoing);
    ASSERT_EQ(both.count, 2);
    const Vec3 refracted = both.ways[1].direction;
    EXPECT_NEAR(length(refracted), 1, 1e-12);
    // Tangential wave numbers agree: n·sinθ on both sides, the light going on the other way.
    EXPECT_NEAR(1.5 * refracted.x, -outgoing.x, 1e-12);
    EXPECT_NEAR(1.5 * refracted.y, -outgoing.y, 1e-12);
    EXPECT_LT(refracted.z, 0);
  }
  // From inside, beyond the critical angle of 41.8°, one way is left, and all of the light.
  const auto total =
      specular_branches(make_bsdf(DielectricMaterial{}, flat_point(false), Lines{}), view_direction_at(45));
  ASSERT_EQ(total.count, 1);
  EXPECT_EQ(total.ways[0].weight, (Vec3{1, 1, 1}));
  // tan(δ/2) = −√(sin²θ − 1/n²)/cosθ
  const double delta = -2 * std::atan(std::sqrt(0.5 - 1 / 2.25) / std::sqrt(0.5));
  EXPECT_NEAR(total.ways[0].phase.x, delta, 1e-12);
}

}  // namespace
}  // namespace holotrace
