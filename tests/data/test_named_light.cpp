#include <gtest/gtest.h>

#include <set>

#include "holotrace/base/units.h"
#include "holotrace/data/named_light.h"
#include "holotrace/data/params/parameter_texts.h"
#include "holotrace/data/params/show.h"
#include "support/error_of.h"

namespace holotrace {
namespace {

using namespace literals;

// A name with a number says the wavelength in nm to its last digit. HeNe and Ar 514 are the lines of neon and argon in air,
// 632.816 nm and 514.532 nm (NIST Atomic Spectra Database), rounded to a tenth of a nm as data sheets do.
TEST(NamedLights, TheirWavelengthsAreThoseOfTheirNamesAndLines) {
  for (const NamedLight& light : named_lights()) {
    const size_t digits = light.name.find_last_of(' ');
    if (digits == std::string::npos || !std::isdigit(static_cast<unsigned char>(light.name.back()))) continue;
    EXPECT_NEAR(light.wavelength, std::stod(light.name.substr(digits)) * 1e-9, 0.5_nm * 1.0001) << light.name;
  }
  EXPECT_NEAR(light_named("HeNe").wavelength, 632.816e-9, 0.05e-9);
  EXPECT_NEAR(light_named("Ar 514").wavelength, 514.532e-9, 0.05e-9);
  EXPECT_EQ(light_named("DPSS 532").wavelength, parse_length("532 nm"));
}

TEST(NamedLights, EachHasASourceAndSaneFigures) {
  EXPECT_GE(named_lights().size(), 12u);
  std::set<std::string> names;
  for (const NamedLight& light : named_lights()) {
    EXPECT_TRUE(names.insert(light.name).second) << light.name;
    EXPECT_FALSE(light.source.empty()) << light.name;
    EXPECT_GE(light.wavelength, 380e-9) << light.name;  // visible, or the near infrared of silicon cameras
    EXPECT_LE(light.wavelength, 1100e-9) << light.name;
    EXPECT_GE(light.bandwidth, 0) << light.name;
    // An LED is a few ten nm wide, a laser below 5 nm.
    EXPECT_EQ(light.bandwidth > 5e-9, light.name.starts_with("LED")) << light.name;
    // A list and a text are read at commas and by letters, and so is its name.
    EXPECT_EQ(parse_wavelengths(light.name), std::vector<double>{light.wavelength}) << light.name;
  }
}

TEST(NamedLights, CapitalsSpacesAndHyphensDoNotMatter) {
  for (const char* text : {"HeNe", "hene", "He-Ne", " HENE ", "He Ne"})
    EXPECT_EQ(parse_wavelength(text), 632.8e-9) << text;
  EXPECT_EQ(parse_wavelength("dpss532"), 532e-9);
}

TEST(NamedLights, ListsMixThemWithLengths) {
  EXPECT_EQ(parse_wavelengths("HeNe, DPSS 532, 450 nm"), (std::vector<double>{632.8e-9, 532e-9, 450e-9}));
  EXPECT_EQ(parse_wavelengths("638, 520 nm, dpss 473, 0.45 um"), (std::vector<double>{638e-9, 520e-9, 473e-9, 450e-9}));
  EXPECT_EQ(parse_wavelengths("450 nm,HeNe,"), (std::vector<double>{450e-9, 632.8e-9}));
  EXPECT_EQ(parse_wavelengths("638 520 450 nm"), (std::vector<double>{638e-9, 520e-9, 450e-9}));
  EXPECT_EQ(error_of([] { parse_wavelengths("HeNe, 632,8 nm"); }),
            "expected a point in a decimal number, or a space after the comma between two numbers, got \" 632,8 nm\"");
  // A unit is not shared across a light.
  EXPECT_EQ(error_of([] { parse_wavelengths("638, HeNe, 450 nm"); }),
            "expected a length with its unit, such as \"532 nm\", got \"638\" without a unit");
}

TEST(NamedLights, UnknownOnesAreRefusedWithTheNearest) {
  EXPECT_EQ(
      error_of([] { parse_wavelength("HeNi"); }),
      "expected a length with its unit, such as \"532 nm\", or a known light (did you mean \"HeNe\"?), got \"HeNi\"");
  EXPECT_EQ(
      error_of([] { parse_wavelengths("450 nm, DPS 532"); }),
      "expected a length with its unit, such as \"532 nm\", or a known light (did you mean \"DPSS 532\"?), got \"DPS 532\"");
  EXPECT_EQ(
      error_of([] { parse_wavelength("torch"); }),
      "expected a length with its unit, such as \"532 nm\", or a known light (holotrace info --lights lists them), got \"torch\"");
}

// Texts that were errors before are the same errors, but for words.
TEST(NamedLights, LengthsAreReadAsBefore) {
  for (const char* text : {"532", "532 inch", "nan nm", "inf nm", "", "1 mm 2 mm", "-5", "2e9 m"}) {
    EXPECT_EQ(error_of([&] { parse_wavelength(text); }), error_of([&] { parse_length(text, "wavelength"); })) << text;
    EXPECT_EQ(error_of([&] { parse_wavelengths(text); }), error_of([&] { parse_lengths(text, "wavelength"); })) << text;
  }
  EXPECT_EQ(parse_wavelength("632.8 nm"), 632.8e-9);
}

// Of the parameters of show, only the wavelength takes one; bandwidths, radii and distances do not.
TEST(NamedLights, OtherLengthsDoNotTakeThem) {
  int taken = 0;
  const auto try_light = [&](const auto& parameter) {
    if (!is_length(parameter.quantity)) return;
    const bool is_wavelength = std::string(parameter.name) == "wavelength";
    const std::string sentence = error_of([&] { set_from_text(parameter, "HeNe"); });
    if (is_wavelength)
      EXPECT_EQ(sentence, "no error");
    else
      EXPECT_NE(sentence.find("expected a length with its unit"), std::string::npos) << parameter.name << sentence;
    taken += is_wavelength;
  };
  ShowParams show;
  describe(try_light, show);
  EXPECT_EQ(taken, 1);
  EXPECT_EQ(show.wavelength, 632.8e-9);
}

}  // namespace
}  // namespace holotrace
