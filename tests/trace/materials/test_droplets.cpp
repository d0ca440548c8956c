#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holotrace/data/refractive_index.h"
#include "holotrace/trace/materials/droplets.h"

// Spheres of Lorenz and Mie against published tables, and water droplets against geometrical optics.

namespace holotrace {
namespace {

struct Published {
  double x;
  std::complex<double> m;
  double extinction, scattering, tolerance;
};

// Bohren and Huffman 1983, appendix A (1.05 um across, 632.8 nm), and the test cases of W. Wiscombe, Mie Scattering Calculations, NCAR/TN-140+STR,
// 1979 (others); to the digits that are printed. A logarithmic derivative begun too near to n = |m·x| is off by 1e-5 at x = 100.
TEST(Droplets, EfficienciesAreThoseOfPublishedTables) {
  for (const auto& [x, m, extinction, scattering, tolerance] :
       {Published{2 * pi * 0.525 / 0.6328, 1.55, 3.10543, 3.10543, 6e-6}, Published{10, 0.75, 2.232265, 2.232265, 1e-6},
        Published{1000, 0.75, 1.997908, 1.997908, 1e-6}, Published{1, {1.5, 1}, 2.336321, 0.663454, 1e-6},
        Published{100, {1.5, 1}, 2.097502, 1.283697, 1e-6}, Published{1, {1.33, 1e-5}, 0.093952, 0.093923, 1e-6},
        Published{100, {1.33, 1e-5}, 2.101321, 2.096594, 1e-6}}) {
    const MieSphere sphere(x, m);
    EXPECT_NEAR(sphere.extinction(), extinction, tolerance) << x << m;
    EXPECT_NEAR(sphere.scattering(), scattering, tolerance) << x << m;
  }
}

// Much smaller than the wavelength: Q_sca = 8/3·x⁴·|(m² − 1)/(m² + 2)|² and 3(1 + cos²θ)/16π (Rayleigh), up to a part of x².
TEST(Droplets, SmallSpheresScatterAsRayleighFound) {
  const double x = 0.01, m = 1.33, ratio = (m * m - 1) / (m * m + 2);
  const MieSphere sphere(x, m);
  EXPECT_NEAR(sphere.scattering() / (8.0 / 3 * std::pow(x, 4) * ratio * ratio), 1, 1e-3);
  for (const double cosine : {-1.0, -0.3, 0.0, 0.8, 1.0})
    EXPECT_NEAR(sphere.phase(cosine) / (3 * (1 + cosine * cosine) / (16 * pi)), 1, 1e-3);
}

// ∫p dω = 1 by Simpson's rule in the angle, with 40 steps per ripple of 2π/x: 1e-5. The tables are normalised exactly, and hold p.
TEST(Droplets, PhaseFunctionsAreNormalised) {
  for (const double x : {0.5, 12.0, 90.0}) {
    const MieSphere sphere(x, 1.34);
    const PhaseTable table(sphere, x);
    const int steps = 2 * int(40 * x + 200);
    double sum = 0;
    for (int i = 0; i <= steps; ++i) {
      const double angle = pi * i / steps;
      sum += (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2) * sphere.phase(std::cos(angle)) * std::sin(angle);
    }
    EXPECT_NEAR(2 * pi * sum * pi / steps / 3, 1, 1e-5) << x;
    const double cosine = std::cos(0.3);
    EXPECT_NEAR(table.at(cosine) / sphere.phase(cosine), 1, 0.2) << x;  // cells of 1/20 of a ripple, of steep flanks
  }
}

// Drops of rain: the sum of all terms, term by term in Python with complex numbers, to the digits that were printed.
TEST(Droplets, LargeDropsHaveThePhaseOfTheFullSum) {
  for (const auto& [wavelength, phase] :
       {std::pair{450e-9, 0.02044140082}, {532e-9, 0.02459626232}, {638e-9, 0.02607922904}}) {
    const MieSphere drop(2 * pi * 200e-6 / wavelength, 1.333);
    EXPECT_NEAR(drop.phase(-0.7400001) / phase, 1, 1e-8) << wavelength;
    EXPECT_NEAR(drop.phases({0.7400001}).behind[0] / phase, 1, 1e-8) << wavelength;
  }
}

/// Angle between the sun's rays, prolonged, and a rainbow of one inner reflection [rad]: 4·r − 2·i at its extremum, cos²i =
/// (n² − 1)/3 (Descartes).
double rainbow(double n) {
  const double i = std::acos(std::sqrt((n * n - 1) / 3)), r = std::asin(std::sin(i) / n);
  return 4 * r - 2 * i;
}

/// The angle below 180° − `from` at which droplets of about a size are brightest, averaged over the ripples of ±2 % of sizes.
double brightest(double x, double n, double from, double to) {
  constexpr int steps = 60, sizes = 12;
  std::vector<double> light(steps, 0.0);
  for (int s = 0; s < sizes; ++s) {
    const MieSphere sphere(x * (0.98 + 0.04 * (s + 0.5) / sizes), n);
    for (int i = 0; i < steps; ++i) light[size_t(i)] += sphere.phase(-std::cos(from + (to - from) * i / steps));
  }
  // The middle of what is above three quarters of the largest: the ripples that are left do not move it.
  const double most = *std::max_element(light.begin(), light.end());
  double sum = 0, moment = 0;
  for (size_t i = 0; i < steps; ++i)
    if (light[i] > 0.75 * most) sum += light[i], moment += light[i] * double(i);
  return from + (to - from) * moment / sum / steps;
}

// Water: 42.5° at 650 nm and 40.7° at 400 nm are quoted; they belong to the indices 1.3300 and 1.3426. Those of our table, 1.3317 and
// 1.3436, lie 0.23° and 0.13° inside of them. A wave's rainbow lies inside of it by 1.0845·(h·π²/12)^(1/3)·x^(−2/3),
// h = 9/4·√((4 − n²)/(n² − 1)³) (Airy; H. van de Hulst, Light Scattering by Small Particles, 1957, section 13.23). The centre of the part
// above three quarters lies at 0.98 of it (by the same function), and Airy's theory is good to 0.1° at x = 1000.
TEST(Droplets, RainbowsAreWhereGeometricalOpticsHasThem) {
  const RefractiveIndex water = glass_index("water");
  for (const auto& [wavelength, angle] : {std::pair{650e-9, 42.5}, std::pair{400e-9, 40.7}}) {
    const double n = index_at(water, wavelength).real(), degree = pi / 180;
    EXPECT_NEAR(rainbow(n) / degree, angle, 0.25) << wavelength;
    const double x = 1000, h = 9.0 / 4 * std::sqrt((4 - n * n) / std::pow(n * n - 1, 3));
    const double inside = 1.0845 * std::cbrt(h * pi * pi / 12) * std::pow(x, -2.0 / 3);
    const double found = brightest(x, n, rainbow(n) - 2 * inside, rainbow(n) + 0.2 * inside);
    EXPECT_NEAR(found / degree, (rainbow(n) - 0.98 * inside) / degree, 0.1) << wavelength;
  }
}

}  // namespace
}  // namespace holotrace
