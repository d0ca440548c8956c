#include <gtest/gtest.h>

#include "holotrace/data/refractive_index.h"

namespace holotrace {
namespace {

TEST(RefractiveIndex, GlassesHaveTheIndexTheyAreSoldBy) {
  // n_d (587.56 nm): SCHOTT's data sheets for N-BK7 and N-SF11, Malitson 1965, Daimon and Masumura 2007 (20 °C), and
  // Peter 1923. Tolerance: the last digit given, plus 2e-5 for the linear interpolation between samples.
  const struct {
    const char* name;
    double n, tolerance;
  } expected[] = {{"BK7", 1.51680, 3e-5},
                  {"SF11", 1.78472, 4e-5},
                  {"fused-silica", 1.45846, 3e-5},
                  {"water", 1.3334, 1e-4},
                  {"diamond", 2.4175, 5e-4}};
  for (const auto& glass : expected) {
    const auto index = glass_index(glass.name);
    EXPECT_NEAR(index_at(index, 587.56e-9).real(), glass.n, glass.tolerance) << glass.name;
    EXPECT_TRUE(is_dispersive(index));
    EXPECT_GT(index_at(index, 450e-9).real(), index_at(index, 650e-9).real()) << "normal dispersion";
  }
  // Abbe number of BK7, (n_d − 1)/(n_F − n_C) = 64.17; an error of 2e-5 in n_F − n_C = 0.0081 changes it by 0.2.
  const auto bk7 = glass_index("BK7");
  const double spread = index_at(bk7, 486.13e-9).real() - index_at(bk7, 656.27e-9).real();
  EXPECT_NEAR((index_at(bk7, 587.56e-9).real() - 1) / spread, 64.17, 0.2);
}

TEST(RefractiveIndex, EveryNameHasAnIndexOverTheVisible) {
  for (const auto& name : metal_names()) {
    const auto index = metal_index(name);
    EXPECT_LE(index.samples.front().wavelength, 380e-9) << name;
    EXPECT_GE(index.samples.back().wavelength, 780e-9) << name;
    for (size_t i = 0; i < index.samples.size(); ++i) {
      EXPECT_GT(index.samples[i].n, 0) << name;
      EXPECT_GT(index.samples[i].k, 1) << name;  // all of them reflect like metals
      if (i > 0) {
        EXPECT_GT(index.samples[i].wavelength, index.samples[i - 1].wavelength) << name;
      }
    }
  }
  for (const auto& name : glass_names()) {
    const auto index = glass_index(name);
    EXPECT_LE(index.samples.front().wavelength, 380e-9) << name;
    EXPECT_GE(index.samples.back().wavelength, 780e-9) << name;
  }
  EXPECT_EQ(index_at(metal_index("Au"), 616.8e-9), std::complex<double>(0.21, 3.272));  // Johnson and Christy's sample
  EXPECT_FALSE(is_dispersive(constant_index(1.5)));
}

TEST(RefractiveIndex, AnUnknownNameSuggestsTheNearest) {
  const auto sentence = [](const auto& action) {
    try {
      action();
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(sentence([] { metal_index("ag"); }).find("Ag"), std::string::npos);
  EXPECT_NE(sentence([] { glass_index("bk-7"); }).find("BK7"), std::string::npos);
}

}  // namespace
}  // namespace holotrace
