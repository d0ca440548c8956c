#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/trace/render.h"
#include "holotrace/view/pupil_picture.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const Grid pupil_panel{64, 48, 8e-6};  // 0.512 mm × 0.384 mm

/// A light field of even pictures: cell (column, row) has radiance value(column, row).
template <class Value>
LightField even_field(int columns, int rows, const Value& value, double distance = 0.3) {
  LightField field{pupil_panel, pupil_panel, 0, columns, rows, pupil_panel, distance, {}};
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      field.views.emplace_back(pupil_panel.ny, pupil_panel.nx, 1);
      for (float& v : field.views.back().values) v = float(value(i, j));
    }
  return field;
}

TEST(DiscArea, IsThatOfPointsCounted) {
  const int points = 1000;  // midpoints of a raster: the error is below the length of the border times half a step
  for (const auto& [u, v] : {std::pair{0.3, 0.4},
                             {-0.3, 0.4},
                             {0.3, -0.4},
                             {-0.3, -0.4},
                             {0.9, 0.95},
                             {-0.9, -0.9},
                             {1.0, 0.2},
                             {0.2, 1.0},
                             {-0.7, 0.9},
                             {0.9, -0.7},
                             {0.0, 0.0}}) {
    double count = 0;
    for (int j = 0; j < points; ++j)
      for (int i = 0; i < points; ++i) {
        const double x = (2 * i + 1.0) / points - 1, y = (2 * j + 1.0) / points - 1;
        count += x * x + y * y < 1 && x < u && y < v;
      }
    EXPECT_NEAR(disc_area_below(u, v), count * 4 / points / points, 6.3 / points) << u << " " << v;
  }
  // Closed forms: a quarter, a half and the whole disc, to rounding.
  EXPECT_NEAR(disc_area_below(0, 0), pi / 4, 1e-15);
  EXPECT_NEAR(disc_area_below(1, 0), pi / 2, 1e-15);
  EXPECT_NEAR(disc_area_below(1, 1), pi, 1e-15);
  EXPECT_NEAR(disc_area_below(0), pi / 2, 1e-15);
}

TEST(PupilPicture, EvenLightStaysEvenForCellsSmallAndLarge) {
  for (const int cells : {1, 3, 8, 40})
    for (const double diameter : {1e-6, 0.1e-3, 0.2e-3, 2e-3}) {
      const LightField field = even_field(cells, cells, [](int, int) { return 0.75; });
      for (const double distance : {0.2, -0.1}) {  // behind the panel, and between it and the eye
        const PupilPicture picture =
            picture_through(field, green_light, pupil_panel, distance, {{0, 0, 0.3}, diameter});
        // From the eye, places at the border of a plane in front are not before the panel; those of the middle are.
        const double part = distance > 0 ? 1 : 0.5;
        for (int j = 0; j < pupil_panel.ny; ++j)
          for (int i = 0; i < pupil_panel.nx; ++i)
            if (std::abs(pupil_panel.x(i)) <= part * pupil_panel.width() / 2 &&
                std::abs(pupil_panel.y(double(j))) <= part * pupil_panel.height() / 2) {
              ASSERT_NEAR(picture.radiance(j, i, 0), 0.75, 5e-5) << "up to 1600 floats, 2^-25 each";
            }
      }
    }
}

// A pupil in the lens whose sides are on borders of cells: all pixels have the same footprint, whatever rounding does to it.
TEST(PupilPicture, OnBordersOfCellsIsTheSameForAllPixels) {
  LightField field = even_field(16, 16, [](int i, int j) { return 1 + i + 20 * j; });
  field.panel = {256, 256, 8e-6};
  field.lens = {16, 16, 64e-6};
  field.lens_z = 0.1;
  const Grid pixels{97, 61, 0.37e-6};
  for (int k = -4; k <= 4; ++k) {
    const PupilPicture picture =
        picture_through(field, green_light, pixels, 0.2, {{k * 64e-6, -k * 64e-6, 0.1}, 6 * 64e-6});
    // The centre is the border between cells 7 + k and 8 + k of each axis.
    for (const float value : picture.radiance.values) ASSERT_NEAR(value, 1 + 21 * (7.5 + k), 1e-3) << k;
  }
}

TEST(PupilPicture, CellsCountByTheirPartOfTheFootprint) {
  // Each pixel's rays to the pupil, counted on a raster: the fraction that leaves each cell, times its radiance.
  const auto value = [](int column, int row) { return 1 + column + 10 * row; };
  const double distance = 0.25;
  for (const int cells : {2, 7}) {
    const LightField field = even_field(cells, cells, value);
    for (const Pupil& pupil : {Pupil{{0.05e-3, -0.08e-3, 0.4}, 0.3e-3}, Pupil{{0.3e-3, 0.2e-3, 0.1}, 0.5e-3}}) {
      const PupilPicture picture = picture_through(field, green_light, pupil_panel, distance, pupil);
      for (const auto& [row, column] : {std::pair{0, 0}, {10, 50}, {24, 32}, {47, 3}, {40, 63}}) {
        const Vec3 p{pupil_panel.x(column), pupil_panel.y(row), -distance};
        double sum = 0, count = 0, all = 0;
        const int points = 400;
        for (int j = 0; j < points; ++j)
          for (int i = 0; i < points; ++i) {
            const double x = (2 * i + 1.0) / points - 1, y = (2 * j + 1.0) / points - 1;
            if (x * x + y * y >= 1) continue;
            ++all;
            const Vec3 q = pupil.centre + Vec3{x, y, 0} * (pupil.diameter / 2);
            const Vec3 a = p + (q - p) * (distance / (distance + q.z));  // on the panel
            const double c = (a.x / pupil_panel.width() + 0.5) * cells, r = (0.5 - a.y / pupil_panel.height()) * cells;
            if (c < 0 || c >= cells || r < 0 || r >= cells) continue;
            ++count;
            sum += value(int(c), int(r));
          }
        // A border of cells crosses about `points` of the 1.26e5 points; a few such borders, half a step each, times the
        // range of values.
        const double error = 4.0 / points;
        EXPECT_NEAR(picture.open(row, column), count / all, error) << row << " " << column;
        if (count > 0.05 * all) {
          EXPECT_NEAR(picture.radiance(row, column) / (sum / count), 1, 10 * error) << row << " " << column;
        }
        if (count == 0) {
          EXPECT_EQ(picture.radiance(row, column), 0);
        }
      }
    }
  }
}

// Of a place between panel and lens, the panel is seen through it, and cuts the pupil's rays on the other side: its light is counted
// on a raster of the pupil.
TEST(PupilPicture, ThePanelCutsTheRaysThroughAPlaceInFrontOfIt) {
  LightField field = even_field(16, 16, [](int, int) { return 1; });
  field.lens = {16, 16, 64e-6};
  field.lens_z = 0.1;
  const double z = 0.05;
  const Pupil pupil{{0.3e-3, -0.1e-3, 0.3}, 0.4e-3};
  const PupilPicture picture = picture_through(field, green_light, pupil_panel, -z, pupil);
  bool is_cut = false;
  for (const auto& [row, column] : {std::pair{24, 63}, {24, 0}, {0, 62}, {47, 1}, {20, 30}}) {
    const Vec3 p{pupil_panel.x(column), pupil_panel.y(row), z};
    double count = 0, all = 0;
    const int points = 400;
    for (int j = 0; j < points; ++j)
      for (int i = 0; i < points; ++i) {
        const double x = (2 * i + 1.0) / points - 1, y = (2 * j + 1.0) / points - 1;
        if (x * x + y * y >= 1) continue;
        ++all;
        const Vec3 q = pupil.centre + Vec3{x, y, 0} * (pupil.diameter / 2);
        const Vec3 a = p - (q - p) * (z / (q.z - z));  // on the panel
        count += std::abs(a.x) < pupil_panel.width() / 2 && std::abs(a.y) < pupil_panel.height() / 2;
      }
    is_cut = is_cut || (count > 0.05 * all && count < 0.95 * all);
    EXPECT_NEAR(picture.open(row, column), count / all, 6.3 / points) << row << ", " << column;
  }
  EXPECT_TRUE(is_cut);
}

TEST(PupilPicture, TheConeOfEachPixelClosesPartOfThePupil) {
  // At 4 mm the box of a pixel reaches 0.133 mm to each side: a wide pupil is open over the box, where the panel is.
  const double distance = 4e-3, reach = box_radius(distance, green_light, pupil_panel.pitch), diameter = 4e-3;
  const LightField field = even_field(
      4, 4, [](int, int) { return 1; }, distance);
  const PupilPicture picture = picture_through(field, green_light, pupil_panel, distance, {{0, 0, 4e-3}, diameter});
  const auto side = [&](double place, double half) {
    return std::min(place + reach, half) - std::max(place - reach, -half);
  };
  const double footprint = pi * diameter * diameter / 16;  // half as wide as the pupil: the panel is halfway
  for (const auto& [row, column] : {std::pair{0, 0}, {24, 32}, {10, 60}}) {
    const double open = side(pupil_panel.x(column), pupil_panel.width() / 2) *
                        side(pupil_panel.y(row), pupil_panel.height() / 2) / footprint;
    EXPECT_NEAR(picture.open(row, column) / open, 1, 1e-5) << "floats";
  }
}

TEST(PupilPicture, CellsAreShiftedForAnotherPlane) {
  // A luminous point at depth D, seen from the cell at a, is in the light field's plane at a + (P − a)·L/D. In the
  // plane at D all cells show it at P.
  const double distance = 0.3, depth = 0.24;
  const int cells = 4;
  LightField field = even_field(
      cells, cells, [](int, int) { return 0; }, distance);
  const double px = pupil_panel.x(40), py = pupil_panel.y(12);
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const double ax = pupil_panel.width() * ((i + 0.5) / cells - 0.5),
                   ay = pupil_panel.height() * (0.5 - (j + 0.5) / cells);
      const double x = ax + (px - ax) * distance / depth, y = ay + (py - ay) * distance / depth;
      const double column = x / pupil_panel.pitch + (pupil_panel.nx - 1) / 2.0,
                   row = (pupil_panel.ny - 1) / 2.0 - y / pupil_panel.pitch;
      // Gaussian spots of 2 pixels
      Image& view = field.views[size_t(j * cells + i)];
      for (int r = 0; r < pupil_panel.ny; ++r)
        for (int c = 0; c < pupil_panel.nx; ++c)
          view(r, c) = float(std::exp(-(std::pow(c - column, 2) + std::pow(r - row, 2)) / 8));
    }
  const PupilPicture picture = picture_through(field, green_light, pupil_panel, depth, {{0, 0, 0.3}, 0.4e-3});
  // Read between pixels, a spot loses up to h²/8·f″ = 1/8·2/4 = 6 % per two axes; misplaced by a pixel it would lose
  // much more beside its centre: e^(−1/8) on one side and e^(+…) on the other.
  EXPECT_NEAR(picture.radiance(12, 40), 1, 0.07);
  EXPECT_NEAR(picture.radiance(12, 38) / picture.radiance(12, 42), 1, 0.02);
  EXPECT_NEAR(picture.radiance(10, 40) / picture.radiance(14, 40), 1, 0.02);
  // Spots are (1/0.8) times smaller in the plane at D: e^(−(2·1.25)²/8) = 0.458, with the same loss by interpolation.
  EXPECT_NEAR(picture.radiance(12, 38), std::exp(-6.25 / 8), 0.04);
}

TEST(PupilPicture, IsTheRenderThroughARoundLens) {
  const Grid coarse{32, 24, 16e-6};  // as large as `panel`
  // A lit wall in the plane in focus, behind cards at other depths: their blur and parallax depend on the pupil.
  Scene scene;
  scene.materials = {grey(0.8), grey(0, 0.5), grey(0, 2)};
  scene.meshes = {make_wall(-0.3, 5_mm, 5_mm), make_test_quad({-0.5_mm, 0, -0.24}, {0.45_mm, 0, 0}, {0, 5_mm, 0}, 1),
                  make_test_quad({0.1_mm, 0.1_mm, -0.2}, {0.04_mm, 0.02_mm, 0}, {-0.02_mm, 0.03_mm, 0.01}, 2)};
  scene.background = {0.4, 0.4, 0.4};
  scene.lights = {RectangleLight{{-1_mm, 1_mm, -0.29}, {2_mm, 0, 0}, {0, 0, 2_mm}, {4, 4, 4}}};
  const Pupil pupils[] = {{{0, 0, 0.3}, 0.36e-3}, {{0.1e-3, -0.05e-3, 0.25}, 0.25e-3}};
  const int seeds = 6, blocks = 48;
  std::vector<Statistics> mine[2], reference[2];
  for (auto* of_pupils : {&mine, &reference})
    for (auto& list : *of_pupils) list.assign(blocks, {});
  const auto add_blocks = [](const Image& image, std::vector<Statistics>& sums) {
    for (int b = 0; b < blocks; ++b) {
      double mean = 0;
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) mean += image(b / 8 * 4 + j, b % 8 * 4 + i, 0) / 16;
      sums[size_t(b)].add(mean);
    }
  };
  for (int seed = 1; seed <= seeds; ++seed) {
    const ScenePlanes planes{{}, LightFieldParams{16, 16, 0.3, {}}};
    const LightField field =
        trace_scene_views(scene, coarse, green_light, planes, {.paths = 256, .seed = seed}).light_field;
    for (size_t k = 0; k < 2; ++k) {
      const PupilPicture picture = picture_through(field, green_light, coarse, 0.3, pupils[k]);
      for (const float open : picture.open.values) ASSERT_NEAR(open, 1, 1e-5) << "the panel is wide enough";
      add_blocks(picture.radiance, mine[k]);
      const RenderParams params{.columns = coarse.nx,
                                .rows = coarse.ny,
                                .field_of_view = std::atan(pupil_panel.height() / 2 / 0.3),
                                .eye = pupils[k].centre,
                                .lens = Lens::round,
                                .pupil = pupils[k].diameter,
                                .focus = 0.3,
                                .paths = 64,
                                .seed = seed + 50};
      add_blocks(render(scene, coarse, green_light, params), reference[k]);
    }
  }
  double squares = 0, range = 0;
  for (size_t k = 0; k < 2; ++k)
    for (size_t b = 0; b < blocks; ++b) {
      const double error = std::hypot(mine[k][b].standard_error(), reference[k][b].standard_error());
      const double off = mine[k][b].mean() - reference[k][b].mean();
      // Cells are 32 µm × 24 µm; the card at 240 mm is blurred by 32 µm·60/240 = 8 µm more in their pictures: an eighth
      // of a block of 64 µm at its edge, of which some shows in the mean where the edge is near the border of a block.
      EXPECT_LT(std::abs(off), 7 * error + 0.01) << "pupil " << k << " block " << b;
      squares += off * off / (error * error + 1e-6);
      range = std::max(range, reference[k][b].mean());
    }
  EXPECT_GT(range, 0.5);
  // The mean of t² with 10 degrees of freedom is 10/8, its standard error over 96 blocks about 0.25.
  EXPECT_LT(squares / (2 * blocks), 10.0 / 8 + 1);
}

TEST(PupilPicture, RefusesWhatCannotBe) {
  const LightField field = even_field(2, 2, [](int, int) { return 1; });
  const auto error = [&](const LightField& f, double distance, const Pupil& pupil) {
    return error_of([&] { picture_through(f, green_light, pupil_panel, distance, pupil); });
  };
  EXPECT_EQ(error(field, 0.3, {{0, 0, 0.3}, 2e-3}), "no error");
  EXPECT_EQ(
      error(field, 0, {{0, 0, 0.3}, 2e-3}),
      "expected a picture in a plane behind the pupil, other than those of the panel and the lens, got one at 0 m");
  EXPECT_EQ(error(field, 0.3, {{0, 0, 0.3}, 0}), "expected a length above 0 m for the pupil's diameter, got 0 m");
  EXPECT_EQ(error(field, 0.3, {{0, 0, -0.3}, 2e-3}),
            "expected a length above 0 m for the pupil's distance from the panel, got -300 mm");
  LightField lacking = field;
  lacking.views.pop_back();
  EXPECT_EQ(error(lacking, 0.3, {{0, 0, 0.3}, 2e-3}),
            "expected a light field with a picture for each of its 2 × 2 cells, got 3");
  lacking.views.emplace_back(3, 3, 1);
  EXPECT_NE(error(lacking, 0.3, {{0, 0, 0.3}, 2e-3})
                .find("expected 64 x 48 pixels and 1 channel(s) in the view of column 2 and row 2"),
            std::string::npos);
}

// Light that is even over place and direction looks the same by cells of the panel and by cells in the plane of the pupil: 1, where
// rays pass the panel; and the same part of the pupil is open, also where the panel's edge cuts it. Cells of an eighth of the
// pupil are cut by straight borders, which is exact but for the cells at the disc's rim: 4 % of it at the worst.
TEST(PupilPicture, OfALensInFrontOfThePanelIsThatOfThePanel) {
  const Pupil pupil{{1e-4, -5e-5, 0.2}, 2.4e-4};
  const LightField of_panel = even_field(8, 6, [](int, int) { return 1; });
  LightField of_lens = even_field(8, 8, [](int, int) { return 1; });
  of_lens.lens = {8, 8, 3e-5, pupil.centre.x, pupil.centre.y};
  of_lens.lens_z = pupil.centre.z;
  const Grid wide{100, 80, 2e-5};
  const PupilPicture a = picture_through(of_panel, 532e-9, wide, 0.3, pupil);
  const PupilPicture b = picture_through(of_lens, 532e-9, wide, 0.3, pupil);
  double open = 0, cut = 0;
  for (size_t i = 0; i < a.open.values.size(); ++i) {
    EXPECT_NEAR(a.open.values[i], b.open.values[i], 0.04);
    EXPECT_EQ(a.open.values[i] > 0.05F, a.radiance.values[i] > 0 && a.open.values[i] > 0.05F);
    if (b.open.values[i] > 0.05F) {
      EXPECT_NEAR(b.radiance.values[i], 1, 1e-5);
    }
    open += a.open.values[i] > 0.999F;
    cut += a.open.values[i] > 0.1F && a.open.values[i] < 0.9F;
  }
  EXPECT_GT(open, 1000);  // else the lines above say little
  EXPECT_GT(cut, 500);
  of_lens.lens_z = 0.25;  // the pupil is behind it
  EXPECT_THROW(picture_through(of_lens, 532e-9, wide, 0.3, pupil), Error);
}

}  // namespace
}  // namespace holotrace
