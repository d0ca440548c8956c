#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/data/rgl_brdf.h"
#include "holotrace/trace/materials/bsdf.h"
#include "support/error_of.h"
#include "support/statistics.h"
#include "trace/surfaces.h"

namespace holotrace {
namespace {

// A GGX reflection of mirrors (F = 1, separable masking) and a diffuse base [1/sr], written apart from the program.
double known_brdf(Vec3 o, Vec3 i, double alpha, double diffuse) {
  const Vec3 h = normalize(o + i);
  const double a2 = alpha * alpha, t = h.z * h.z * (a2 - 1) + 1, d = a2 / (pi * t * t);
  const auto visible = [&](double cosine) {
    return 2 * cosine / (cosine + std::sqrt(a2 + (1 - a2) * cosine * cosine));
  };
  return d * visible(o.z) * visible(i.z) / (4 * o.z * i.z) + diffuse / pi;
}

// Viewer and light from the angles of the half vector and the difference (Rusinkiewicz).
std::pair<Vec3, Vec3> directions(double theta_h, double theta_d, double phi_d) {
  const Vec3 h{std::sin(theta_h), 0, std::cos(theta_h)}, x{std::cos(theta_h), 0, -std::sin(theta_h)}, y{0, 1, 0};
  const Vec3 i =
      x * (std::sin(theta_d) * std::cos(phi_d)) + y * (std::sin(theta_d) * std::sin(phi_d)) + h * std::cos(theta_d);
  return {h * (2 * dot(h, i)) - i, i};
}

// The table of such a surface: red is it, green half and blue a quarter of it.
std::shared_ptr<const MeasuredBrdf> table_of(double alpha, double diffuse) {
  MeasuredField field{"merl", {3, 90, 90, 180}, std::vector<float>(3 * merl_cells)};
  size_t cell = 0;
  for (int h = 0; h < 90; ++h)
    for (int d = 0; d < 90; ++d)
      for (int p = 0; p < 180; ++p, ++cell) {
        const auto [o, i] =
            directions((h + 0.5) * (h + 0.5) / 8100 * pi / 2, (d + 0.5) * pi / 180, (p + 0.5) * pi / 180);
        const double value = o.z > 0.01 && i.z > 0.01 ? known_brdf(o, i, alpha, diffuse) : 0;
        for (size_t channel = 0; channel < 3; ++channel)
          field.values[channel * merl_cells + cell] = float(value / double(1 << channel));
      }
  MeasuredBrdf brdf{{std::move(field)}};
  choose_lobe(brdf);
  return std::make_shared<MeasuredBrdf>(std::move(brdf));
}

const std::shared_ptr<const MeasuredBrdf>& satin() {
  static const auto table = table_of(0.3, 0.2);
  return table;
}

Bsdf bsdf_of(const std::shared_ptr<const MeasuredBrdf>& table, const SurfacePoint& point = flat_point()) {
  return make_bsdf(MeasuredMaterial{table}, point, Lines{});
}

TEST(Measured, TableOfAKnownSurfaceGivesItsReflection) {
  const Bsdf bsdf = bsdf_of(satin());
  CounterRandom random(3, 0, 0);
  double largest = 0;
  for (int k = 0; k < 2000; ++k) {
    const double a = random.uniform(), b = random.uniform(), c = random.uniform(), d = random.uniform();
    const Vec3 o = sample_cosine({0, 0, 1}, 0.9 * a, b), i = sample_cosine({0, 0, 1}, 0.9 * c, d);
    const double known = known_brdf(o, i, 0.3, 0.2) * i.z;
    const Vec3 found = eval_bsdf(bsdf, o, i, Lobe::glossy);
    largest = std::max(largest, std::abs(found.x / known - 1));
    ASSERT_NEAR(found.y, found.x / 2, 1e-6 * found.x);
    ASSERT_NEAR(found.z, found.x / 4, 1e-6 * found.x);
  }
  // Cells are 1° wide in θ_d and up to 2° in θ_h. With f ~ D ~ tan⁻⁴ at the flanks, the linear interpolation is wrong by
  // f''·h²/8 ≤ 20/θ²·(2°)²/8 ≤ 2 % where θ > 0.4, and near the horizon, where masking changes in a cell, by a little more.
  EXPECT_LT(largest, 0.03);
}

TEST(Measured, IsReciprocal) {
  const Bsdf bsdf = bsdf_of(satin());
  CounterRandom random(4, 0, 0);
  for (int k = 0; k < 500; ++k) {
    const double a = random.uniform(), b = random.uniform(), c = random.uniform(), d = random.uniform();
    const Vec3 o = sample_cosine({0, 0, 1}, a, b), i = sample_cosine({0, 0, 1}, c, d);
    const double there = eval_bsdf(bsdf, o, i, Lobe::glossy).x * o.z,
                 back = eval_bsdf(bsdf, i, o, Lobe::glossy).x * i.z;
    EXPECT_NEAR(there, back, 1e-6 * there + 1e-9);  // angles to 1e-8 (arccosine), times slopes of the table
  }
}

TEST(Measured, DirectionsAreDrawnWithTheirDensity) {
  SurfacePoint leaning = flat_point();
  leaning.normal = normalize({0.3, -0.2, 1});
  int tests = 0;
  for (const SurfacePoint& point : {flat_point(), leaning})
    for (const double degrees : {0.0, 70.0}) {
      const Bsdf bsdf = bsdf_of(satin(), point);
      const Vec3 outgoing = view_direction_at(degrees);
      CounterRandom random(6, 0, uint64_t(tests++));
      const auto draw = [&]() -> std::optional<Vec3> {
        const double choice = random.uniform(), u = random.uniform(), v = random.uniform();
        const auto way = sample_bsdf(bsdf, outgoing, choice, {u, v});
        return way ? std::optional(way->direction) : std::nullopt;
      };
      const SphereTest test = test_sphere_sampling(SphereMap({0, 0, 1}, 1), 30000, draw,
                                                   [&](Vec3 i) { return pdf_bsdf(bsdf, outgoing, i, Lobe::glossy); });
      EXPECT_GT(test.chi_square.p_value, sidak_level(0.01, 4)) << degrees;
      EXPECT_LT(std::abs(test.deviation), 4) << degrees;
    }
}

TEST(Measured, SampledLightIsTheIntegralOfTheReflection) {
  const Bsdf bsdf = bsdf_of(satin());
  for (const double degrees : {10.0, 60.0}) {
    const Vec3 outgoing = view_direction_at(degrees);
    // By the midpoint rule over the hemisphere, of the surface itself: 200 × 400 cells, far finer than the lobe.
    double albedo = 0;
    for (int a = 0; a < 200; ++a)
      for (int b = 0; b < 400; ++b) {
        const double z = (a + 0.5) / 200, angle = 2 * pi * (b + 0.5) / 400, sine = std::sqrt(1 - z * z);
        const Vec3 i{sine * std::cos(angle), sine * std::sin(angle), z};
        albedo += known_brdf(outgoing, i, 0.3, 0.2) * z * 2 * pi / (200 * 400);
      }
    Statistics found;
    CounterRandom random(9, 0, uint64_t(degrees));
    for (int k = 0; k < 40000; ++k) {
      const double choice = random.uniform(), u = random.uniform(), v = random.uniform();
      const auto way = sample_bsdf(bsdf, outgoing, choice, {u, v});
      found.add(way ? way->weight.x : 0);
    }
    // The table alone is wrong by up to 3 % at single directions, with either sign, and by 1 % on the whole.
    EXPECT_NEAR(found.mean(), albedo, 4 * found.standard_error() + 0.01 * albedo) << degrees;
    EXPECT_LT(found.standard_error() * std::sqrt(40000.0), albedo) << "directions follow the highlight";
  }
}

TEST(Measured, LobesFollowTheHighlight) {
  // α from the half width: within a cell of √θ, 10 %.
  EXPECT_NEAR(satin()->alpha / 0.3, 1, 0.15);
  const auto shiny = table_of(0.05, 0.5);
  EXPECT_NEAR(shiny->alpha / 0.05, 1, 0.25);
  // Its highlight has an albedo of 1, less what microfacets shadow, beside 0.5.
  EXPECT_NEAR(shiny->diffuse_share, 1 / 3., 0.03);
}

// A surface of the RGL database whose tables are linear between their ends, so that every value between them is exact.
struct Functions {
  std::function<double(double x, double y)> density = [](double, double) { return 1.0; };
  std::function<double(double phi, double theta, double nanometres, double x, double y)> spectra;
  std::vector<float> phis{0};
};

Bsdf rgl_surface(const Functions& f, Vec2 lobe = {2, -1}) {
  MeasuredBrdf brdf;
  brdf.fields.resize(9);
  const int phis = int(f.phis.size());
  const std::vector<float> thetas{0, float(pi / 4), float(pi / 2)}, wavelengths{400, 700};
  brdf.fields[rgl_phi] = {"phi_i", {phis}, f.phis};
  brdf.fields[rgl_theta] = {"theta_i", {3}, thetas};
  brdf.fields[rgl_wavelengths] = {"wavelengths", {2}, wavelengths};
  brdf.fields[rgl_ndf] = {
      "ndf", {2, 2}, {float(lobe.x), float(lobe.x + lobe.y), float(lobe.x), float(lobe.x + lobe.y)}};
  brdf.fields[rgl_sigma] = {"sigma", {2, 2}, {0.5F, 0.75F, 0.5F, 0.75F}};
  MeasuredField density{"vndf", {phis, 3, 2, 2}, {}}, spectra{"spectra", {phis, 3, 2, 2, 2}, {}};
  for (const float phi : f.phis)
    for (const float theta : thetas) {
      for (const double y : {0.0, 1.0})
        for (const double x : {0.0, 1.0}) density.values.push_back(float(f.density(x, y)));
      for (const float wavelength : wavelengths)
        for (const double y : {0.0, 1.0})
          for (const double x : {0.0, 1.0})
            spectra.values.push_back(float(f.spectra(double(phi), double(theta), double(wavelength), x, y)));
    }
  brdf.fields[rgl_vndf] = std::move(density);
  brdf.fields[rgl_spectra] = std::move(spectra);
  prepare_rgl(brdf);
  static std::vector<std::shared_ptr<const MeasuredBrdf>> kept;  // a Bsdf points to its table
  kept.push_back(std::make_shared<MeasuredBrdf>(std::move(brdf)));
  return bsdf_of(kept.back());
}

// The column and the row of a half vector in the tables, and the factor D/(4σ) of the surface above.
struct HalfPlace {
  double x, y, factor;

  HalfPlace(Vec3 o, Vec3 i) {
    const Vec3 h = normalize(o + i);
    x = std::sqrt(std::acos(h.z) / (pi / 2));
    y = (std::atan2(h.y, h.x) - std::atan2(o.y, o.x)) / (2 * pi) + 0.5;
    y -= std::floor(y);
    factor = (2 - x) / (4 * (0.5 + 0.25 * std::sqrt(std::acos(o.z) / (pi / 2))));
  }
};

template <class Check>
void for_some_directions(const Check& check) {
  CounterRandom random(12, 0, 0);
  for (int k = 0; k < 200; ++k) {
    const double a = random.uniform(), b = random.uniform(), c = random.uniform(), d = random.uniform();
    check(sample_cosine({0, 0, 1}, a, b), sample_cosine({0, 0, 1}, c, d));
  }
}

constexpr double float_rounding = 1e-5;  // tables of 32-bit floats, and angles near a pole

TEST(MeasuredRgl, SpectraAreReadAtTheLinesAndTheViewersAngle) {
  const Bsdf bsdf = rgl_surface({.spectra = [](double, double theta, double nanometres, double x, double) {
    return theta + nanometres / 1000 + x;
  }});
  for_some_directions([&](Vec3 o, Vec3 i) {
    const HalfPlace half(o, i);
    const Vec3 found = eval_bsdf(bsdf, o, i, Lobe::glossy);  // f·cosθ, whose density has no cosine of the light
    const double theta = std::acos(o.z);
    ASSERT_NEAR(found.x, half.factor * (theta + 0.630 + half.x), float_rounding);
    ASSERT_NEAR(found.y, half.factor * (theta + 0.532 + half.x), float_rounding);
    ASSERT_NEAR(found.z, half.factor * (theta + 0.460 + half.x), float_rounding);
  });
}

TEST(MeasuredRgl, HalfVectorsAreMappedByTheirDensity) {
  // The density (1 + x)(1 + y)/2.25 maps x and y to (x + x²/2)/1.5 each.
  const Bsdf bsdf = rgl_surface({.density = [](double x, double y) { return 7 * (1 + x) * (1 + y); },
                                 .spectra = [](double, double, double, double x, double y) { return x + 2 * y; }});
  const auto mapped = [](double t) { return (t + t * t / 2) / 1.5; };
  for_some_directions([&](Vec3 o, Vec3 i) {
    const HalfPlace half(o, i);
    ASSERT_NEAR(eval_bsdf(bsdf, o, i, Lobe::glossy).x, half.factor * (mapped(half.x) + 2 * mapped(half.y)),
                float_rounding);
  });
}

TEST(MeasuredRgl, BrushedSurfacesHaveTheirDirectionsAndTheirSymmetry) {
  // Measured from −π to 0: the other half is the same, turned by 180°.
  const float half_turn = float(-pi);
  const Bsdf bsdf = rgl_surface({.spectra = [](double phi, double, double, double, double) { return -phi; },
                                 .phis = {half_turn, half_turn / 2, 0}});
  for_some_directions([&](Vec3 o, Vec3 i) {
    const HalfPlace half(o, i);
    const double phi = std::atan2(o.y, o.x), measured = phi > 0 ? phi - pi : phi;
    ASSERT_NEAR(eval_bsdf(bsdf, o, i, Lobe::glossy).x, half.factor * -measured, 10 * float_rounding);
    const Vec3 turned_o{-o.x, -o.y, o.z}, turned_i{-i.x, -i.y, i.z};
    ASSERT_NEAR(eval_bsdf(bsdf, o, i, Lobe::glossy).x, eval_bsdf(bsdf, turned_o, turned_i, Lobe::glossy).x,
                float_rounding);
  });
}

TEST(MeasuredRgl, TablesThatDoNotFitAreNamed) {
  MeasuredBrdf brdf;
  brdf.fields.resize(9);
  brdf.fields[rgl_phi] = {"phi_i", {1}, {0}};
  brdf.fields[rgl_theta] = {"theta_i", {2}, {1, 0}};
  EXPECT_EQ(error_of([&] { prepare_rgl(brdf); }),
            "expected 2 ascending values or more in the field \"theta_i\" of a measured BRDF, got 2");
  brdf.fields[rgl_theta].values = {0, 1};
  brdf.fields[rgl_wavelengths] = {"wavelengths", {2}, {400, 700}};
  brdf.fields[rgl_ndf] = {"ndf", {2}, {1, 1}};
  EXPECT_EQ(error_of([&] { prepare_rgl(brdf); }),
            "expected a field \"ndf\" of a measured BRDF that fits its angles and wavelengths, got another shape");
  brdf.fields[rgl_ndf] = {"ndf", {2, 2}, {1, -1, 1, 1}};
  EXPECT_EQ(error_of([&] { prepare_rgl(brdf); }),
            "expected values of 0 or more in the field \"ndf\" of a measured BRDF, got -1");
}

}  // namespace
}  // namespace holotrace
