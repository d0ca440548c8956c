// Views of the hologram of known points, through the whole chain: in focus at their depth, at their pixel, upright.

#include <gtest/gtest.h>

#include <cmath>

#include "end_to_end/scenes.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/combine_views.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

struct Pixel {
  int row = 0, column = 0;
  bool operator==(const Pixel&) const = default;
};

std::ostream& operator<<(std::ostream& out, Pixel p) { return out << "row " << p.row << ", column " << p.column; }

// The centre of a pixel; row 0 is the top row.
Vec3 centre(const Grid& panel, Pixel p, double depth) { return {panel.x(p.column), panel.y(p.row), -depth}; }

// The brightest pixel within `reach` rows and columns of a pixel.
Pixel brightest_near(const Image& view, Pixel place, int reach) {
  Pixel best = place;
  for (int j = std::max(place.row - reach, 0); j <= std::min(place.row + reach, view.ny - 1); ++j)
    for (int i = std::max(place.column - reach, 0); i <= std::min(place.column + reach, view.nx - 1); ++i)
      if (view(j, i) > view(best.row, best.column)) best = {j, i};
  return best;
}

double mean(const Image& view) {
  double sum = 0;
  for (const float v : view.values) sum += v;
  return sum / double(view.values.size());
}

// Makes the field and the hologram of the points on a panel.
void make_hologram(const Workplace& work, const Grid& panel, const std::vector<Luminous>& points,
                   const std::string& image) {
  work.write("points.ply", point_file(points));
  work.write("scene.toml", scene_head(panel) + points_object());
  expect_success(work, {"field", "scene.toml", "-o", "f.npy"});
  expect_success(work, {"encode", "f.npy", "-o", "h.png", "--image", image});
}

Image look_at(const Workplace& work, const std::string& distance) {
  expect_success(work, {"show", "h.png", "-o", "view.exr", "--distance", distance});
  return load_image(work.path("view.exr"));
}

struct Panel {
  const char* name;
  Grid grid;
  const char* image;
};

class Focus : public testing::TestWithParam<Panel> {};

// Three points form an L, which has no symmetry: one near the top left, one below it, and one to its right.
TEST_P(Focus, PointsAreAtTheirPixelsAndUpright) {
  const Grid& panel = GetParam().grid;
  const std::vector<Pixel> places{{40, 60}, {140, 60}, {40, 150}};
  std::vector<Luminous> points;
  for (const Pixel place : places) points.push_back({centre(panel, place, 0.03)});
  const Workplace work;
  make_hologram(work, panel, points, GetParam().image);
  const Image view = look_at(work, "30 mm");
  ASSERT_EQ(view.nx, panel.nx);
  const double average = mean(view);
  for (const Pixel place : places) {
    // The spot's half width is λz/S = 532 nm·30 mm/1.5 mm ≈ 10 µm, a pixel: nothing else within 8 pixels is as bright.
    EXPECT_EQ(brightest_near(view, place, 8), place);
    // Three points share the light of a kinoform. If a third of the power is lost to ghosts, and half of the rest is
    // outside the spot's brightest pixel, each still has 1/9 of 49152 averages; 1000 leaves a factor of 5.
    EXPECT_GT(view(place.row, place.column), 1000 * average) << place;
  }
  // Mirrored in x, in y, and in both: dark, below a twentieth of a point.
  const float faintest = std::min({view(40, 60), view(140, 60), view(40, 150)});
  const auto peak_at = [&](int row, int column) {
    const Pixel best = brightest_near(view, {row, column}, 3);
    return view(best.row, best.column);
  };
  EXPECT_LT(peak_at(panel.ny - 1 - 40, 150), faintest / 20);
  EXPECT_LT(peak_at(40, panel.nx - 1 - 60), faintest / 20);
  EXPECT_LT(peak_at(panel.ny - 1 - 40, panel.nx - 1 - 60), faintest / 20);
}

// Depth of focus 2λz²/S² = 2·532 nm·(30 mm)²/(2 mm)² = 0.24 mm: in a scan in steps of 1 mm, the sharpest is at d.
TEST_P(Focus, APointIsSharpestAtItsDepth) {
  const Grid& panel = GetParam().grid;
  const Pixel place{70, 160};
  const Workplace work;
  make_hologram(work, panel, {{centre(panel, place, 0.03)}}, GetParam().image);
  expect_success(work, {"show", "h.png", "-o", "v.exr", "--distance", "28 29 30 31 32 mm"});
  std::vector<float> peaks;
  for (const char* name : {"v.exr", "v_2.exr", "v_3.exr", "v_4.exr", "v_5.exr"}) {
    const Image view = load_image(work.path(name));
    peaks.push_back(view(place.row, place.column));
  }
  for (const size_t i : {0U, 1U, 3U, 4U})
    EXPECT_LT(peaks[i], peaks[2] / 4) << i;  // 1 mm is 4 depths of focus; a sinc² falls faster than 1/4 over it
}

INSTANTIATE_TEST_SUITE_P(Panels, Focus,
                         testing::Values(Panel{"VirtualEven", small_panel, "virtual"},
                                         Panel{"VirtualOdd", {257, 193, 8e-6}, "virtual"},
                                         Panel{"VirtualMixed", {256, 193, 8e-6}, "virtual"},
                                         Panel{"RealEven", small_panel, "real"},
                                         Panel{"RealOdd", {257, 193, 8e-6}, "real"}),
                         [](const auto& info) { return info.param.name; });

TEST(FocusInDepth, EachOfTwoPointsIsSharpAtItsOwnDistance) {
  const Pixel left{90, 80}, right{100, 180};
  const Workplace work;
  make_hologram(work, small_panel, {{centre(small_panel, left, 0.02)}, {centre(small_panel, right, 0.04)}}, "virtual");
  const Image near = look_at(work, "20 mm"), far = look_at(work, "40 mm");
  EXPECT_EQ(brightest_near(near, left, 8), left);
  EXPECT_EQ(brightest_near(far, right, 8), right);
  // 20 mm out of focus, the light of a point spreads over ≥ (20 mm/40 mm·1.5 mm)² = 8789 pixels; in focus
  // over one or two. A ratio of 100 allows for ghosts and for the other point's fringes.
  EXPECT_GT(near(left.row, left.column), 100 * far(left.row, left.column));
  EXPECT_GT(far(right.row, right.column), 100 * near(right.row, right.column));
}

TEST(FocusInDepth, RunsOwnViewShowsThePointToo) {
  const Pixel place{70, 160};
  const Workplace work;
  work.write("points.ply", point_file({{centre(small_panel, place, 0.03)}}));
  work.write("scene.toml", scene_head() + points_object());
  expect_success(work, {"run", "scene.toml", "-o", "out", "--distance", "30 mm", "--exposure", "1e6"});
  // White is above the peak, so no pixel saturates: the 8-bit image has one brightest pixel.
  const Image view = load_image(work.path("out/view.png"));
  EXPECT_EQ(brightest_near(view, {view.ny / 2, view.nx / 2}, 1000), place);
}

TEST(FocusOffAxis, ThePointOfAnOffAxisHologramIsAtItsPixelToo) {
  // The image has a quarter of the panel's cone beside the reference: nearer to the axis than λ/8p·z.
  const Pixel place{80, 150};
  const Workplace work;
  work.write("points.ply", point_file({{centre(small_panel, place, 0.06)}}));
  work.write("scene.toml", scene_head() + points_object());
  expect_success(work, {"field", "scene.toml", "-o", "f.npy"});
  ASSERT_EQ(work.run({"encode", "f.npy", "-o", "h.png", "--method", "off-axis"}).exit_code, 0);
  const Image view = look_at(work, "60 mm");
  const Pixel best = brightest_near(view, {96, 128}, 1000);
  EXPECT_NEAR(best.row, place.row, 1);  // the stop halves the bandwidth: a spot of about two pixels
  EXPECT_NEAR(best.column, place.column, 1);
}

// Pearson correlation of two images of one size.
double correlation(const Image& a, const Image& b) {
  const double mean_a = mean(a), mean_b = mean(b);
  double aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < a.values.size(); ++i) {
    const double x = a.values[i] - mean_a, y = b.values[i] - mean_b;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  return ab / std::sqrt(aa * bb);
}

Image turned(const Image& image, bool in_x, bool in_y) {
  Image out = image;
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) out(j, i) = image(in_y ? image.ny - 1 - j : j, in_x ? image.nx - 1 - i : i);
  return out;
}

class Reconstruction : public testing::TestWithParam<const char*> {};

// The letter F, white on black, which has no symmetry.
TEST_P(Reconstruction, OfATexturedQuadIsItsRender) {
  const std::vector<std::string> letter{"........", ".#####..", ".#......", ".#......",
                                        ".####...", ".#......", ".#......", "........"};
  Image texture(8, 8, 1);
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) texture(j, i) = letter[size_t(j)][size_t(i)] == '#' ? 1.0F : 0.0F;
  const Workplace work;
  save_image(work.path("letter.png"), texture, 1, 8);
  // A uniform sky lights the quad: its radiance is its texture, without noise.
  work.write("scene.toml",
             scene_head(small_panel, "background = 1\n") +
                 "[trace]\ncolumns = 160\nrows = 160\npaths = 1\n"
                 "[render]\ncolumns = 256\nrows = 256\nfield_of_view = \"1.90546 deg\"\npaths = 16\n"  // the acceptance
                 "[materials.letter]\ntexture = \"letter.png\"\n"
                 "[[object]]\ntype = \"quad\"\nwidth = \"2.2 mm\"\nheight = \"2.2 mm\"\n"
                 "position = \"0 0 -30 mm\"\nmaterial = \"letter\"\n");
  expect_success(work, {"render", "scene.toml", "-o", "render.exr"});
  expect_success(work, {"field", "scene.toml", "-o", "f.npy"});
  expect_success(work, {"encode", "f.npy", "-o", "h.png", "--image", GetParam()});
  expect_success(work, {"show", "h.png", "-o", "view.exr", "--distance", "30 mm", "--binning", "8"});
  Image view = load_image(work.path("view.exr"));
  view.pitch = 8 * small_panel.pitch;
  const Image render = load_image(work.path("render.exr"));
  const Image reference = project_render(seen_at(render, {test_wavelength}),
                                         acceptance_tangent(test_wavelength, small_panel.pitch), view, 0.03);
  // 64 pixels of speckle of contrast 1 in a bin: the correlation with a black-and-white picture is at most
  // 1/√(1 + 2/64) = 0.985. A kinoform loses the modulus of the field; about 1 − π/4 of the light becomes noise.
  const double upright = correlation(reference, view);
  EXPECT_GT(upright, 0.8);
  EXPECT_LT(correlation(reference, turned(view, true, false)), upright - 0.3);
  EXPECT_LT(correlation(reference, turned(view, false, true)), upright - 0.3);
  EXPECT_LT(correlation(reference, turned(view, true, true)), upright - 0.3);
}

INSTANTIATE_TEST_SUITE_P(Images, Reconstruction, testing::Values("virtual", "real"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace holotrace::test
