#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>

#include "holotrace/data/acceptance.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/trace/render.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const Grid stack_panel{32, 24, 8e-6};  // 0.256 mm × 0.192 mm, acceptance tangent 0.033

struct Interval {
  double low, high;
  double size() const { return std::max(0.0, high - low); }
};

Interval overlap(const Interval& a, const Interval& b) { return {std::max(a.low, b.low), std::min(a.high, b.high)}; }

const Interval panel_x{-0.128_mm, 0.128_mm}, panel_y{-0.096_mm, 0.096_mm};

/// Fraction of the rays from `lens` through a pixel (centre X) of the plane at d that cross `object`, an interval in
/// the plane at depth D, along one axis: a + (X − a)·D/d, where |a − X| ≤ d·T. The mean over the pixel by midpoints.
double seen_fraction(const Interval& lens, const Interval& object, double pixel, double plane, double depth) {
  const double reach = plane * acceptance_tangent(green_light, stack_panel.pitch), ratio = depth / plane;
  const int points = 64;
  double seen = 0, all = 0;
  for (int i = 0; i < points; ++i) {
    const double x = pixel + ((i + 0.5) / points - 0.5) * stack_panel.pitch;
    const Interval whole = overlap(lens, {x - reach, x + reach});
    Interval hits;
    if (std::abs(1 - ratio) < 1e-12) {
      hits = x > object.low && x < object.high ? whole : Interval{0, 0};
    } else {
      const double a = (object.low - x * ratio) / (1 - ratio), b = (object.high - x * ratio) / (1 - ratio);
      hits = overlap(whole, {std::min(a, b), std::max(a, b)});
    }
    seen += hits.size();
    all += whole.size();
  }
  return all > 0 ? seen / all : 0;
}

/// A luminous rectangle at that depth and of radiance 1, before black.
Scene make_rectangle(const Interval& x, const Interval& y, double depth) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {
      make_test_quad({(x.low + x.high) / 2, (y.low + y.high) / 2, -depth}, {x.size() / 2, 0, 0}, {0, y.size() / 2, 0})};
  return scene;
}

/// Checks a picture of light that is 0 or 1 on each ray against the fraction expected(row, column) of rays with 1.
/// A mean of N independent rays has the variance p(1 − p)/N; stratification makes it smaller, not larger.
template <class Expected>
void expect_fractions(const Image& picture, int paths, const Expected& expected) {
  double difference = 0, squares = 0, variance = 0;
  for (int j = 0; j < picture.ny; ++j)
    for (int i = 0; i < picture.nx; ++i) {
      const double p = std::min(1.0, expected(j, i)), off = picture(j, i, 1) - p;
      difference += off;
      squares += off * off;
      variance += p * (1 - p) / paths;
      EXPECT_LT(std::abs(off), 6 * std::sqrt(p * (1 - p) / paths) + 1.0 / paths) << j << " " << i << " expected " << p;
    }
  const double pixels = double(picture.nx) * picture.ny;
  EXPECT_LT(squares, 1.1 * variance + 1.0 / paths / paths)
      << "1.1: for pixels with fewer paths than the mean; rounding may move a ray across the border of a pixel";
  EXPECT_LT(std::abs(difference), 4 * std::sqrt(variance) + 1e-5 * pixels) << "four standard errors of the sum";
}

TEST(FocalStack, EvenRadianceIsEvenInAllPlanesAndCells) {
  // Weights differ from ray to ray, but ΣwL/Σw of L = 0.75 is 0.75 whatever they are, to float rounding of the sums.
  const ScenePlanes planes{{0.02, 0.05, 1, 0.3}, LightFieldParams{4, 3, 0.1, {}}};
  const SceneViews views =
      trace_scene_views(make_bright_wall(-0.3, 0.75), stack_panel, green_light, planes, {.paths = 4});
  ASSERT_EQ(views.stack.pictures.size(), 4u);
  ASSERT_EQ(views.light_field.views.size(), 12u);
  EXPECT_EQ(views.stack.distances, planes.distances);
  EXPECT_EQ(views.stack.grid, stack_panel);
  for (const auto* pictures : {&views.stack.pictures, &views.light_field.views})
    for (const Image& picture : *pictures) {
      ASSERT_EQ(picture.values.size(), size_t(3 * stack_panel.pixels()));
      for (const float value : picture.values) ASSERT_NEAR(value, 0.75, 1e-5);
    }
}

TEST(FocalStack, ARectangleIsSharpInItsPlaneAndBlurredByTheApertureElsewhere) {
  // Edges off the pixels' borders. The plane at 3 mm sees 0.1 mm to each side only, less than the panel.
  const Interval x{-0.05_mm, 0.033_mm}, y{-0.021_mm, 0.061_mm};
  const std::vector<double> distances{0.1, 0.05, 0.2, 0.003, 0.095};
  const int paths = 64;
  const FocalStack stack =
      trace_focal_stack(make_rectangle(x, y, 0.1), stack_panel, green_light, distances, {.paths = paths});
  for (size_t k = 0; k < distances.size(); ++k) {
    SCOPED_TRACE(distances[k]);
    expect_fractions(stack.pictures[k], paths, [&](int row, int column) {
      return seen_fraction(panel_x, x, stack_panel.x(column), distances[k], 0.1) *
             seen_fraction(panel_y, y, stack_panel.y(row), distances[k], 0.1);
    });
  }
}

TEST(FocalStack, RaysThatMissFartherWindowsHaveTheirOwnWeight) {
  // Lit is what lies to the right of and above the window: near the panel, rays to it miss the farther windows, and
  // have another density than the dark rays of the same pixel. The planes see 0.03 mm, 0.13 mm and 3 mm to each side.
  const Interval x{0.12_mm, 1_mm}, y{0.05_mm, 1_mm};
  const std::vector<double> distances{0.001, 0.004, 0.1};
  const int paths = 64;
  const FocalStack stack =
      trace_focal_stack(make_rectangle(x, y, 0.005), stack_panel, green_light, distances, {.paths = paths});
  for (size_t k = 0; k < distances.size(); ++k) {
    SCOPED_TRACE(distances[k]);
    // At the corners of the window a pixel sees a quarter of its box: a quarter of the paths.
    expect_fractions(stack.pictures[k], paths / 2, [&](int row, int column) {
      return seen_fraction(panel_x, x, stack_panel.x(column), distances[k], 0.005) *
             seen_fraction(panel_y, y, stack_panel.y(row), distances[k], 0.005);
    });
  }
}

TEST(FocalStack, ANearCardHidesTheFarWallFromPartOfTheAperture) {
  Scene scene = make_bright_wall(-0.3);
  scene.materials.push_back(grey(0));
  scene.meshes.push_back(make_test_quad({-5_mm, 0, -0.1}, {5_mm, 0, 0}, {0, 5_mm, 0}, 1));  // its edge is at x = 0
  const Interval bright{0, 1};
  const std::vector<double> distances{0.1, 0.3, 0.15};
  const LightFieldParams cells{4, 2, 0.2, {}};
  const int paths = 64;
  const SceneViews views =
      trace_scene_views(scene, stack_panel, green_light, {distances, cells}, {.paths = paths, .seed = 3});
  for (size_t k = 0; k < distances.size(); ++k) {
    SCOPED_TRACE(distances[k]);
    expect_fractions(views.stack.pictures[k], paths, [&](int, int column) {
      return seen_fraction(panel_x, bright, stack_panel.x(column), distances[k], 0.1);
    });
  }
  for (int cell = 0; cell < 8; ++cell) {
    SCOPED_TRACE(cell);
    const double width = stack_panel.width() / 4, left = panel_x.low + cell % 4 * width;
    expect_fractions(views.light_field.views[size_t(cell)], paths / 8, [&](int, int column) {
      return seen_fraction({left, left + width}, bright, stack_panel.x(column), 0.2, 0.1);
    });
  }
}

TEST(FocalStack, RowsOfCellsRunFromTheTop) {
  // A card below y = 0 in front of a bright wall: seen past its edge, the wall is above.
  Scene scene = make_bright_wall(-0.3);
  scene.materials.push_back(grey(0));
  scene.meshes.push_back(make_test_quad({0, -5_mm, -0.1}, {5_mm, 0, 0}, {0, 5_mm, 0}, 1));
  const int paths = 64;
  const LightField field =
      trace_scene_views(scene, stack_panel, green_light, {{}, LightFieldParams{2, 4, 0.2, {}}}, {.paths = paths})
          .light_field;
  for (int cell = 0; cell < 8; ++cell) {
    const double height = stack_panel.height() / 4, top = panel_y.high - cell / 2 * height;
    expect_fractions(field.views[size_t(cell)], paths / 8, [&](int row, int) {
      return seen_fraction({top - height, top}, {0, 1}, stack_panel.y(row), 0.2, 0.1);
    });
  }
}

TEST(FocalStack, EachPlaneHasTheSameEnergy) {
  // The flux through panel and window is L·dA·A/d² for each pixel. The blur stays in the window: at 97 mm it is
  // 0.256 mm·3/100 wide.
  const Interval side{-0.05_mm, 0.05_mm};
  const std::vector<double> distances{0.097, 0.1, 0.104};
  const int paths = 64;
  const FocalStack stack =
      trace_focal_stack(make_rectangle(side, side, 0.1), stack_panel, green_light, distances, {.paths = paths});
  const double flux = side.size() * side.size() / (0.1 * 0.1);
  for (size_t k = 0; k < distances.size(); ++k) {
    double sum = 0;
    for (const float value : stack.pictures[k].values) sum += value / 3.0;
    const double side_of_pixel = stack_panel.pitch / distances[k];
    // Pixels on the rim, at most 4 × 20 of them, have a variance of at most ¼/N each: 4 standard errors.
    const double pixels = flux / (side_of_pixel * side_of_pixel);
    EXPECT_NEAR(sum, pixels, 4 * std::sqrt(80 * 0.25 / paths)) << distances[k];
  }
}

/// Means of blocks of 8 × 8 pixels.
std::vector<double> block_means(const Image& image) {
  std::vector<double> means(size_t(image.nx / 8) * size_t(image.ny / 8));
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) means[size_t(j / 8 * (image.nx / 8) + i / 8)] += image(j, i, 1) / 64;
  return means;
}

TEST(FocalStack, OneTracingGivesTheRendersFocusedOneByOne) {
  // Mirrors, glass, shadows and a background at the scale of the window; planes near and far, and cones that cut.
  Scene scene = make_corner();
  scene.materials.push_back(grey(0.2, 0.5));
  scene.meshes.push_back(make_test_quad({0.05_mm, 0, -0.1}, {0.03_mm, 0.02_mm, 0}, {-0.02_mm, 0.03_mm, 0.01}, 2));
  scene.meshes.push_back(make_test_quad({-0.05_mm, 0.03_mm, -0.02}, {0.02_mm, 0, 0}, {0, 0.02_mm, 0}, 1));
  scene.background = {0.3, 0.3, 0.3};
  const std::vector<double> distances{0.004, 0.02, 0.1, 0.29, 1};
  const int seeds = 8, paths = 16;
  std::vector<std::vector<Statistics>> stacks(distances.size(), std::vector<Statistics>(12)), renders = stacks;
  for (int seed = 1; seed <= seeds; ++seed) {
    const ScenePlanes planes{distances, LightFieldParams{2, 2, 0.05, {}}};
    const FocalStack stack =
        trace_scene_views(scene, stack_panel, green_light, planes, {.paths = paths, .seed = seed}).stack;
    for (size_t k = 0; k < distances.size(); ++k) {
      const RenderParams params{.columns = stack_panel.nx,
                                .rows = stack_panel.ny,
                                .field_of_view = std::atan(stack_panel.height() / 2 / distances[k]),
                                .lens = Lens::panel,
                                .focus = distances[k],
                                .paths = paths,
                                .seed = seed + 100};
      const auto mine = block_means(stack.pictures[k]);
      const auto reference = block_means(render(scene, stack_panel, green_light, params));
      for (size_t b = 0; b < 12; ++b) stacks[k][b].add(mine[b]), renders[k][b].add(reference[b]);
    }
  }
  double squares = 0;
  for (size_t k = 0; k < distances.size(); ++k)
    for (size_t b = 0; b < 12; ++b) {
      const Statistics &mine = stacks[k][b], &reference = renders[k][b];
      const double error = std::hypot(mine.standard_error(), reference.standard_error());
      const double off = std::abs(mine.mean() - reference.mean());
      // Student's t of 14 degrees of freedom exceeds 6.5 with probability 1e-5. 1e-5: float rounding of even blocks.
      EXPECT_LT(off, 6.5 * error + 1e-5) << "plane " << distances[k] << " block " << b;
      squares += off * off / (error * error + 1e-10);
    }
  // The mean of t² is 14/12, its standard error over 60 blocks below 0.3; 2 allows for four of them.
  EXPECT_LT(squares / 60, 14.0 / 12 + 0.9);
}

TEST(FocalStack, AddsFewPathsForPlanesThatAreNear) {
  // N paths for each pixel of the farthest plane; a nearer plane needs more only for the part 1 − (d/d′)² of its rays
  // that miss the window of the next farther one. The light field's plane comes first; a farther plane then adds
  // 1 − (d/d′)² of its rays.
  const auto rays_of = [](const ScenePlanes& planes) {
    Record record;
    trace_scene_views(make_bright_wall(), stack_panel, green_light, planes, {.paths = 64}, record.observer);
    return double(record.count("rays"));
  };
  const auto step = [](double near, double far) { return 1 - near * near / (far * far); };
  const double render = 64.0 * double(stack_panel.pixels());
  // 2 %: the numbers of paths in the border pixels are random.
  EXPECT_NEAR(rays_of({{0.29, 0.3, 0.31}, {}}) / render, 1 + step(0.29, 0.3) + step(0.3, 0.31), 0.02);
  EXPECT_NEAR(rays_of({{0.29, 0.31}, LightFieldParams{8, 8, 0.3, {}}}) / render, 1 + step(0.3, 0.31) + step(0.29, 0.3),
              0.02);
  EXPECT_NEAR(rays_of({{0.1, 1}, {}}) / render, 1 + step(0.1, 1), 0.02);
}

TEST(FocalStack, TheCellsOfAPixelHaveAnEqualNumberOfPaths) {
  // 64 paths and 8 × 8 cells: a wall whose radiance is random per path cannot be had, but a stratified aperture shows
  // in the edge of a card at the panel: each cell's light through the pixel is exactly 0 or 1 away from the edge.
  const Scene scene = make_rectangle({0, 1_mm}, {-1_mm, 1_mm}, 1e-6);  // covers the right half of the panel's front
  const LightField field =
      trace_scene_views(scene, stack_panel, green_light, {{}, LightFieldParams{8, 8, 0.2, {}}}, {.paths = 64})
          .light_field;
  for (int cell = 0; cell < 64; ++cell)
    for (const float value : field.views[size_t(cell)].values) ASSERT_EQ(value, cell % 8 >= 4) << cell;
}

TEST(FocalStack, PixelsThatNoPathReachedTakeTheLightOfTheirNeighbours) {
  // One path per pixel reaches one of 64 cells. The card of the test above: the nearest cells with paths are near or
  // far, but their mean is never below 0 or above 1, and even light stays even.
  const LightField field = trace_scene_views(make_bright_wall(), stack_panel, green_light,
                                             {{}, LightFieldParams{8, 8, 0.2, {}}}, {.paths = 1})
                               .light_field;
  for (const Image& view : field.views)
    for (const float value : view.values) ASSERT_EQ(value, 1);
  // A plane whose rays come from another plane's pixels has pixels without paths, about exp(−1) of them.
  const FocalStack stack = trace_focal_stack(make_bright_wall(), stack_panel, green_light, {0.2, 0.15}, {.paths = 1});
  for (const Image& picture : stack.pictures)
    for (const float value : picture.values) ASSERT_EQ(value, 1);
}

TEST(FocalStack, APointInFocusIsAsInTheRender) {
  Scene scene;
  scene.points = {{{0.0301_mm, -0.0217_mm, -0.1}, 2.0f, 0}, {{-0.1_mm, 0.05_mm, -0.1}, 1.0f, 0}};
  const FocalStack stack = trace_focal_stack(scene, stack_panel, green_light, {0.1}, {.paths = 1});
  const RenderParams params{.columns = stack_panel.nx,
                            .rows = stack_panel.ny,
                            .field_of_view = std::atan(stack_panel.height() / 0.2),
                            .lens = Lens::panel,
                            .focus = 0.1,
                            .paths = 1};
  const Image image = render(scene, stack_panel, green_light, params);
  const float largest = *std::max_element(image.values.begin(), image.values.end());
  EXPECT_GT(largest, 0);
  for (size_t i = 0; i < image.values.size(); ++i)
    ASSERT_NEAR(stack.pictures[0].values[i], image.values[i], 1e-5 * largest) << "float and double rounding of places";
}

TEST(FocalStack, APointOutOfFocusIsTheImageOfTheAperture) {
  Scene scene;
  const Vec3 at{0.02_mm, -0.01_mm, -0.1};
  scene.points = {{at, 1.0f, 0}};
  const FocalStack stack = trace_focal_stack(scene, stack_panel, green_light, {0.1, 0.08, 0.15}, {.paths = 1});
  const auto sum = [](const Image& image) { return std::accumulate(image.values.begin(), image.values.end(), 0.0); };
  for (const size_t k : {1, 2}) {
    const double d = stack.distances[k], ratio = d / 0.1, size = std::abs(1 - ratio);
    // Irradiance is radiance times the pixel's area over d²: the sum of radiance grows as d². Floats.
    EXPECT_NEAR(sum(stack.pictures[k]) / sum(stack.pictures[0]), ratio * ratio, 1e-5);
    const Interval x{at.x * ratio - stack_panel.width() / 2 * size, at.x * ratio + stack_panel.width() / 2 * size};
    const Interval y{at.y * ratio - stack_panel.height() / 2 * size, at.y * ratio + stack_panel.height() / 2 * size};
    for (int j = 0; j < stack_panel.ny; ++j)
      for (int i = 0; i < stack_panel.nx; ++i) {
        const double half = stack_panel.pitch / 2;
        const double covered = overlap(x, {stack_panel.x(i) - half, stack_panel.x(i) + half}).size() *
                               overlap(y, {stack_panel.y(j) - half, stack_panel.y(j) + half}).size() /
                               (x.size() * y.size());
        ASSERT_NEAR(stack.pictures[k](j, i) / (sum(stack.pictures[k]) / 3), covered, 1e-6) << j << " " << i;
      }
  }
}

TEST(FocalStack, APointThatOnlyPartOfThePanelSeesKeepsItsFlux) {
  // Flux through the panel: Σ L·pitch²/d²·(part of the panel that the pixel sees). From 3 mm the cone has 0.2 mm.
  Scene scene;
  scene.points = {{{0.01_mm, 0, -0.003}, 1.0f, 0}};
  const FocalStack stack = trace_focal_stack(scene, stack_panel, green_light, {0.003, 0.002, 0.005}, {.paths = 1});
  std::vector<double> fluxes;
  for (size_t k = 0; k < 3; ++k) {
    const double d = stack.distances[k], reach = d * acceptance_tangent(green_light, stack_panel.pitch);
    double flux = 0;
    for (int j = 0; j < stack_panel.ny; ++j)
      for (int i = 0; i < stack_panel.nx; ++i)
        flux += stack.pictures[k](j, i) / (d * d) *
                overlap(panel_x, {stack_panel.x(i) - reach, stack_panel.x(i) + reach}).size() *
                overlap(panel_y, {stack_panel.y(j) - reach, stack_panel.y(j) + reach}).size();
    fluxes.push_back(flux);
  }
  EXPECT_GT(fluxes[0], 0);
  EXPECT_NEAR(fluxes[1] / fluxes[0], 1, 1e-5) << "floats";
  EXPECT_NEAR(fluxes[2] / fluxes[0], 1, 1e-5) << "floats";
}

TEST(FocalStack, EachCellSeesAPointFromItsOwnPlace) {
  // From the cell at a, a point at depth D is at a + (P − a)·d/D. A card hides it from the left cells.
  Scene scene;
  scene.materials = {grey(0)};
  scene.points = {{{0, 0, -0.1}, 1.0f, 0}};
  scene.meshes = {make_test_quad({-0.5_mm, 0, -0.05}, {0.5_mm, 0, 0}, {0, 5_mm, 0})};
  const LightField field =
      trace_scene_views(scene, stack_panel, green_light, {{}, LightFieldParams{4, 1, 0.12, {}}}, {.paths = 1})
          .light_field;
  for (int cell = 0; cell < 4; ++cell) {
    double sum = 0, moment = 0;
    for (int j = 0; j < stack_panel.ny; ++j)
      for (int i = 0; i < stack_panel.nx; ++i) {
        sum += field.views[size_t(cell)](j, i);
        moment += field.views[size_t(cell)](j, i) * stack_panel.x(i);
      }
    EXPECT_EQ(sum > 0, cell >= 2) << cell;
    const double a = stack_panel.width() * (cell - 1.5) / 4;
    if (sum > 0) {
      // The image of a cell is 12.8 µm wide. Light counts at a pixel's centre: each end moves it by up to pitch²/8.
      EXPECT_NEAR(moment / sum, a * (1 - 1.2), stack_panel.pitch * stack_panel.pitch / 8 / 12.8e-6);
    }
  }
}

TEST(FocalStack, TheNumberOfThreadsChangesNoByte) {
  const auto trace = [] {
    return trace_scene_views(make_corner(), stack_panel, green_light, {{0.28, 0.3}, LightFieldParams{2, 2, 0.29, {}}},
                             {.paths = 4});
  };
  const SceneViews many = trace();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SceneViews single = trace();
  for (size_t k = 0; k < 2; ++k) EXPECT_EQ(single.stack.pictures[k].values, many.stack.pictures[k].values);
  for (size_t k = 0; k < 4; ++k) EXPECT_EQ(single.light_field.views[k].values, many.light_field.views[k].values);
}

TEST(FocalStack, ThePlaneOfALightFieldMayHaveItsOwnPixels) {
  const Grid coarse{20, 10, 40e-6, 0.1_mm, -0.05_mm};  // wider than the panel, off its axis
  const Interval x{0.1_mm, 0.3_mm}, y{-0.2_mm, 0.02_mm};
  const ScenePlanes planes{{0.1}, LightFieldParams{1, 1, 0.1, coarse}};
  const SceneViews views =
      trace_scene_views(make_rectangle(x, y, 0.1), stack_panel, green_light, planes, {.paths = 64});
  const auto expect_sharp = [&](const Image& picture, const Grid& grid) {
    expect_fractions(picture, 32, [&](int row, int column) {
      const double half = grid.pitch / 2;
      return overlap(x, {grid.x(column) - half, grid.x(column) + half}).size() *
             overlap(y, {grid.y(row) - half, grid.y(row) + half}).size() / (grid.pitch * grid.pitch);
    });
  };
  expect_sharp(views.light_field.views[0], coarse);
  expect_sharp(views.stack.pictures[0], stack_panel);
}

TEST(FocalStack, RefusesPlanesThatCannotBe) {
  const auto error = [](const ScenePlanes& planes) {
    return error_of([&] { trace_scene_views(make_bright_wall(), stack_panel, green_light, planes, {.paths = 1}); });
  };
  EXPECT_EQ(error({}),
            "expected at least one plane for a focal stack, got none; give distances, such as \"290 mm, 300 mm\"");
  for (const double distance : {0.0, std::nan(""), double(INFINITY)})
    EXPECT_NE(error({{0.3, distance}, {}}).find("expected planes of a focal stack behind the panel or in front of it"),
              std::string::npos)
        << distance;
  EXPECT_NE(error({{}, LightFieldParams{0, 1, 0.3, {}}}).find("expected 1 to 32 columns and 1 to 24 rows of cells"),
            std::string::npos);
  EXPECT_NE(error({{}, LightFieldParams{1, 1, 0.0, {}}})
                .find("expected a light field in a plane other than those of the panel and the lens"),
            std::string::npos);
  EXPECT_NE(error({{}, LightFieldParams{32, 24, 0.3, Grid{40000, 40000, 1e-6}}}).find("memory"), std::string::npos);
}

// A line from the panel to a place behind it is, mirrored, the line to the place's mirror image in front. So pictures of things
// that shine are those of their mirror images, in planes in front of the panel.
TEST(FocalStack, OfThingsInFrontOfThePanelIsThatOfTheirMirrorImage) {
  const Scene behind = make_rectangle({-0.05_mm, 0.08_mm}, {-0.03_mm, 0.06_mm}, 6_mm);
  Scene front = behind;
  for (Vec3& p : front.meshes[0].positions) p.z *= -1;
  const RenderParams params{.paths = 8};
  const FocalStack a = trace_focal_stack(behind, stack_panel, green_light, {6_mm, 9_mm}, params);
  const FocalStack b = trace_focal_stack(front, stack_panel, green_light, {-6_mm, -9_mm}, params);
  double light = 0;
  for (size_t p = 0; p < 2; ++p)
    for (size_t i = 0; i < a.pictures[p].values.size(); ++i) {
      ASSERT_NEAR(a.pictures[p].values[i], b.pictures[p].values[i], 1e-6) << p << " " << i;
      light += a.pictures[p].values[i];
    }
  EXPECT_GT(light, 100);
  RenderParams of_panel{
      .columns = 32, .rows = 32, .field_of_view = 0.02, .lens = Lens::panel, .focus = 6_mm, .paths = 8};
  const Image seen = render(behind, stack_panel, green_light, of_panel);
  of_panel.focus = -6_mm;
  const Image seen_in_front = render(front, stack_panel, green_light, of_panel);
  for (size_t i = 0; i < seen.values.size(); ++i) ASSERT_NEAR(seen.values[i], seen_in_front.values[i], 1e-6) << i;
}

// A viewer sees what is in front of the panel before what is behind it, and an eye does not see what is behind it itself.
TEST(FocalStack, ThingsInFrontHideThoseBehind) {
  Scene scene = make_rectangle({-1_mm, 1_mm}, {-1_mm, 1_mm}, 6_mm);
  scene.materials.push_back(grey(0, 0));
  scene.meshes.push_back(make_wall(3_mm, 1_mm, 1_mm, 1));
  const auto mean = [&](const RenderParams& params) {
    const Image image = render(scene, stack_panel, green_light, params);
    double sum = 0;
    for (const float v : image.values) sum += v;
    return sum / double(image.values.size());
  };
  RenderParams params{.rows = 8, .field_of_view = 0.01, .lens = Lens::panel, .focus = 6_mm, .paths = 4};
  EXPECT_EQ(mean(params), 0);
  params.lens = Lens::pinhole;
  EXPECT_EQ(mean(params), 0);  // through the panel's centre
  params.eye = {0, 0, 2_mm};   // between the panel and the wall
  EXPECT_NEAR(mean(params), 1, 1e-6);
  params.eye = {0, 0, 5_mm};
  EXPECT_EQ(mean(params), 0);
}

}  // namespace
}  // namespace holotrace
