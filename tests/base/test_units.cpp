#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

// The quotient of a decimal number and a power of ten is rounded once, so the result is the double nearest
// to the length. The compiler makes the same double of the literal: equality is exact.
TEST(Units, LengthsRoundOnce) {
  EXPECT_EQ(parse_length("532 nm"), 532e-9);
  EXPECT_EQ(parse_length("632.8 nm"), 632.8e-9);
  EXPECT_EQ(parse_length("3.74um"), 3.74e-6);
  EXPECT_EQ(parse_length("8 µm"), 8e-6);
  EXPECT_EQ(parse_length("8 μm"), 8e-6);
  EXPECT_EQ(parse_length("-300 mm"), -0.3);
  EXPECT_EQ(parse_length("1.1 cm"), 0.011);
  EXPECT_EQ(parse_length("+0.3 m"), 0.3);
}

TEST(Units, NumbersMayHaveAnExponentOfEitherSign) {
  EXPECT_EQ(parse_length("1e+3 nm"), 1e-6);
  EXPECT_EQ(parse_length("2.5E2 mm"), 0.25);
  EXPECT_EQ(parse_length("5e-1um"), 5e-7);
  EXPECT_EQ(parse_size("1e+3 kB"), 1e6);
}

TEST(Units, LiteralsAndTextsAgree) {
  using namespace literals;
  EXPECT_EQ(532_nm, parse_length("532 nm"));
  EXPECT_EQ(8.0_um, parse_length("8 um"));
  EXPECT_EQ(300_mm, parse_length("300 mm"));
}

TEST(Units, AnglesAreInRadians) {
  EXPECT_DOUBLE_EQ(parse_angle("180 deg"), pi);
  EXPECT_EQ(parse_angle("0.25 rad"), 0.25);
  EXPECT_EQ(parse_angle("3 mrad"), 0.003);
  EXPECT_DOUBLE_EQ(parse_angle("2.2 pi"), 2.2 * pi);
  EXPECT_DOUBLE_EQ(parse_angle("-0.5π"), -pi / 2);
}

TEST(Units, PartsHaveTwoDigitsOfPercent) {
  EXPECT_EQ(format_percent(0.00346), "0.35 %");
  EXPECT_EQ(format_percent(0.0994), "9.9 %");
  EXPECT_EQ(format_percent(0.0996), "10 %");
  EXPECT_EQ(format_percent(1), "100 %");
}

TEST(Units, PercentAreParts) {
  EXPECT_EQ(parse_percent("92 %"), 0.92);
  EXPECT_EQ(parse_percent("0.5%"), 0.005);
  EXPECT_EQ(error_of([] { parse_percent("92"); }),
            "expected a part with its unit, such as \"92 %\", got \"92\" without a unit");
}

TEST(Units, LengthsShareATrailingUnitOrCarryTheirOwn) {
  EXPECT_EQ(parse_lengths("0 0 -300 mm"), (std::vector<double>{0, 0, -0.3}));
  EXPECT_EQ(parse_lengths("1 mm, 2 um, 0.3 m"), (std::vector<double>{1e-3, 2e-6, 0.3}));
}

TEST(Units, ErrorsShowALengthThatSuitsTheName) {
  EXPECT_EQ(error_of([] { parse_length("red", "--wavelength"); }),
            "expected a length with its unit, such as \"532 nm\", got \"red\"");
  EXPECT_EQ(error_of([] { parse_length("632,8 nm"); }),
            "expected a point in a decimal number, or a space after the comma between two numbers, got \"632,8 nm\"");
  EXPECT_EQ(error_of([] { parse_lengths("red", "--wavelength"); }),
            "expected a length with its unit, such as \"532 nm\", got \"red\"");
  EXPECT_EQ(error_of([] { parse_length("8", "pitch"); }),
            "expected a length with its unit, such as \"8 um\", got \"8\" without a unit");
}

TEST(Units, ErrorsSayWhatWasExpected) {
  EXPECT_EQ(error_of([] { parse_length("300"); }),
            "expected a length with its unit, such as \"300 mm\", got \"300\" without a unit");
  EXPECT_EQ(error_of([] { parse_length("300 inch"); }),
            "expected a length in one of the units nm, um, µm, mm, cm, m, got \"300 inch\"");
  EXPECT_EQ(error_of([] { parse_length("far"); }), "expected a length with its unit, such as \"300 mm\", got \"far\"");
  EXPECT_EQ(error_of([] { parse_length(""); }), "expected a length with its unit, such as \"300 mm\", got \"\"");
  EXPECT_EQ(error_of([] { parse_length("5 nanometers"); }),
            "expected a length in one of the units nm, um, µm, mm, cm, m, got \"5 nanometers\"");
  EXPECT_EQ(error_of([] { parse_length("nan m"); }), "expected a length that is finite, got \"nan m\"");
  EXPECT_EQ(error_of([] { parse_length("inf m"); }), "expected a length that is finite, got \"inf m\"");
  EXPECT_EQ(parse_length("1000000 m"), most_length);
  EXPECT_EQ(error_of([] { parse_length("1e308 mm"); }), "expected a length of at most 1e+06 m, got \"1e308 mm\"");
  EXPECT_EQ(error_of([] { parse_lengths("0 0 -2e6 m"); }), "expected a length of at most 1e+06 m, got \"0 0 -2e6 m\"");
  EXPECT_EQ(error_of([] { parse_length("1 mm 2 mm"); }), "expected one length, got 2 in \"1 mm 2 mm\"");
  EXPECT_EQ(error_of([] { parse_angle("15"); }),
            "expected an angle with its unit, such as \"15 deg\", got \"15\" without a unit");
  EXPECT_EQ(error_of([] { parse_angle("15 turns"); }),
            "expected an angle in one of the units deg, mrad, rad, pi, got \"15 turns\"");
}

TEST(Units, SizesHaveUnitsOfAThousandOr1024) {
  EXPECT_EQ(parse_size("2 GB"), 2e9);
  EXPECT_EQ(parse_size("1.5kB"), 1500);
  EXPECT_EQ(parse_size("256 MiB"), 256.0 * 1024 * 1024);
  EXPECT_EQ(parse_size("1 TiB"), 0x1p40);
  EXPECT_EQ(parse_size("3 TB"), 3e12);
  EXPECT_EQ(parse_size("7 B"), 7);
  EXPECT_EQ(error_of([] { parse_size("2"); }),
            "expected a size with its unit, such as \"2 GB\", got \"2\" without a unit");
  EXPECT_EQ(error_of([] { parse_size("2 GHz"); }),
            "expected a size in one of the units B, kB, MB, GB, TB, KiB, MiB, GiB, TiB, got \"2 GHz\"");
  EXPECT_EQ(error_of([] { parse_size("0 GB"); }), "expected a size above 0 B, got \"0 GB\"");
  EXPECT_EQ(error_of([] { parse_size("1 GB 2 GB"); }), "expected one size, got 2 in \"1 GB 2 GB\"");
}

TEST(Units, SizesAreWrittenInASuitableUnit) {
  EXPECT_EQ(format_bytes(1023), "1023 B");
  EXPECT_EQ(format_bytes(1024), "1 KiB");
  EXPECT_EQ(format_bytes(2.5 * 1024 * 1024), "2.5 MiB");
  EXPECT_EQ(format_bytes(0x1p50), "1024 TiB");  // there is no larger unit
}

TEST(Units, LengthsAreWrittenInASuitableUnit) {
  EXPECT_EQ(format_length(532e-9), "532 nm");
  EXPECT_EQ(format_length(8e-6), "8 µm");
  EXPECT_EQ(format_length(0.3), "300 mm");
  EXPECT_EQ(format_length(-0.3), "-300 mm");
  EXPECT_EQ(format_length(0), "0 m");
  EXPECT_EQ(format_bytes(34.4 * 1024 * 1024 * 1024), "34.4 GiB");
}

}  // namespace
}  // namespace holotrace
