#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/cie.h"
#include "holotrace/data/light_spectrum.h"
#include "holotrace/data/smooth_reflectance.h"
#include "holotrace/data/spectrum.h"
#include "support/error_of.h"

namespace holotrace {
namespace {

Vec2 chromaticity(Vec3 xyz) {
  const double sum = xyz.x + xyz.y + xyz.z;
  return {xyz.x / sum, xyz.y / sum};
}

Vec2 chromaticity_of(const Spectrum& spectrum) {
  return chromaticity(xyz_of([&](double wavelength) { return spectrum.at(wavelength); }));
}

// Published to four digits (CIE 015:2018, tables 2 and 6); the sums stop at 780 nm and are in steps of 5 nm.
constexpr double published = 5e-4;

TEST(Cie, IlluminantsHaveTheirPublishedChromaticities) {
  const struct {
    const char* name;
    double x, y;
  } known[] = {{"A", 0.4476, 0.4074},   {"D50", 0.3457, 0.3585}, {"D55", 0.3324, 0.3474},
               {"D65", 0.3127, 0.3290}, {"D75", 0.2990, 0.3149}, {"E", 1 / 3., 1 / 3.}};
  for (const auto& [name, x, y] : known) {
    const Vec2 found = chromaticity_of(illuminant_spectrum(name));
    EXPECT_NEAR(found.x, x, published) << name;
    EXPECT_NEAR(found.y, y, published) << name;
  }
}

TEST(Cie, LinesHaveTheirPlacesOnTheSpectralLocus) {
  // Chromaticities of monochromatic light (CIE 015:2018, table 1), to four digits. 485 and 555 nm are between the rows kept
  // here: the cubic is right to 3e-3.
  const struct {
    double nanometres, x, y, tolerance;
  } known[] = {{450, 0.1566, 0.0177, 1e-4}, {520, 0.0743, 0.8338, 1e-4}, {600, 0.6270, 0.3725, 1e-4},
               {650, 0.7260, 0.2740, 1e-4}, {485, 0.0687, 0.2007, 3e-3}, {555, 0.3373, 0.6589, 3e-3}};
  for (const auto& [nanometres, x, y, tolerance] : known) {
    const Vec2 found = chromaticity(colour_matching(nanometres * 1e-9));
    EXPECT_NEAR(found.x, x, tolerance) << nanometres;
    EXPECT_NEAR(found.y, y, tolerance) << nanometres;
  }
  EXPECT_EQ(colour_matching(379e-9), Vec3());
  EXPECT_EQ(colour_matching(781e-9), Vec3());
}

TEST(Cie, SrgbHasTheWhiteOfD65AndAnInverse) {
  const Vec2 white = chromaticity(xyz_from_srgb({1, 1, 1}));
  EXPECT_NEAR(white.x, 0.3127, 5e-5);  // four digits
  EXPECT_NEAR(white.y, 0.3290, 5e-5);
  const Vec3 back = srgb_from_xyz(xyz_from_srgb({0.2, 0.5, 0.9}));
  // Seven digits of each number of both matrices.
  EXPECT_NEAR(back.x, 0.2, 1e-6);
  EXPECT_NEAR(back.y, 0.5, 1e-6);
  EXPECT_NEAR(back.z, 0.9, 1e-6);
}

TEST(Cie, ABlackBodyFollowsWienAndStefanBoltzmann) {
  // λT = 2.897771955 mm·K at the maximum (CODATA 2018), where neighbours 0.1 % away are darker.
  const double peak = 2.897771955e-3 / 5778;
  EXPECT_GT(planck(peak, 5778), planck(peak * 1.001, 5778));
  EXPECT_GT(planck(peak, 5778), planck(peak / 1.001, 5778));
  // π∫B dλ = σT⁴, by the midpoint rule from 0.1 to 100 µm, which leave out 2e-5 of the light.
  double sum = 0;
  const int steps = 4000;
  for (int i = 0; i < steps; ++i) {
    const double wavelength = 1e-7 * std::pow(1000, (i + 0.5) / steps);
    sum += planck(wavelength, 5778) * wavelength * std::log(1000.0) / steps;
  }
  EXPECT_NEAR(pi * sum / (5.670374419e-8 * std::pow(5778, 4)), 1, 1e-4);
}

TEST(Cie, LampsHaveTheLuminanceOfEvenLight) {
  const double even = xyz_of([](double) { return 1; }).y;
  const Spectrum lamps[] = {blackbody_spectrum(2700), illuminant_spectrum("D65"), led_spectrum(450e-9, 20e-9)};
  for (const Spectrum& lamp : lamps)  // a curve of 20 nm in steps of 5 and of 1 nm
    EXPECT_NEAR(xyz_of([&](double wavelength) { return lamp.at(wavelength); }).y / even, 1, 2e-3);
  const Spectrum led = led_spectrum(520e-9, 30e-9);
  EXPECT_NEAR(led.at(505e-9) / led.at(520e-9), 0.5, 1e-12) << "half of the height at half of the width";
  EXPECT_NEAR(led.at(535e-9) / led.at(520e-9), 0.5, 1e-12);
}

TEST(Cie, NarrowLinesBetweenWholeNanometresCount) {
  // A triangle of 0.1 nm at its foot has the same area wherever it stands; V falls by 1.5 % in half a nanometre there. Its luminance
  // is that of even light, ∫ V dλ = 106.857 nm (CIE 1931, from 380 to 780 nm): the peak is 106.857/(0.05·V).
  for (const double centre : {546.1e-9, 546.0e-9, 546.43e-9}) {
    const Spectrum line = scaled_to_luminance({{centre - 0.05e-9, centre, centre + 0.05e-9}, {0, 3, 0}});
    const double expected = 106.857 / (0.05 * colour_matching(centre).y);
    EXPECT_NEAR(line.values[1] / expected, 1, 2e-3) << centre;  // the observer's curves here are a fit
  }
}

TEST(Cie, BadLampsSayWhatWasExpected) {
  EXPECT_EQ(error_of([] { blackbody_spectrum(50); }),
            "expected a temperature of a lamp from 1000 to 40000 K, got 50 K");
  EXPECT_EQ(error_of([] { illuminant_spectrum("D66"); }), "unknown illuminant \"D66\"; did you mean \"D65\"?");
  EXPECT_EQ(error_of([] { led_spectrum(900e-9, 20e-9); }),
            "expected the peak of an LED from 380 nm to 780 nm, got 900 nm");
  EXPECT_EQ(error_of([] { led_spectrum(500e-9, 1e-9); }),
            "expected the width of an LED's curve from 2 to 300 nm, got 1 nm");
}

// The colour in daylight of a surface, from its spectrum alone.
Vec3 colour_in_daylight(const SmoothReflectance& surface) {
  const Spectrum daylight = illuminant_spectrum("D65");
  const double white = xyz_of([&](double wavelength) { return daylight.at(wavelength); }).y;
  return srgb_from_xyz(xyz_of([&](double wavelength) { return surface.at(wavelength) * daylight.at(wavelength); }) /
                       white);
}

TEST(SmoothReflectance, HasItsColourInDaylight) {
  for (const double r : {0.02, 0.2, 0.5, 0.9})
    for (const double g : {0.02, 0.3, 0.6, 0.95})
      for (const double b : {0.02, 0.1, 0.5, 0.8}) {
        const SmoothReflectance spectrum = fit_reflectance({r, g, b});
        const Vec3 found = spectrum.colour();
        EXPECT_NEAR(found.x, r, 1e-3) << r << ' ' << g << ' ' << b;
        EXPECT_NEAR(found.y, g, 1e-3) << r << ' ' << g << ' ' << b;
        EXPECT_NEAR(found.z, b, 1e-3) << r << ' ' << g << ' ' << b;
        // The daylight of the lamp has the temperature 6504 K, whose white is that of sRGB to 2e-3.
        const Vec3 seen = colour_in_daylight(spectrum);
        EXPECT_NEAR(seen.x, r, 3e-3);
        EXPECT_NEAR(seen.y, g, 3e-3);
        EXPECT_NEAR(seen.z, b, 3e-3);
        for (double wavelength = 380e-9; wavelength <= 780e-9; wavelength += 20e-9) {
          EXPECT_GE(spectrum.at(wavelength), 0);
          EXPECT_LE(spectrum.at(wavelength), 1);
        }
      }
}

TEST(SmoothReflectance, OfGreyIsGreyAndOfWhiteAndBlackNearly) {
  const SmoothReflectance grey = fit_reflectance({0.4, 0.4, 0.4});
  for (double wavelength = 400e-9; wavelength < 700e-9; wavelength += 50e-9)
    EXPECT_NEAR(grey.at(wavelength), 0.4, 1e-6);                // the error at which the solver stops is 1e-7
  EXPECT_NEAR(fit_reflectance({1, 1, 1}).at(550e-9), 1, 2e-4);  // limited to 1e-4
  EXPECT_NEAR(fit_reflectance({0, 0, 0}).at(550e-9), 0, 2e-4);
}

// Sum of the columns: equal light at all wavelengths.
Vec3 sum_of(const std::vector<Vec3>& columns) {
  Vec3 sum;
  for (const Vec3 column : columns) sum += column;
  return sum;
}

TEST(CieColours, ThreeLasersAreWhiteTogetherAndEachHasItsOwnColour) {
  const std::vector<double> lines{638e-9, 520e-9, 450e-9};
  const auto columns = cie_colour_matrix(lines);
  const Vec3 white = sum_of(columns);
  EXPECT_NEAR(white.x, 1, 1e-9);
  EXPECT_NEAR(white.y, 1, 1e-9);
  EXPECT_NEAR(white.z, 1, 1e-9);
  for (size_t n = 0; n < 3; ++n) {
    const Vec2 found = chromaticity(xyz_from_srgb(columns[n])), expected = chromaticity(colour_matching(lines[n]));
    EXPECT_NEAR(found.x, expected.x, 1e-5);  // seven digits of the matrices, over a green component of −0.6
    EXPECT_NEAR(found.y, expected.y, 1e-5);
  }
  EXPECT_LT(columns[1].x, 0) << "a green laser is outside of sRGB";
}

TEST(CieColours, OfOneWavelengthHaveTheLuminanceOfTheLight) {
  const Vec3 green = cie_colour_matrix({520e-9}).front();
  EXPECT_NEAR(luminance(green.x, green.y, green.z), 1, 3e-4);  // weights of four digits, times components of 2 in all
  EXPECT_EQ(error_of([] { cie_colour_matrix({1064e-9}); }),
            "expected a wavelength from 380 nm to 780 nm for colours of the CIE, got 1.064 µm");
}

TEST(CieColours, OutsideOfSrgbAreMixedWithWhiteOfTheirLuminance) {
  const Vec3 green{-0.4, 1.2, -0.1}, shown = within_gamut(green);
  EXPECT_NEAR(luminance(shown.x, shown.y, shown.z), luminance(green.x, green.y, green.z), 1e-12);
  EXPECT_NEAR(shown.x, 0, 1e-12);
  EXPECT_GT(shown.z, 0);
  // On the line from the colour to grey: all differences have one ratio.
  EXPECT_NEAR((shown.y - shown.x) / (green.y - green.x), (shown.z - shown.x) / (green.z - green.x), 1e-12);
  EXPECT_EQ(within_gamut({0.3, 0, 2}), (Vec3{0.3, 0, 2}));
  EXPECT_EQ(within_gamut({-1, -1, 0}), Vec3());
}

}  // namespace
}  // namespace holotrace
