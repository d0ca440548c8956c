#include <algorithm>
#include <cmath>

#include "holotrace/data/acceptance.h"
#include "holotrace/estimate/alias_free.h"
#include "holotrace/estimate/limits.h"
#include "support/panels.h"

namespace holotrace {
namespace {

using namespace literals;

constexpr Grid panel{1920, 1080, 8e-6};

const Series& series_of(const Chart& chart, const std::string& name) {
  const auto found =
      std::find_if(chart.series.begin(), chart.series.end(), [&](const Series& s) { return s.name == name; });
  EXPECT_NE(found, chart.series.end()) << name;
  return *found;
}

TEST(AliasFree, APointLightsWhatItsBoxCovers) {
  const double z = 0.3, radius = box_radius(z, 532_nm, panel.pitch);
  const double sx = panel.width() / 2, sy = panel.height() / 2, little = 1e-9;
  EXPECT_EQ(reach_of({radius - sx - little, 0, -z}, panel, 532_nm), Reach::whole_panel);
  EXPECT_EQ(reach_of({radius - sx + little, 0, -z}, panel, 532_nm), Reach::part_of_panel);
  EXPECT_EQ(reach_of({radius + sx - little, 0, -z}, panel, 532_nm), Reach::part_of_panel);
  EXPECT_EQ(reach_of({radius + sx + little, 0, -z}, panel, 532_nm), Reach::nothing);
  EXPECT_EQ(reach_of({0, -(radius - sy - little), -z}, panel, 532_nm), Reach::whole_panel);
  EXPECT_EQ(reach_of({0, -(radius + sy + little), -z}, panel, 532_nm), Reach::nothing);
  EXPECT_EQ(reach_of({0, 0, 0}, panel, 532_nm), Reach::nothing) << "on the panel";
  EXPECT_EQ(reach_of({radius - sx - little, 0, z}, panel, 532_nm), Reach::whole_panel) << "in front of it";
  // From whole_panel_distance on, some points light the whole panel.
  const double nearest = limits(panel, 532_nm, 1).whole_panel_distance;
  EXPECT_EQ(reach_of({0, 0, -nearest * 1.001}, panel, 532_nm), Reach::whole_panel);
  EXPECT_EQ(reach_of({0, 0, -nearest * 0.999}, panel, 532_nm), Reach::part_of_panel);
  // The zone of a panel off the axis is centred on the panel.
  Grid aside = panel;
  aside.centre_x = 1;
  EXPECT_EQ(reach_of({1 + radius - sx - little, 0, -z}, aside, 532_nm), Reach::whole_panel);
}

TEST(AliasFree, ReplicasAreAnOrderAway) {
  const double half = grating_order_offset(panel.pitch, 532_nm, 0.3) / 2;
  EXPECT_TRUE(is_replica_free({half * 0.999, -half * 0.999, -0.3}, panel, 532_nm));
  EXPECT_FALSE(is_replica_free({half * 1.001, 0, -0.3}, panel, 532_nm));
  EXPECT_TRUE(is_replica_free({10, 0, -0.3}, {10, 10, 0.3e-6}, 532_nm)) << "no replicas";
}

TEST(AliasFree, CountsAndDrawsTheScene) {
  Scene scene;
  scene.points = {{{0, 0, -0.3}}, {{15_mm, 0, -0.3}}, {{0.2, 0, -0.3}}};  // R = 9.98 mm, S/2 = 7.68 mm: all, part, none
  const auto points = points_of(scene);
  const AliasFreeCounts counts = count_alias_free(points, panel, 532_nm);
  EXPECT_EQ(counts.points, 3);
  EXPECT_EQ(counts.whole_panel, 1);
  EXPECT_EQ(counts.part_of_panel, 1);
  EXPECT_EQ(counts.outside, 1);
  EXPECT_EQ(counts.replica_free, 1);  // half the spacing is 9.997 mm

  const Chart chart = alias_free_chart(points, panel, 532_nm, 0.3, AcrossPanel::x);
  EXPECT_EQ(chart.title, "Of 3 points 33.3 % light the whole panel, 33.3 % a part, 33.3 % nothing");
  EXPECT_EQ(series_of(chart, "panel").y, (std::vector<double>{-7.68, 7.68}));
  EXPECT_EQ(series_of(chart, "points that light it").x, (std::vector<double>{-300, -300}));
  EXPECT_EQ(series_of(chart, "points outside").y, (std::vector<double>{200}));
  // The cone begins where the box of a point on the axis just covers the width.
  const Series& cone = series_of(chart, "lights the whole panel");
  EXPECT_NEAR(-cone.x[1] / 1e3, limits(panel, 532_nm, 1).whole_panel_distance, 1e-12);
  EXPECT_EQ(cone.y[1], 0);
  const Limits l = limits(panel, 532_nm, 0.3);
  EXPECT_NEAR(series_of(chart, "eyebox: light from every pixel").y[1] / 1e3, l.eyebox_x / 2, 1e-15);
  check_chart(chart);
  check_chart(alias_free_chart({}, panel, 532_nm, 0.1, AcrossPanel::y));  // too near for an eyebox; no scene
  check_chart(half_angle_chart({638_nm, 520_nm, 450_nm}));
  EXPECT_EQ(error_of([] {
              alias_free_chart({}, {10, 10, 0.2e-6}, 532_nm, 1, AcrossPanel::x);
            }),
            "expected a pitch above half the wavelength of 532 nm, got 200 nm: every point lights the whole panel, and "
            "there is no zone to draw");
}

TEST(AliasFree, HalfAngleFallsWithThePitch) {
  const Chart chart = half_angle_chart({532_nm});
  const Series& curve = chart.series.front();
  EXPECT_EQ(curve.name, "532 nm");
  EXPECT_NEAR(curve.x.front(), 0.3, 1e-12);
  EXPECT_NEAR(curve.x.back(), 20, 1e-12);
  EXPECT_TRUE(std::is_sorted(curve.y.rbegin(), curve.y.rend()));
  EXPECT_NEAR(curve.y.back(), std::asin(0.532 / 40) * 180 / pi, 1e-12);
}

}  // namespace
}  // namespace holotrace
