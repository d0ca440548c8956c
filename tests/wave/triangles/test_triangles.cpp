#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/triangles/sum_triangles.h"
#include "holotrace/wave/triangles/triangle_moments.h"
#include "holotrace/wave/triangles/triangle_part.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;
using test::relative_error;

// Tilted, with different amplitudes and a phase, 60 mm behind the panel: its box (R = 1.3 mm at 12 µm) contains all of
// a panel of 0.6 mm.
Triangle tilted_triangle(bool is_flat) {
  Triangle t;
  t.corners = {Vec3{-80_um, -30_um, -60_mm}, Vec3{90_um, -50_um, -60.04_mm}, Vec3{10_um, 110_um, -59.96_mm}};
  t.amplitudes = is_flat ? std::array<float, 3>{1, 1, 1} : std::array<float, 3>{1, 0.4F, 0.7F};
  t.phase = 0.7F;
  return t;
}

Triangles only(const Triangle& t) { return {green, {t}}; }

// Random triangles over the panel at about the given depth and size, with random tilts.
Triangles random_triangles(int count, const Grid& panel, double depth, double size) {
  Triangles triangles{green, {}};
  CounterRandom random(3, 0, 0);
  const auto even = [&](double width) { return (random.uniform() - 0.5) * width; };
  for (int i = 0; i < count; ++i) {
    Triangle t;
    const Vec3 c{even(panel.width()), even(panel.height()), -depth * (1 + even(0.1))};
    for (Vec3& corner : t.corners) corner = c + Vec3{even(2 * size), even(2 * size), even(size)};
    for (float& a : t.amplitudes) a = float(0.5 + random.uniform());
    t.phase = float(2 * pi * random.uniform());
    triangles.triangles.push_back(t);
  }
  return triangles;
}

// The definition of Triangle by points: n² of them, one for each small triangle into which it is divided.
Sources dense_points(const Triangles& triangles, int n) {
  Sources points{triangles.wavelength, {}};
  const double lambda = triangles.wavelength;
  for (const Triangle& t : triangles.triangles) {
    const Vec3 c = centroid(t);
    const double area = area_along_direction(t) / (double(n) * n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n - i; ++j)
        for (int up = 0; up < (i + j < n - 1 ? 2 : 1); ++up) {
          const double b0 = (i + (1 + up) / 3.0) / n, b1 = (j + (1 + up) / 3.0) / n, b2 = 1 - b0 - b1;
          const Vec3 s = t.corners[0] * b0 + t.corners[1] * b1 + t.corners[2] * b2;
          const double a = t.amplitudes[0] * b0 + t.amplitudes[1] * b1 + t.amplitudes[2] * b2;
          const double quarter = s.z < 0 ? -0.25 : 0.25;  // 1/i, or −1/i for light that converges
          const double cycles =
              dot(t.direction, s - c) / lambda - cycle_fraction(-c.z / t.direction.z, lambda) + quarter;
          const double phase = t.phase + 2 * pi * (cycles - std::floor(cycles));
          points.waves.push_back({s, float(a * area / (lambda * std::abs(s.z))), float(phase)});
        }
  }
  return points;
}

// ∬ of the moments by Gauss-Legendre, 5 points on each of 24² pieces: exact to 1e-13 for phases up to some 30 rad,
// 1.3 rad on a piece.
std::array<std::complex<double>, 6> moments_by_quadrature(const double t[3]) {
  constexpr double x[5] = {0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640, -0.9061798459386640};
  constexpr double w[5] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                           0.2369268850561891};
  constexpr int pieces = 24;
  std::array<std::complex<double>, 6> sums{};
  for (int a = 0; a < pieces * 5; ++a)
    for (int b = 0; b < pieces * 5; ++b) {
      const double u = (a / 5 + 0.5 + x[a % 5] / 2) / pieces, v = (b / 5 + 0.5 + x[b % 5] / 2) / pieces;
      const double b0 = u, b1 = (1 - u) * v, b2 = 1 - b0 - b1;
      const auto e =
          std::polar(w[a % 5] * w[b % 5] / (4.0 * pieces * pieces) * (1 - u), b0 * t[0] + b1 * t[1] + b2 * t[2]);
      const double factors[6] = {b0, b1, b2, b0 * b1, b1 * b2, b0 * b2};
      for (size_t i = 0; i < 6; ++i) sums[i] += e * factors[i];
    }
  return sums;
}

// Phases from 0 to 30 rad, with equal ones among them (thin slivers, and the direction of the light itself),
// on both sides of the border between series and quotients. 1e-12 of the moments' size at 0, 1/24 to 1/6.
TEST(TriangleMoments, AgreeWithQuadratureInEveryDegenerateCase) {
  CounterRandom random(5, 0, 0);
  std::vector<std::array<double, 3>> cases{{0, 0, 0},     {2, 2, 2},       {0, 1.5, 1.5}, {1.5, 0, 1.5},
                                           {0, 0, 1.499}, {0, 1e-9, 1.5},  {0, 1e-3, 20}, {0, 20, 20 - 1e-6},
                                           {1e-8, 0, 0},  {-1, 0.5, 0.49}, {0, 0, 30}};
  for (int i = 0; i < 60; ++i) {
    const double size = std::pow(10.0, -4 + 5.4 * i / 59);
    cases.push_back({size * random.uniform(), size * random.uniform(), size * random.uniform()});
  }
  for (const auto& c : cases) {
    const CornerOrder o = order_corners(c.data());
    const double t[3] = {c[size_t(o.first)], c[size_t(o.middle)], c[size_t(o.last)]};
    const TriangleMoments<double> m = triangle_moments(t[0], t[1], t[2]);
    const auto expected = moments_by_quadrature(t);
    const Phasor<double> got[6] = {m.m0, m.m1, m.m2, m.m01, m.m12, m.m02};
    for (size_t i = 0; i < 6; ++i)
      EXPECT_LT(std::abs(std::complex<double>(got[i].re, got[i].im) - expected[i]), 1e-13)
          << "moment " << i << " of phases " << t[0] << ", " << t[1] << ", " << t[2];
  }
}

// The centroid rule on n² pieces has an error of O(1/n²): twice as dense, four times nearer. Extrapolated by that law,
// the points must agree with the closed form up to the floats of Source (1e-7), the bulge of sum_triangles_exact
// (0.003²/13 = 7e-7) and the next term of the law.
TEST(Triangles, AreTheLimitOfDensePoints) {
  const Grid panel{48, 40, 12_um};
  for (const bool is_flat : {true, false}) {
    const Triangles triangles = only(tilted_triangle(is_flat));
    const FieldDouble closed = sum_triangles_exact(triangles, panel, 0.003);
    const FieldDouble coarse = sum_exact(dense_points(triangles, 24), panel);
    FieldDouble fine = sum_exact(dense_points(triangles, 48), panel);
    const double error = relative_error(fine, closed);
    EXPECT_NEAR(relative_error(coarse, closed) / error, 4, 0.1);
    for (size_t i = 0; i < fine.samples.size(); ++i)
      fine.samples.values[i] += (fine.samples.values[i] - coarse.samples.values[i]) / 3.0;
    EXPECT_LT(relative_error(fine, closed), 1e-5);
    EXPECT_LT(relative_error(sum_triangles(triangles, panel, 1e-3), fine), 1e-3);
  }
}

// The same for light sent off the axis by 1°.
TEST(Triangles, SendTheirLightAlongTheirDirection) {
  const Grid panel{48, 40, 8_um, 1_mm, -0.5_mm};
  Triangle t = tilted_triangle(false);
  t.direction = normalize({1_mm, -0.5_mm, 60_mm});
  const FieldDouble closed = sum_triangles_exact(only(t), panel, 0.003);
  FieldDouble fine = sum_exact(dense_points(only(t), 48), panel);
  EXPECT_LT(relative_error(fine, closed), 2e-3);  // 4.6e-4 for light straight ahead with the same points
  EXPECT_LT(relative_error(sum_triangles(only(t), panel, 1e-3), closed), 1e-3);
  // Where the ray from the centroid meets the panel, the light has the phase φ₀ plus Gouy's and the envelope's phase,
  // which is even about the centroid of a small triangle.
  Triangle small = t;
  const Vec3 c = centroid(t);
  for (Vec3& corner : small.corners) corner = c + (corner - c) * 0.05;
  const FieldDouble one = sum_triangles_exact(only(small), {1, 1, 8_um, c.x + 1_mm, c.y - 0.5_mm}, 0.003);
  EXPECT_NEAR(std::arg(one.samples(0, 0)), 0.7 - pi / 2, 2e-3);
}

// Both references compute the same integral, one at pixels and one at frequencies. The spectrum ends at the panel's
// band, the light does not. They differ by the light beyond the band, which falls with the pitch.
TEST(Triangles, HaveTheSpectrumInClosedForm) {
  const Triangles triangles = only(tilted_triangle(false));
  double before = 1;
  for (const double pitch : {8_um, 4_um}) {
    const Grid panel{48, 40, pitch};
    const double error =
        relative_error(sum_triangles_spectrum(triangles, panel, 32), sum_triangles_exact(triangles, panel));
    EXPECT_LT(error, before / 2) << "pitch " << pitch;
    before = error;
  }
  EXPECT_LT(before, 5e-4);
}

// Far off the axis, at sin θ = 0.2, the spectrum has the 1/w of a spherical wave (Weyl's integral); with 1/λ instead
// there would be cos θ = 0.98 of the amplitude. The band ends at Nyquist, 0.72 mm beyond the panel. Its fringes
// are 1/(√2·π·14) = 1.6 % of the field there (Fresnel's integral at v = 0.72 mm·√(2/λz) = 14), plus 1.1 % from each of
// the window's three edges, 1 mm away; all four in phase are 5 %. They are 7 µm wide, so over the panel's light
// they average out.
TEST(Triangles, HaveTheSpectrumOfSphericalWavesFarOffTheAxis) {
  const double z = 10_mm;
  const Grid panel{64, 48, 1_um, z * std::tan(std::asin(0.2)), 0};
  Triangle t;
  t.corners = {Vec3{-0.3_um, -0.2_um, -z}, Vec3{0.4_um, -0.3_um, -z - 0.2_um}, Vec3{0, 0.4_um, -z + 0.1_um}};
  t.amplitudes = {1, 0.4F, 0.7F};
  const FieldDouble pixels = sum_triangles_exact(only(t), panel, 0.003);
  EXPECT_LT(relative_error(pixels, sum_exact(dense_points(only(t), 12), panel)), 1e-3);
  const FieldDouble spectrum = sum_triangles_spectrum(only(t), panel, 32);
  EXPECT_NEAR(std::sqrt(power(spectrum) / power(pixels)), 1, 0.005);
  EXPECT_LT(relative_error(spectrum, pixels), 0.05);
}

// Two triangles make a square parallel to the panel; propagate() computes the same aperture by Rayleigh and
// Sommerfeld's first integral. It has an obliquity factor of cos θ, 1 − 4e-5 at most here, and takes pixels as points:
// the square's light within a pixel is even to (π·p·sin θ/λ)²/6, 7e-4 at the corners, where there is little light.
TEST(Triangles, MakeASquareAperture) {
  const double a = 64_um, z = 40_mm;
  const Grid panel{160, 160, 2_um};
  Triangle lower, upper;
  lower.corners = {Vec3{-a, -a, -z}, Vec3{a, -a, -z}, Vec3{a, a, -z}};
  upper.corners = {Vec3{-a, -a, -z}, Vec3{a, a, -z}, Vec3{-a, a, -z}};
  lower.amplitudes = upper.amplitudes = {1, 1, 1};
  // The phase of a triangle is its phase on the panel; the aperture's is smaller by k·z.
  lower.phase = upper.phase = float(2 * pi * cycle_fraction(z, green));
  const FieldDouble square = sum_triangles_exact({green, {lower, upper}}, panel);
  const FieldDouble aperture = propagate(test::make_square_aperture(panel, green, a), z);
  EXPECT_LT(relative_error(square, aperture), 4e-4);
}

// The power a²·area of a triangle arrives, except for what leaves the box and the panel: the far tails of its transform
// fall as 1/u², so beyond ±R, 30 fringes of its sides, less than 2 % is left.
TEST(Triangles, SendThePowerOfTheirArea) {
  const Grid panel{512, 512, 8_um};
  const Triangles triangles = only(tilted_triangle(true));
  const double sent = area_along_direction(triangles.triangles[0]);
  const double received = power(sum_triangles(triangles, panel, 1e-2));
  EXPECT_LT(received, sent * 1.001);
  EXPECT_GT(received, sent * 0.96);
}

class TrianglesKeep : public ::testing::TestWithParam<double> {};

// Sizes from a tenth of a fringe to several fringes, near and far, with boxes that end on the panel.
TEST_P(TrianglesKeep, TheTolerance) {
  const Grid panel{150, 97, 8_um};
  struct Case {
    double depth, size;
  };
  for (const Case& c : {Case{30_mm, 10_um}, Case{30_mm, 60_um}, Case{0.2_m, 20_um}, Case{0.2_m, 150_um}}) {
    const Triangles triangles = random_triangles(6, panel, c.depth, c.size);
    const FieldDouble exact = sum_triangles_exact(triangles, panel, 0.03);
    Heard heard;
    EXPECT_LT(relative_error(sum_triangles(triangles, panel, GetParam(), heard.observer()), exact), GetParam())
        << "depth " << c.depth << ", size " << c.size;
    EXPECT_LE(1.25 * heard.number("expected_error"), GetParam());
  }
}
INSTANTIATE_TEST_SUITE_P(Tolerances, TrianglesKeep, ::testing::Values(3e-2, 1e-2, 3e-3, 1e-3));

// Single triangles, whose errors nothing averages out.
TEST(Triangles, KeepTheToleranceOneByOne) {
  const Grid panel{96, 80, 8_um};
  for (const double depth : {30_mm, 0.2_m})
    for (const double size : {20_um, 60_um, 150_um}) {
      const Triangles all = random_triangles(4, panel, depth, size);
      for (const Triangle& t : all.triangles) {
        const FieldDouble exact = sum_triangles_exact(only(t), panel, 0.01);
        EXPECT_LT(relative_error(sum_triangles(only(t), panel, 1e-3), exact), 1e-3) << depth << " " << size;
      }
    }
}

// Twice the amplitudes, and the sum of two sets. Both sums have an error of 1e-3.
TEST(Triangles, AreLinear) {
  const Grid panel{80, 60, 8_um};
  Triangles both = random_triangles(6, panel, 0.1_m, 50_um), first = both, second = both;
  first.triangles.resize(3);
  second.triangles.erase(second.triangles.begin(), second.triangles.begin() + 3);
  for (Triangle& t : first.triangles)
    for (float& a : t.amplitudes) a *= 2;
  for (size_t i = 0; i < 3; ++i)
    for (float& a : both.triangles[i].amplitudes) a *= 2;
  Field sum = sum_triangles(first, panel, 1e-3);
  const Field other = sum_triangles(second, panel, 1e-3);
  for (size_t i = 0; i < sum.samples.size(); ++i) sum.samples.values[i] += other.samples.values[i];
  EXPECT_LT(relative_error(sum, sum_triangles_exact(both, panel, 0.03)), 1e-3);
}

TEST(Triangles, GiveTheSameBytesOnAnyNumberOfThreads) {
  const Grid panel{200, 150, 8_um};
  const Triangles triangles = random_triangles(40, panel, 0.1_m, 60_um);
  const auto on = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return sum_triangles(triangles, panel, 1e-2).samples.values;
  };
  const auto one = on(1);
  EXPECT_EQ(one, on(2));
  EXPECT_EQ(one, on(7));
}

// Frame 0 again after frame 3 equals frame 0; random_phase alone sets the phases.
TEST(Triangles, OfAnotherFrameHaveOtherPhases) {
  Triangles triangles = random_triangles(4, {64, 64, 8_um}, 0.1_m, 50_um);
  triangles.seed = 9;
  for (size_t i = 0; i < 4; ++i) {
    triangles.phase_keys.push_back(100 + i);
    triangles.triangles[i].phase = float(random_phase(9, 0, 100 + i));
  }
  Triangles moved = triangles;
  set_frame(moved, 3);
  for (size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(std::remainder(moved.triangles[i].phase - random_phase(9, 3, 100 + i), 2 * pi), 0, 1e-5);
  set_frame(moved, 0);
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(moved.triangles[i].phase, triangles.triangles[i].phase, 1e-5);
}

// Half of the triangles in front of the panel: by the definition, from dense points that waves leave or converge to. 60² points per
// triangle are 2 µm apart, 1/20 of what the panel resolves at 60 mm: the midpoint rule is within 1e-3.
TEST(Triangles, ThatAreInFrontOfThePanelAreTheLightThatConvergesToThem) {
  const Grid panel{48, 40, 12_um};
  Triangles triangles = random_triangles(6, panel, 60_mm, 60_um);
  CounterRandom random(8, 0, 0);
  for (size_t i = 0; i < 6; ++i) {
    Triangle& t = triangles.triangles[i];
    t.direction = normalize({0.01 * (random.uniform() - 0.5), 0.01 * (random.uniform() - 0.5), 1});
    if (i % 2 == 1)
      for (Vec3& corner : t.corners) corner.z = -corner.z;
  }
  const FieldDouble expected = sum_exact(dense_points(triangles, 60), panel);
  EXPECT_LT(relative_error(sum_triangles_exact(triangles, panel), expected), 2e-3);
  EXPECT_LT(relative_error(sum_triangles(triangles, panel, 1e-3), expected), 3e-3);
  for (Triangle& t : triangles.triangles) t.direction = {0, 0, 1};
  EXPECT_GT(relative_error(sum_triangles_exact(triangles, panel), expected), 0.1) << "their directions count";
}

TEST(Triangles, ThatAreBadInputAreNamed) {
  const Grid panel{16, 16, 8_um};
  const auto error = [&](const auto& change) {
    Triangles triangles = {green, {tilted_triangle(true), tilted_triangle(true)}};
    change(triangles);
    return error_of([&] { sum_triangles(triangles, panel, 1e-2); });
  };
  EXPECT_EQ(error([](Triangles& t) { t.triangles[1].corners[2] = t.triangles[1].corners[0]; }),
            "expected triangle 1 to have an area, got corners in one line; leave it out");
  EXPECT_EQ(
      error([](Triangles& t) { t.triangles[1].corners[0].z = 0; }),
      "expected triangle 1 behind the panel (z < 0) or in front of it (z > 0), got corners at z = 0 m and 0 m; cut it at the "
      "panel, or move it");
  EXPECT_EQ(
      error([](Triangles& t) { t.triangles[1].corners[1].z = 1e-3; }),
      "expected triangle 1 behind the panel (z < 0) or in front of it (z > 0), got corners at z = -60 mm and 1 mm; cut it at "
      "the panel, or move it");
  EXPECT_EQ(error([](Triangles& t) {
              t.triangles[0].direction = {0, 0, -1};
            }),
            "expected a direction of length 1 toward the viewer (z > 0) for triangle 0, got (0, 0, -1)");
  EXPECT_NE(error([](Triangles& t) { t.triangles[0].amplitudes[0] = NAN; }).find("finite numbers in triangle 0"),
            std::string::npos);
  EXPECT_EQ(error([](Triangles& t) { t.phase_keys = {1}; }),
            "expected a phase key for each of 2 triangles, or none, got 1");
  EXPECT_EQ(error([](Triangles& t) { t.triangles.clear(); }),
            "expected at least one triangle, got none; is the scene lit and in view?");
  EXPECT_EQ(error([](Triangles& t) {
              for (Vec3& c : t.triangles[0].corners) c.z = -1e-12;
            }).substr(0, 61),
            "expected triangles that need 1048576 parts or fewer each, but");
}

TEST(Triangles, OutOfReachAreCounted) {
  const Grid panel{64, 64, 8_um};
  Triangles triangles = random_triangles(3, panel, 60_mm, 50_um);
  for (Vec3& corner : triangles.triangles[1].corners) corner.x += 20_mm;
  Heard heard;
  sum_triangles(triangles, panel, 1e-2, heard.observer());
  ASSERT_EQ(heard.warnings.size(), 1U);
  EXPECT_EQ(heard.warnings[0].substr(0, 31), "1 of 3 triangles light no pixel");
}

// A triangle that reaches away from the panel: at 0.35 mm beside it, the near corner at 9.5 mm lights ±0.32 mm and
// misses it, the far ones at 11.5 mm light ±0.38 mm.
TEST(Triangles, LightThePanelByTheirFarPartAlone) {
  const Grid panel{64, 64, 8_um};
  Triangle t;
  t.corners = {Vec3{600_um, 0, -9.5_mm}, Vec3{620_um, -30_um, -11.5_mm}, Vec3{620_um, 30_um, -11.5_mm}};
  t.amplitudes = {1, 1, 1};
  t.direction = normalize(Vec3{250_um, 0, 0} - centroid(t));  // to the panel's edge
  const FieldDouble points = sum_exact(dense_points(only(t), 150), panel);
  const double expected = power(points);
  ASSERT_GT(expected, 0);
  // Each part has one box, each point its own: they differ by the size of a part, some pixels of those that are lit.
  EXPECT_NEAR(power(sum_triangles(only(t), panel, 1e-2)), expected, 0.3 * expected);
}

}  // namespace
}  // namespace holotrace
