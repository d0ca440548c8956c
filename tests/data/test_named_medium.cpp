#include <gtest/gtest.h>

#include <array>

#include "holotrace/base/units.h"
#include "holotrace/data/named_medium.h"
#include "holotrace/data/spectrum.h"
#include "support/error_of.h"

namespace holotrace {
namespace {

// The formulas of named_medium.h, from the imaginary index of ice at the three lines (Warren and Brandt 2008, table; 532 nm between
// 530 and 540 nm).
TEST(NamedMedia, SnowIsThatOfItsGrainsOfIce) {
  constexpr std::array<double, 3> lines{red_line, green_line, blue_line}, k{1.04e-8, 1.482e-9, 1.325e-10};
  constexpr double ice = 917, g = 0.76, b = 1.84;  // [kg/m³]
  struct Snow {
    const char* name;
    double density, radius;
  };
  for (const Snow& snow : {Snow{"fresh snow", 100, 65e-6}, Snow{"firn", 400, 0.5e-3}}) {
    const NamedMedium& medium = medium_named(snow.name);
    const double filled = snow.density / ice, scattered = (1 - g) * 1.5 * filled / snow.radius;
    for (size_t line = 0; line < 3; ++line) {
      const double absorbed = b * filled * 4 * pi * k[line] / lines[line];
      // Three digits are given.
      EXPECT_NEAR(component(medium.scattering, line) / scattered, 1, 5e-3) << snow.name;
      EXPECT_NEAR(component(medium.absorption, line) / absorbed, 1, 5e-3) << snow.name << line;
    }
  }
}

TEST(NamedMedia, AreFoundByName) {
  EXPECT_EQ(medium_named("whole milk").scattering, (Vec3{2550, 3210, 3770}));
  EXPECT_NE(error_of([] { medium_named("fresh sno"); }).find("fresh snow"), std::string::npos);
}

}  // namespace
}  // namespace holotrace
