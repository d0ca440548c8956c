#include <gtest/gtest.h>

#include "holotrace/data/refractive_index.h"
#include "holotrace/trace/materials/fresnel.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

using Complex = std::complex<double>;

constexpr double rounding = 1e-13;  // some hundred operations of relative error 1e-16

std::vector<double> cosines() {
  std::vector<double> values;
  for (int i = 1; i <= 200; ++i) values.push_back(i / 200.0);
  return values;
}

TEST(Fresnel, GlassReflectsFourPercentHeadOnFromEitherSide) {
  EXPECT_NEAR(reflectance_dielectric(1, 1.5), 0.04, rounding);  // ((1.5 − 1)/(1.5 + 1))²
  EXPECT_NEAR(reflectance_dielectric(1, 1 / 1.5), 0.04, rounding);
  EXPECT_EQ(reflectance_dielectric(0, 1.5), 1);  // a mirror at grazing incidence
  EXPECT_EQ(reflectance_dielectric(0.5, 1), 0);  // no boundary
}

TEST(Fresnel, PolarisedInThePlaneNothingIsReflectedAtBrewstersAngle) {
  for (double n : {1.33, 1.5, 2.4, 1 / 1.5}) {
    const double cosine = 1 / std::sqrt(1 + n * n);  // tanθ = n
    const FresnelAmplitudes a = fresnel_amplitudes(cosine, n);
    EXPECT_NEAR(std::abs(a.r_p), 0, rounding);
    // Only r_s = (1 − n²)/(1 + n²) is left.
    const double r_s = (1 - n * n) / (1 + n * n);
    EXPECT_NEAR(reflectance_dielectric(cosine, n), r_s * r_s / 2, rounding);
  }
}

TEST(Fresnel, LossLessBoundariesKeepTheEnergyOfBothPolarisations) {
  for (double n : {1.33, 1.5, 2.4, 1 / 1.33, 1 / 2.4})
    for (double cosine : cosines()) {
      const FresnelAmplitudes a = fresnel_amplitudes(cosine, n);
      const double flux = far_normal_component(cosine, n).real() / cosine;  // n·cosθ_far/cosθ_near
      EXPECT_NEAR(std::norm(a.r_s) + flux * std::norm(a.t_s), 1, rounding);
      EXPECT_NEAR(std::norm(a.r_p) + flux * std::norm(a.t_p), 1, rounding);
      EXPECT_NEAR((std::norm(a.r_s) + std::norm(a.r_p)) / 2, reflectance_dielectric(cosine, n), rounding);
    }
}

TEST(Fresnel, TheTwoSidesObeyStokesRelations) {
  // r' = −r and t·t' = 1 − r², the far side at Snell's angle (Born & Wolf 1.6, from time reversal).
  const double n = 1.5, tolerance = 1e-12;  // near grazing, cosθ = 0.005 is recovered to 1e-16/0.005
  for (double cosine : cosines()) {
    const double far_cosine = far_normal_component(cosine, n).real() / n;
    const FresnelAmplitudes near = fresnel_amplitudes(cosine, n), far = fresnel_amplitudes(far_cosine, 1 / n);
    EXPECT_NEAR(std::abs(near.r_s + far.r_s), 0, tolerance);
    EXPECT_NEAR(std::abs(near.r_p + far.r_p), 0, tolerance);
    EXPECT_NEAR(std::abs(near.t_s * far.t_s - (1.0 - near.r_s * near.r_s)), 0, tolerance);
    EXPECT_NEAR(std::abs(near.t_p * far.t_p - (1.0 - near.r_p * near.r_p)), 0, tolerance);
    EXPECT_NEAR(reflectance_dielectric(cosine, n), reflectance_dielectric(far_cosine, 1 / n), tolerance);
  }
}

TEST(Fresnel, BeyondTheCriticalAngleAllIsReflected) {
  const double critical = std::sqrt(1 - 1 / (1.5 * 1.5));  // sinθ = 1/1.5
  EXPECT_EQ(reflectance_dielectric(critical - 1e-9, 1 / 1.5), 1);
  EXPECT_LT(reflectance_dielectric(critical + 1e-3, 1 / 1.5), 1);
  const FresnelAmplitudes a = fresnel_amplitudes(critical / 2, 1 / 1.5);
  EXPECT_NEAR(std::abs(a.r_s), 1, rounding);
  EXPECT_NEAR(std::abs(a.r_p), 1, rounding);
}

TEST(Fresnel, OffADenserMediumThePhaseIsPiAtEveryAngleAndOffAThinnerOneNone) {
  for (double n : {1.33, 1.5, 2.4})
    for (double cosine : cosines()) {
      EXPECT_EQ(reflection_phase(cosine, n), pi);
      EXPECT_EQ(transmission_phase(cosine, n), 0);
      // It is the phase of the mean of r_s and −r_p, which falls to 0 at grazing incidence but never changes its sign.
      const FresnelAmplitudes a = fresnel_amplitudes(cosine, n);
      EXPECT_LT((a.r_s - a.r_p).real(), 0);
      if (1 - cosine * cosine < 0.99 / (n * n)) {
        EXPECT_EQ(reflection_phase(cosine, 1 / n), 0);
        EXPECT_EQ(transmission_phase(cosine, 1 / n), 0);
      }
    }
  EXPECT_EQ(reflection_phase(0, 1.5), pi);  // Lloyd's mirror
}

TEST(Fresnel, TotalReflectionHasThePhaseOfGoosAndHaenchen) {
  const double m = 1 / 1.5, critical = std::sqrt(1 - m * m);
  for (int i = 1; i < 100; ++i) {
    const double cosine = critical * i / 100, root = std::sqrt(1 - cosine * cosine - m * m);
    // tan(δ/2) = −√(sin²θ − m²)/cosθ (Born & Wolf 1.5.4, eq. 60; the sign is that of exp(−iωt)).
    EXPECT_NEAR(std::tan(reflection_phase(cosine, m) / 2) * cosine / -root, 1, 1e-9) << cosine;
  }
  EXPECT_NEAR(reflection_phase(critical * (1 - 1e-12), m), 0, 1e-5);  // continuous at the critical angle …
  EXPECT_NEAR(std::fabs(reflection_phase(1e-9, m)), pi, 1e-8);        // … and π at grazing incidence
}

TEST(Fresnel, FresnelsRhombTurnsTheTwoPolarisationsByAnEighthOfAWave) {
  // Born & Wolf 1.5.4: n = 1.51, θ = 54°37′ gives δ_p − δ_s = 45°, to the minute of arc that the angle is given to.
  const double theta = (54 + 37 / 60.0) * pi / 180;
  const FresnelAmplitudes a = fresnel_amplitudes(std::cos(theta), 1 / 1.51);
  EXPECT_NEAR(std::fabs(std::arg(a.r_p / a.r_s)) * 180 / pi, 45, 0.05);
}

TEST(Fresnel, AConductorsReflectanceIsThatOfItsAmplitudes) {
  for (const std::string& name : metal_names())
    for (double wavelength : {460e-9, 532e-9, 633e-9})
      for (double cosine : cosines()) {
        const Complex index = index_at(metal_index(name), wavelength);
        const FresnelAmplitudes a = fresnel_amplitudes(cosine, index);
        EXPECT_NEAR(reflectance_conductor(cosine, index), (std::norm(a.r_s) + std::norm(a.r_p)) / 2, rounding) << name;
        EXPECT_NEAR(reflection_phase(cosine, index), std::arg(a.r_s), rounding) << name;
        EXPECT_NEAR(transmission_phase(cosine, index), std::arg(a.t_s), rounding) << name;
      }
  // Without absorption it is a dielectric.
  for (double cosine : cosines())
    EXPECT_NEAR(reflectance_conductor(cosine, 1.5), reflectance_dielectric(cosine, 1.5), rounding);
  EXPECT_EQ(reflectance_conductor(0, Complex(0.05, 4)), 1);
}

TEST(Fresnel, APerfectMetalTurnsThePhaseByPiAndAMeasuredOneByLess) {
  EXPECT_NEAR(std::fabs(reflection_phase(1, Complex(1, 1e9))), pi, 1e-8);
  // Head-on tan δ = 2k/(1 − n² − k²) (Born & Wolf 14.4). Light enters the metal a little, so δ > −π: silver at 617 nm,
  // n = 0.06, k = 4.152.
  const double delta = reflection_phase(1, Complex(0.06, 4.152));
  EXPECT_NEAR(std::tan(delta), -2 * 4.152 / (1 - 0.06 * 0.06 - 4.152 * 4.152), 1e-12);
  EXPECT_LT(delta, -pi / 2);
  EXPECT_GT(delta, -pi);
}

TEST(Fresnel, MetalsReflectHeadOnWhatOthersMeasured) {
  // R = ((n − 1)² + k²)/((n + 1)² + k²) of other samples, linear between neighbouring values: Babar and Weaver, Appl.
  // Opt. 54, 477 (2015), for silver, gold and copper; Cheng et al., ACS Nano 10, 9852 (2016), for aluminium. Samples
  // differ: by less than 0.01 where the metal reflects well, by 0.06 at gold's edge and for copper's red, which depends
  // on its polish.
  const struct {
    const char* name;
    double wavelength, n, k, tolerance;
  } samples[] = {{"Ag", 532e-9, 0.0518, 3.421, 0.005}, {"Ag", 633e-9, 0.0487, 4.272, 0.005},
                 {"Al", 532e-9, 0.5483, 5.103, 0.01},  {"Al", 633e-9, 0.8342, 6.036, 0.01},
                 {"Au", 532e-9, 0.3836, 2.124, 0.06},  {"Au", 633e-9, 0.1250, 3.335, 0.02},
                 {"Cu", 532e-9, 1.0088, 2.441, 0.01},  {"Cu", 633e-9, 0.0919, 3.534, 0.06}};
  for (const auto& s : samples) {
    const double reflectance = ((s.n - 1) * (s.n - 1) + s.k * s.k) / ((s.n + 1) * (s.n + 1) + s.k * s.k);
    EXPECT_NEAR(reflectance_conductor(1, index_at(metal_index(s.name), s.wavelength)), reflectance, s.tolerance)
        << s.name << " at " << s.wavelength;
  }
}

}  // namespace
}  // namespace holotrace
