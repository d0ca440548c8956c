#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/estimate/limits.h"
#include "support/panels.h"

// The numbers are from closed_forms.md; a tolerance is half of the last digit printed there.

namespace holotrace {
namespace {

using namespace literals;

constexpr Grid pluto{1920, 1080, 8e-6};

double degrees(double radians) { return radians * 180 / pi; }

TEST(Limits, HalfDiffractionAngles) {
  struct Case {
    double pitch, wavelength, angle;
  };
  for (const Case& c : {Case{8e-6, 633e-9, 2.267}, Case{8e-6, 532e-9, 1.905}, Case{8e-6, 450e-9, 1.612},
                        Case{3.74e-6, 633e-9, 4.854}, Case{3.74e-6, 532e-9, 4.078}, Case{3.74e-6, 450e-9, 3.449}}) {
    const Limits l = limits({100, 100, c.pitch}, c.wavelength, 1);
    EXPECT_NEAR(degrees(l.half_angle), c.angle, 5e-4);
    EXPECT_DOUBLE_EQ(l.field_of_view, 2 * l.half_angle);
    EXPECT_NEAR(std::sin(l.first_order_angle), 2 * std::sin(l.half_angle), 1e-12);  // λ/p and λ/2p
  }
}

TEST(Limits, BoxOfASource) {
  // In pixels of 8 µm, as in closed_forms.md.
  EXPECT_NEAR(limits(pluto, 532_nm, 0.1_m).box_radius / 8e-6, 416, 0.5);
  EXPECT_NEAR(limits(pluto, 532_nm, 0.2_m).box_radius / 8e-6, 832, 0.5);
  EXPECT_NEAR(limits(pluto, 532_nm, 0.3_m).box_radius / 8e-6, 1248, 0.5);
  EXPECT_NEAR(limits(pluto, 633_nm, 0.3_m).box_radius / 8e-6, 1485, 0.5);
}

TEST(Limits, ResolutionAndDepthOfFocusOfTheWholePanel) {
  const Limits near = limits(pluto, 532_nm, 0.2_m), far = limits(pluto, 532_nm, 0.3_m);
  EXPECT_NEAR(near.resolution_x, 6.927e-6, 5e-10);
  EXPECT_NEAR(near.resolution_y, 12.315e-6, 5e-10);
  EXPECT_NEAR(far.resolution_x, 10.391e-6, 5e-10);
  EXPECT_NEAR(far.resolution_y, 18.472e-6, 5e-10);
  EXPECT_NEAR(far.depth_of_focus_x, 2 * far.resolution_x * far.resolution_x / 532e-9, 1e-12);  // 2(λz/S)²/λ
  EXPECT_NEAR(far.depth_of_focus_y, 2 * far.resolution_y * far.resolution_y / 532e-9, 1e-12);
  EXPECT_EQ(far.space_bandwidth, 1920 * 1080);
}

TEST(Limits, SpaceBandwidthIsTheEtendueOverTheSquaredWavelength) {
  const Limits l = limits(pluto, 532_nm, 1);
  const double etendue = pluto.width() * pluto.height() * std::pow(2 * std::sin(l.half_angle), 2);
  EXPECT_NEAR(double(l.space_bandwidth), etendue / (532e-9 * 532e-9), 1e-9 * l.space_bandwidth);
}

TEST(Limits, GratingsOfWholePixels) {  // case 10: 8 µm pixels, 0.3 m
  const std::pair<int, double> table[] = {{2, 9.98052}, {4, 4.98819}, {8, 2.49384}, {16, 1.24689}, {32, 0.62344}};
  for (const auto& [pixels, offset] : table)
    EXPECT_NEAR(grating_order_offset(pixels * 8e-6, 532_nm, 0.3_m), offset * 1e-3, 5e-9) << pixels;
  const Limits l = limits(pluto, 532_nm, 0.3_m);
  EXPECT_DOUBLE_EQ(l.finest_grating, 16e-6);
  EXPECT_NEAR(grating_order_offset(l.finest_grating, 532_nm, 0.3_m), l.box_radius, 1e-12);  // both z·tan(asin(λ/2p))
  EXPECT_NEAR(grating_order_offset(8e-6, 532_nm, 0.3_m), l.order_spacing, 1e-12);
  EXPECT_DOUBLE_EQ(grating_order_offset(16e-6, 532_nm, 0.3_m, -2), -l.order_spacing);
  EXPECT_EQ(grating_order_offset(8e-6, 532_nm, 0.3_m, 0), 0);
}

TEST(Limits, FinePitchHasNoReplicas) {
  const Limits l = limits({10, 10, 0.3_um}, 532_nm, 0.1_m);
  EXPECT_TRUE(std::isinf(l.order_spacing));  // λ/p > 1: order 1 is evanescent
  EXPECT_DOUBLE_EQ(l.first_order_angle, pi / 2);
}

TEST(WantedPitch, IsThePapersRule) {
  const double pitch = wanted_pitch(632.8_nm, 15.0_deg);
  EXPECT_NEAR(pitch, 1.181e-6, 5e-10);  // the paper: 1.18 µm for 15° × 15°
  EXPECT_EQ(wanted_pixels(0.1, pitch), int64_t(std::ceil(0.1 * 2 * std::tan(15.0_deg) / 632.8e-9)));
  EXPECT_EQ(wanted_pixels(1920 * 8e-6, 8e-6), 1920);  // divides evenly
  EXPECT_EQ(wanted_pixels(8.1e-6, 8e-6), 2);
  EXPECT_DOUBLE_EQ(pixel_rate(4e9, 3, 30), 3.6e11);  // the paper's value is for 4e9 pixels, 3 colours, 30 frames/s
}

TEST(Limits, OrdersOfPlutoAndGaea) {
  // sin θₙ = nλ/p, by hand: 633/3740 gives 9.7447°, twice this ratio 19.784°, three times 30.515°.
  const auto gaea = diffraction_orders(3.74e-6, 633_nm, 0.3_m);
  ASSERT_EQ(gaea.size(), 11U);  // −5 … 5, since 5·633 nm < 3.74 µm
  EXPECT_EQ(gaea.front().order, -5);
  EXPECT_EQ(gaea[5].angle, 0);
  EXPECT_NEAR(degrees(gaea[6].angle), 9.7447, 5e-4);
  EXPECT_NEAR(degrees(gaea[7].angle), 19.784, 5e-3);
  EXPECT_NEAR(degrees(gaea[8].angle), 30.515, 5e-3);
  for (const DiffractionOrder& order : gaea) EXPECT_NEAR(order.offset, 0.3 * std::tan(order.angle), 1e-15);
  EXPECT_NEAR(diffraction_orders(8e-6, 532_nm, 0.3_m)[6].offset, 0.01999426, 5e-9);  // 0.3·tan(asin(0.0665))
  EXPECT_EQ(diffraction_orders(1e-6, 532_nm, 0.3_m).size(), 3U);                     // 2·532 nm > 1 µm: evanescent
  EXPECT_EQ(diffraction_orders(0.5e-6, 532_nm, 0.3_m).size(), 1U);                   // no replica at all
}

TEST(Limits, AliasFreeDistances) {
  // closed_forms.md, section 2: z* of 1920 × 1080 pixels of 8 µm at 532 nm.
  EXPECT_NEAR(limits(pluto, 532_nm, 1).alias_free_distance, 0.4617, 5e-5);
  EXPECT_NEAR(limits({1080, 1080, 8e-6}, 532_nm, 1).alias_free_distance, 0.2597, 5e-5);
  // There the box of a point behind one edge of the panel reaches the other edge: R = S.
  const double z = limits(pluto, 532_nm, 1).alias_free_distance;
  EXPECT_NEAR(limits(pluto, 532_nm, z).box_radius, pluto.width(), 1e-12);
  EXPECT_NEAR(limits(pluto, 532_nm, z).whole_panel_x, pluto.width(), 1e-12);
  // At half that distance the box of the point on the axis covers the panel, and no other.
  const double half = limits(pluto, 532_nm, 1).whole_panel_distance;
  EXPECT_NEAR(half, z / 2, 1e-15);
  EXPECT_NEAR(limits(pluto, 532_nm, half).box_radius, pluto.width() / 2, 1e-12);
  EXPECT_EQ(limits(pluto, 532_nm, 0.99 * half).whole_panel_x, 0);
  EXPECT_EQ(limits({10, 10, 0.2_um}, 532_nm, 1).whole_panel_distance, 0);  // every direction is below the limit
}

TEST(Limits, ThePapersFigures) {
  // "A pixel pitch of about 5 µm […] The diffraction angle is under 10°".
  EXPECT_LT(degrees(limits({4000, 4000, 5e-6}, 632.8_nm, 1).field_of_view), 10);
  // 3000 lines per mm are gratings of 0.333 µm, the paper's "at least 0.3 µm": two pixels of half that size.
  EXPECT_NEAR(limits({10, 10, 1e-3 / 6000}, 632.8_nm, 1).finest_grating, 1e-3 / 3000, 1e-18);
  // 100 mm at 1.18 µm in three colours 30 times per second are 6.5e11 pixels; the paper's 3.6e11 are those of a side
  // of 75 mm, or of a pitch of 1.58 µm.
  const double pixels = double(wanted_pixels(0.1, 1.18e-6));
  EXPECT_NEAR(pixel_rate(pixels * pixels, 3, 30), 6.46e11, 0.01e11);
  EXPECT_NEAR(pixel_rate(std::pow(0.0746 / 1.18e-6, 2), 3, 30), 3.6e11, 0.01e11);
  EXPECT_NEAR(pixel_rate(std::pow(0.1 / 1.58e-6, 2), 3, 30), 3.6e11, 0.01e11);
}

TEST(WantedPixels, OfASizeThatDividesEvenlyAreNoneTooMany) {
  // The quotients in double: 1600.0000000000002 and 1280.0000000000002.
  EXPECT_EQ(wanted_pixels(12.8_mm, 8_um), 1600);
  EXPECT_EQ(wanted_pixels(1.5104_mm, 1.18_um), 1280);
  EXPECT_EQ(wanted_pixels(1.11, 0.1), 12);
}

TEST(WantedSize, ResolvesWhatIsWanted) {
  const double side = wanted_size(532_nm, 0.3_m, 10_um);
  EXPECT_DOUBLE_EQ(side, 532e-9 * 0.3 / 1e-5);
  const int pixels = int(wanted_pixels(side, 8e-6));
  EXPECT_NEAR(limits({pixels, pixels, 8e-6}, 532_nm, 0.3_m).resolution_x, 10e-6, 10e-6 / pixels);  // to a whole pixel
  EXPECT_EQ(error_of([] { wanted_size(532e-9, 1, 0); }), "expected a resolution above 0 m, got 0 m");
}

TEST(Limits, SayWhatIsWrong) {
  EXPECT_EQ(error_of([] { limits(pluto, 532_nm, 0); }), "expected a distance above 0 m, got 0 m");
  EXPECT_EQ(error_of([] { pixel_rate(0, 3, 30); }), "expected 1 pixel or more, got 0");
  EXPECT_EQ(error_of([] { pixel_rate(1, 0, 30); }), "expected 1 colour or more, got 0");
  EXPECT_EQ(error_of([] { pixel_rate(1, 3, -1); }), "expected more than 0 frames per second, got -1");
  EXPECT_EQ(error_of([] { limits(pluto, -1, 1); }), "expected a wavelength above 0 m, got -1 m");
  EXPECT_EQ(error_of([] { limits({0, 4, 8e-6}, 532_nm, 1); }), "expected a grid of at least 1 × 1 pixels, got 0 × 4");
  EXPECT_EQ(error_of([] { wanted_pitch(532_nm, 90.0_deg); }), "expected a half angle above 0° and below 90°, got 90°");
  EXPECT_EQ(error_of([] { wanted_pixels(-1, 1); }), "expected a panel size above 0 m, got -1 m");
  EXPECT_EQ(error_of([] { wanted_pixels(1e10, 1e-6); }),
            "expected a panel of 1e15 pixels or less along a side, got 1e+16: 1e+10 m at a pitch of 1 µm");
  EXPECT_EQ(error_of([] { grating_order_offset(0, 532_nm, 1); }), "expected a grating period above 0 m, got 0 m");
}

}  // namespace
}  // namespace holotrace
