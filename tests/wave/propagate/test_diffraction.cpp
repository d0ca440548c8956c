// Diffraction with known answers: closed_forms.md section 5, cases 3 to 8 and 12.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/propagate/propagation_kernel.h"
#include "support/fields.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;
using test::make_disc_aperture;
using test::make_field;
using test::make_square_aperture;

constexpr double a = 0.5_mm;  // radius, or half of the side

double aperture_on_axis(double z) {  // Rayleigh–Sommerfeld I, a plane wave on a disc
  const double R = std::hypot(z, a), extra = a * a / (R + z);
  return 1 + z * z / (R * R) - 2 * z / R * std::cos(2 * pi * extra / green);
}

std::complex<double> light_on_axis(const FieldDouble& field, double z) {
  return sum_rayleigh_sommerfeld(field, {{0, 0, z}})[0];
}

TEST(CircularAperture, HasTheClosedFormOnItsAxis) {  // case 3
  const struct {
    double z, intensity;
  } cases[] = {{0.05_m, 2.628283}, {0.1_m, 3.171556}, {0.2_m, 1.089891}, {0.469925_m, 3.999998}, {0.234962_m, 5.6e-11}};
  const Grid grid{1041, 1041, 1_um};
  const FieldDouble disc = make_disc_aperture(grid, green, a);
  for (const auto& c : cases) {
    EXPECT_NEAR(aperture_on_axis(c.z), c.intensity, 6e-7);  // digits given
    // At the rim x = a the mean of the wave over a pixel of 1 µm differs from its value at the middle by (k·a·p/z)²/24.
    // The open part of a pixel lies off its middle by up to as much. dI = 2|U|·d|U|, |U| ≤ 2.
    const double tolerance = 4 * std::pow(2 * pi / green * a * grid.pitch / c.z, 2) / 12;
    const FieldDouble far = propagate(disc, c.z);
    EXPECT_NEAR(std::norm(far.samples(520, 520)), c.intensity, tolerance) << c.z;
  }
}

TEST(OpaqueDisc, HasPoissonsSpotByBabinet) {  // case 4
  const Grid grid{1041, 1041, 1_um};
  const FieldDouble disc = make_disc_aperture(grid, green, a);
  EXPECT_NEAR(0.05 * 0.05 / (0.05 * 0.05 + a * a), 0.99990001, 5e-9);
  for (const double z : {0.05_m, 0.1_m, 0.2_m}) {
    // Disc + aperture = plane wave: the shadow is the plane wave less the light of the aperture.
    const auto behind = cis_cycles(cycle_fraction(z, green)) - propagate(disc, z).samples(520, 520);
    const double tolerance = 2 * std::pow(2 * pi / green * a * grid.pitch / z, 2) / 12;  // as above, |U| = 1
    EXPECT_NEAR(std::norm(behind), z * z / (z * z + a * a), tolerance) << z;
  }
}

TEST(SquareAperture, HasTheRayleighSommerfeldValuesOnItsAxis) {  // case 5
  const struct {
    double z, exact, fresnel;
  } cases[] = {{0.1_m, 1.713136, 1.713158}, {0.2_m, 1.307133, 1.307146}, {0.5_m, 2.761694, 2.761693}};
  for (const auto& c : cases) {
    // The sum's error is proportional to the square of the pitch: Richardson extrapolation from two pitches removes it.
    const auto combined = [&](const auto& light) {
      const double coarse = 501, fine = 1001, r = (fine / coarse) * (fine / coarse);
      const auto at = [&](double n) { return light(make_square_aperture({int(n), int(n), 2 * a / n}, green, a)); };
      return std::norm((r * at(fine) - at(coarse)) / (r - 1));
    };
    EXPECT_NEAR(combined([&](const FieldDouble& f) { return light_on_axis(f, c.z); }), c.exact, 2e-6) << c.z;
    PropagateParams rs, fresnel;
    rs.method = PropagationMethod::rayleigh_sommerfeld;
    fresnel.method = PropagationMethod::fresnel;
    const auto centre = [&](const PropagateParams& params) {
      return
          [&, params](const FieldDouble& f) { return propagate(f, c.z, params).samples(f.grid.ny / 2, f.grid.nx / 2); };
    };
    EXPECT_NEAR(combined(centre(rs)), c.exact, 2e-6) << c.z;  // digits given, and the sum's error of order h⁴
    EXPECT_NEAR(combined(centre(fresnel)), c.fresnel, 2e-6) << c.z;
  }
}

TEST(KnifeEdge, HasItsQuarterItsMaximumAndItsMinimum) {  // case 6
  // Fresnel diffraction is separable: light behind the edge over light behind the same window without the edge.
  const double z = 0.1_m, unit = std::sqrt(green * z / 2), pitch = unit / 64;
  const Grid grid{16385, 8, pitch};
  const double half = grid.width() / 2;
  const auto window = [&](double x) {  // open, falling smoothly to 0 in the outer half
    const double t = std::abs(x) / half;
    return t < 0.4 ? 1.0 : std::exp(-std::pow((t - 0.4) / 0.13, 2));
  };
  const FieldDouble open = make_field(grid, green, [&](double x, double) { return window(x); });
  const FieldDouble edge = make_field(grid, green, [&](double x, double) {
    return window(x) * (std::abs(x) < pitch / 4 ? 0.5 : x > 0 ? 1.0 : 0.0);  // the edge halves the middle pixel
  });
  PropagateParams params;
  params.method = PropagationMethod::fresnel;
  const FieldDouble behind = propagate(edge, z, params), without = propagate(open, z, params);
  const auto intensity = [&](int i) { return std::norm(behind.samples(4, i)) / std::norm(without.samples(4, i)); };
  const int middle = grid.nx / 2;
  // Pixels of 1/64 of the unit give the integral to about (1/64)²·π/24 of the amplitude.
  EXPECT_NEAR(intensity(middle), 0.25, 1e-4);
  int top = middle, bottom = middle + 64;
  for (int i = middle; i < middle + 2 * 64; ++i)
    if (intensity(i) > intensity(top)) top = i;
  for (int i = top; i < middle + 5 * 32; ++i)
    if (intensity(i) < intensity(bottom)) bottom = i;
  EXPECT_NEAR(intensity(top), 1.370430, 1e-3);
  EXPECT_NEAR(double(top - middle) / 64, 1.2165, 1.0 / 64);
  EXPECT_NEAR(intensity(bottom), 0.778277, 1e-3);
  EXPECT_NEAR(double(bottom - middle) / 64, 1.873, 1.0 / 64);
}

TEST(SquareAperture, HasASincSquaredFarField) {  // case 7
  const double b = 0.2_mm, z = 5_m;
  const FieldDouble square = make_square_aperture({101, 101, b / 101}, green, b / 2);
  const double unit = green * z / b;
  std::vector<Vec3> points{{0, 0, z}, {unit, 0, z}};
  for (int n = 0; n <= 200; ++n) points.push_back({unit * (1.3 + 0.3 * n / 200), 0, z});
  const auto light = sum_rayleigh_sommerfeld(square, points);
  const double peak = std::norm(light[0]);
  // Fraunhofer's neglected phase: k(b/2)²/2z = 0.012 rad fills the zero to (0.012)²/10; cosines of 2.7e-3 rad.
  EXPECT_NEAR(std::norm(light[1]) / peak, 0, 2e-5);
  double lobe = 0;
  for (size_t n = 2; n < points.size(); ++n) lobe = std::max(lobe, std::norm(light[n]) / peak);
  EXPECT_NEAR(lobe, 0.0471904, 1e-4);
}

TEST(CircularAperture, HasAnAiryFarField) {  // case 8
  const double D = 0.2_mm, z = 5_m, unit = green * z / D;
  const FieldDouble disc = make_disc_aperture({205, 205, D / 201}, green, D / 2);
  std::vector<Vec3> points{{0, 0, z}};
  for (int n = 0; n <= 400; ++n) points.push_back({unit * (1.0 + n / 400.0), 0, z});
  const auto light = sum_rayleigh_sommerfeld(disc, points);
  const double peak = std::norm(light[0]);
  size_t dark = 1;
  double ring = 0;
  for (size_t n = 1; n < points.size(); ++n)
    if (std::norm(light[n]) < std::norm(light[dark])) dark = n;
  for (size_t n = dark; n < points.size(); ++n) ring = std::max(ring, std::norm(light[n]) / peak);
  EXPECT_NEAR(points[dark].x / unit, 1.2196699, 1.0 / 400);  // the step of the points
  EXPECT_NEAR(ring, 0.0174978, 1e-4);                        // neglected phases as in case 7
}

TEST(Panel, FocusesAPointToItsSinc) {  // case 12
  const Grid panel{1920, 1080, 8_um};
  const struct { double z, zero_x, zero_y; } cases[] = {{0.2_m, 6.927_um, 12.315_um}, {0.3_m, 10.391_um, 18.472_um}};
  for (const auto& c : cases) {
    EXPECT_NEAR(green * c.z / panel.width(), c.zero_x, 0.6e-9);  // digits given
    EXPECT_NEAR(green * c.z / panel.height(), c.zero_y, 0.6e-9);
    const FieldDouble lens = make_field(panel, green, [&](double x, double y) {
      return std::conj(cis_cycles(path_beyond_depth(x * x + y * y, c.z) / green));
    });
    const auto light =
        sum_rayleigh_sommerfeld(lens, {{0, 0, c.z}, {c.zero_x, 0, c.z}, {0, c.zero_y, c.z}, {c.zero_x / 2, 0, c.z}});
    const double peak = std::norm(light[0]);
    // Non-paraxial terms scale the zero by about (S/2z)²/2 = 7e-4, where sinc² has fallen to its square.
    EXPECT_LT(std::norm(light[1]) / peak, 2e-6) << c.z;
    EXPECT_LT(std::norm(light[2]) / peak, 2e-6) << c.z;
    EXPECT_NEAR(std::norm(light[3]) / peak, 4 / (pi * pi), 2e-3) << c.z;  // sinc²(1/2)
  }
}

}  // namespace
}  // namespace holotrace
