#include <fmt/format.h>
#include <gtest/gtest.h>

#include "holotrace/base/random.h"
#include "trace/surfaces.h"

// Energy: the light that a surface reflects of an even surrounding, and reciprocity.

namespace holotrace {
namespace {

constexpr double angles[] = {0, 20, 40, 60, 75, 85, 89};
constexpr double all_roughnesses[] = {0.02, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1};

/// Mean weight of the directions drawn, over 2¹⁴ points of an additive recurrence (Roberts' R₃): for smooth weights
/// exact to about 3e-4. `radiance(way)` is the radiance from that direction.
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

// The tables of microfacet albedos have an error of 0.003, and 2¹⁴ points as much for a rare lobe.
constexpr double table = 0.007;
constexpr double quadrature = 1e-3;  // three times the error of `received`

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
  // Kulla and Conty's lobe returns the loss of single scattering, up to the error of the albedo table between its
  // entries: 0.001, and 0.003 within some degrees of grazing.
  for (double roughness : all_roughnesses)
    for (double angle : angles)
      expect_white(albedo(make_bsdf(perfect_metal(roughness), flat_point(), Lines{}), view_direction_at(angle)), table,
                   "roughness " + std::to_string(roughness) + " at " + std::to_string(angle));
}

TEST(BsdfEnergy, AWhiteMetalOfTheMetallicRoughnessModelReflectsEverything) {
  // glTF's default material, base colour, metallic and roughness 1, kept 0.31 by single scattering, head-on (1 − ln 2).
  for (double roughness : all_roughnesses)
    for (double angle : angles)
      for (double metallic : {1.0, 0.5}) {
        const MetallicRoughnessMaterial white{.metallic = metallic, .roughness = roughness};
        expect_white(albedo(make_bsdf(white, flat_point(), Lines{}), view_direction_at(angle)), table,
                     fmt::format("metallic {} roughness {} at {}", metallic, roughness, angle));
      }
  for (double angle : angles)
    expect_white(
        albedo(make_bsdf(MetallicRoughnessMaterial{.roughness = 0}, flat_point(), Lines{}), view_direction_at(angle)),
        1e-12, "smooth");
}

TEST(BsdfEnergy, AGreyMetalReflectsWhatItsFacetsDoOnTheWhole) {
  // Light that meets microfacets of constant reflectance F once is then lost, or reflected again with that F, and
  // escapes each time with Ē: F·Ē/(1 − F·(1 − Ē)), the series that K sums (F̄ = F0 + (1 − F0)/21 for Schlick). The mean
  // of the single term over the table's means, and that of multiple scattering, K·(1 − Ē)², are computed here.
  for (double roughness : {0.35, 0.7, 1.0}) {
    const MicrofacetAlbedo::Value mean = MicrofacetAlbedo(roughness * roughness).mean();
    for (double f0 : {0.3, 0.8}) {
      const double f = f0 + (1 - f0) / 21, escape = 1 - mean.loss;
      const double many = f * f * escape * mean.loss / (1 - f * mean.loss);
      const MetallicRoughnessMaterial grey{.base_color = Vec3{1, 1, 1} * f0, .roughness = roughness};
      const Bsdf metal = make_bsdf(grey, flat_point(), Lines{});
      double reflected = 0;
      constexpr int steps = 16;
      for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps;
        reflected += 2 * cosine / steps * albedo(metal, {std::sqrt(1 - cosine * cosine), 0, cosine}).x;
      }
      EXPECT_NEAR(reflected, mean.reflected(f0) + many, table) << f0 << " roughness " << roughness;
    }
  }
}

TEST(BsdfEnergy, SingleScatteringLosesLogarithmOfTwoOffTheRoughestMetalSeenHeadOn) {
  // At α = 1, head-on, visible normals send light evenly over the whole sphere. Of the upper half G₂/G₁ = 2μ/(1 + μ)
  // is kept: ½∫2μ/(1 + μ) dμ = 1 − ln 2. Tolerance: the rule with 96 heights.
  EXPECT_NEAR(MicrofacetAlbedo(1).at(1).loss, std::log(2), 2e-4);
  // The mean of Schlick's weight off a smooth surface is 2∫(1 − μ)⁵·μ dμ = 1/21; linear interpolation between 32
  // points is larger by less than 1e-3.
  EXPECT_NEAR(MicrofacetAlbedo(0).mean().schlick, 1.0 / 21, 1e-3);
  EXPECT_NEAR(MicrofacetAlbedo(0).mean().loss, 0, 1e-4);
}

TEST(BsdfEnergy, AWhiteVarnishedBaseReflectsEverything) {
  // A white dielectric of the metallic-roughness model: coat and base add up to 1 by their coupling, to the table's
  // 0.01.
  for (double roughness : all_roughnesses)
    for (double angle : angles) {
      const MetallicRoughnessMaterial white{.metallic = 0, .roughness = roughness};
      expect_white(albedo(make_bsdf(white, flat_point(), Lines{}), view_direction_at(angle)), table,
                   "roughness " + std::to_string(roughness) + " at " + std::to_string(angle));
    }
  const MetallicRoughnessMaterial smooth{.metallic = 0, .roughness = 0};
  for (double angle : angles)  // the smooth one has an albedo in closed form
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
    // R + T²R/(1 − R²) for the two faces, summed here.
    const double r = reflectance_dielectric(outgoing.z, 1.5), t = 1 - r;
    EXPECT_NEAR(both.ways[0].weight.x, r + t * t * r / (1 - r * r), 1e-12);
    EXPECT_EQ(both.ways[1].direction, -outgoing);
    EXPECT_EQ(both.ways[0].phase, (Vec3{pi, pi, pi}));  // reflection off the first face, in air
    EXPECT_EQ(both.ways[1].phase, Vec3{});
  }
}

TEST(BsdfEnergy, RoughGlassIsInBalanceWithItsFurnace) {
  // Single scattering alone keeps 0.82 of the furnace at n = 1.5, roughness 0.5, seen from inside within 60° of the
  // normal, and 0.41 at roughness 1. Multiple scattering restores the rest, up to the error of the table.
  for (double n : {1.05, 1.5, 2.4})
    for (bool is_front : {true, false})
      for (double roughness : {0.02, 0.2, 0.5, 0.7, 1.0})
        for (double angle : {0.0, 40.0, 60.0, 75.0, 89.0}) {
          const DielectricMaterial rough{constant_index(n), roughness};
          const Bsdf glass = make_bsdf(rough, flat_point(is_front), Lines{});
          expect_white(furnace(glass, view_direction_at(angle), is_front ? n : 1 / n), table,
                       fmt::format("n {} roughness {} at {} front {}", n, roughness, angle, is_front));
        }
}

TEST(BsdfEnergy, RoughGlassSendsTheLightOfManyFacetsBackAsASmoothOneDoes) {
  // At n = 1.5 the fraction 2∫F·μ dμ = 0.0918 (J. W. T. Walsh, 1926) of single scattering's loss returns to the air.
  // Both terms are computed here by midpoints over the hemisphere, the first from the density of microfacets.
  constexpr double walsh = 0.0918, alpha = 1;
  constexpr int steps = 32, turns = 64;
  const Bsdf glass = make_bsdf(DielectricMaterial{constant_index(1.5), alpha}, flat_point(), Lines{});
  double all = 0, once = 0;
  for (int j = 0; j < steps; ++j)
    for (int k = 0; k < steps; ++k)
      for (int turn = 0; turn < turns; ++turn) {
        const double z = (j + 0.5) / steps, cosine = (k + 0.5) / steps, angle = 2 * pi * (turn + 0.5) / turns;
        const double sine = std::sqrt(1 - cosine * cosine);
        const Vec3 o{std::sqrt(1 - z * z), 0, z}, i{sine * std::cos(angle), sine * std::sin(angle), cosine};
        const Vec3 h = normalize(o + i);
        const double measure = 2 * z / steps * 2 * pi / (steps * turns);
        all += measure * eval_bsdf(glass, o, i, Lobe::glossy).x;
        once += measure * reflectance_dielectric(dot(o, h), 1.5) * ggx_density(h, alpha) *
                smith_masking_shadowing(o, i, alpha) / (4 * z);
      }
  const double left_out = boundary_loss(1.5, alpha).thin.mean;
  EXPECT_GT(left_out, 0.2);
  EXPECT_NEAR((all - once) / left_out, walsh, 0.01 * walsh);  // the rule and the table
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
          EXPECT_LT(back, 1 + table) << metallic << " " << base << " " << roughness << " " << angle;
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
  // Helmholtz: f(o, i) = f(i, o). Rounding grows with the inverse width of a lobe: 1e-16/α² = 3e-14 for the narrowest.
  CounterRandom random(5, 0, 0);
  for (const NamedSurface& surface : all_surfaces()) {
    if (surface.name.find("leaning") == 0) continue;  // in its frame the directions may lie below
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
  // f(o, i)/n_o² = f(i, o)/n_i² (Veach, PhD thesis 1997, eq. 5.14), because n²dω is conserved.
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
      EXPECT_GT(transmitted, 50);  // enough samples for the test
    }
}

TEST(BsdfEnergy, RefractionObeysSnell) {
  for (double angle : angles) {
    const Vec3 outgoing = view_direction_at(angle);
    const auto both = specular_branches(make_bsdf(DielectricMaterial{}, flat_point(), Lines{}), outgoing);
    ASSERT_EQ(both.count, 2);
    const Vec3 refracted = both.ways[1].direction;
    EXPECT_NEAR(length(refracted), 1, 1e-12);
    // Tangential wave numbers agree: n·sinθ is equal on both sides; the light continues on the other side.
    EXPECT_NEAR(1.5 * refracted.x, -outgoing.x, 1e-12);
    EXPECT_NEAR(1.5 * refracted.y, -outgoing.y, 1e-12);
    EXPECT_LT(refracted.z, 0);
  }
  // From inside, beyond the critical angle of 41.8°, only reflection is left, with all of the light.
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
