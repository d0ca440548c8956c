#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "holotrace/data/acceptance.h"
#include "holotrace/data/job.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/shared/texture.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const Grid render_panel{256, 192, 8e-6};

TEST(Texture, BilinearBetweenPixelCentresWithVUpAndRepeat) {
  Image image(2, 2, 1);
  image(0, 0) = 1, image(0, 1) = 2, image(1, 0) = 3, image(1, 1) = 4;
  const auto value = [&](double u, double v) { return eval_texture(image, {u, v}).x; };
  // Small integers and halves: exact in double.
  EXPECT_EQ(value(0.25, 0.75), 1) << "row 0 is the top, v = 1";
  EXPECT_EQ(value(0.75, 0.75), 2);
  EXPECT_EQ(value(0.25, 0.25), 3);
  EXPECT_EQ(value(0.75, 0.25), 4);
  EXPECT_EQ(value(0.5, 0.5), 2.5);
  EXPECT_EQ(value(1.25, -0.25), 1) << "one image further";
  EXPECT_EQ(value(-0.25, 1.25), 4);
  EXPECT_EQ(value(0, 0.75), 1.5) << "left of the first centre comes the last column again";
  EXPECT_EQ(value(-1e-17, 0.75), 1.5) << "a rounding below 0";
  image.sampling = {ImageEdge::mirror, ImageEdge::clamp};
  EXPECT_EQ(value(0, 0.75), 1) << "left of the first centre comes the first column again";
  EXPECT_EQ(value(-0.25, 0.75), 1);
  EXPECT_EQ(value(1.25, 0.75), 2);
  EXPECT_EQ(value(2.25, 0.75), 1) << "two images further nothing has changed";
  EXPECT_EQ(value(0.25, 7), 1) << "above, the top row goes on";
  EXPECT_EQ(value(0.25, -7), 3);
  image.sampling = {ImageEdge::repeat, ImageEdge::repeat, true};
  for (const double u : {0.01, 0.49}) EXPECT_EQ(value(u, 0.99), 1) << "an even pixel";
  EXPECT_EQ(value(0.51, 0.49), 4);
  EXPECT_EQ(value(0.25, 0), 3) << "v = 0 is the lower border of the bottom row";
  EXPECT_EQ(value(-1e-17, 0.75), 2) << "a rounding below 0 is the right border of the last column";
}

// Values beside an image of one pixel, one row or one column would be found if it were read outside.
TEST(Texture, SmallImagesAreReadInsideOnly) {
  for (const auto& [rows, columns] : {std::pair{1, 1}, {1, 3}, {3, 1}}) {
    Image image(rows, columns, 1);
    std::fill(image.values.begin(), image.values.end(), 7.0f);
    for (const ImageEdge edge : {ImageEdge::repeat, ImageEdge::mirror, ImageEdge::clamp})
      for (const bool is_stepped : {false, true})
        for (const double u : {0.0, -1e-17, 0.3, 1.0, 1 - 1e-16, -2.0})
          for (const double v : {0.0, -1e-17, 0.3, 1.0, 1 - 1e-16, -2.0}) {
            image.sampling = {edge, edge, is_stepped};
            between_texels(image, {u, v}, [&](int row, int column) {
              EXPECT_TRUE(row >= 0 && row < rows && column >= 0 && column < columns)
                  << row << ", " << column << " of " << rows << " x " << columns << " at " << u << ", " << v;
              return 0.0;
            });
            EXPECT_NEAR(eval_texture(image, {u, v}).x, 7, 1e-14);
          }
  }
}

// Moments share equal pictures with the scene at the start (open_shutter); one that is sampled otherwise is another picture.
TEST(Texture, MomentsOfAShutterKeepTheSamplingOfTheirPictures) {
  const auto at = [](double time) {
    Image image(2, 2, 1);
    image.sampling.is_stepped = time > 0.5;
    Material paper{DiffuseMaterial{}};
    std::get<DiffuseMaterial>(paper.surface).texture = std::make_shared<Image>(image);
    Job job;
    job.last_key = 1;
    job.scene.materials = {paper};
    return job;
  };
  const Job job = open_shutter(at(0), 1, at);
  ASSERT_FALSE(job.moments.empty());
  const auto texture = [](const Scene& scene) { return std::get<DiffuseMaterial>(scene.materials[0].surface).texture; };
  EXPECT_EQ(texture(*job.moments.front().scene), texture(job.scene));
  EXPECT_TRUE(texture(*job.moments.back().scene)->sampling.is_stepped);
}

TEST(Render, TexturesStandUpright) {
  auto texture = std::make_shared<Image>(2, 2, 3);
  for (int channel = 0; channel < 3; ++channel)
    (*texture)(0, channel == 0 ? 0 : 1, channel) = 1;  // red, cyan / black, black
  Scene scene;
  scene.materials = {DiffuseMaterial{{1, 1, 1}, texture, {}}};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.background = {1, 1, 1};
  const RenderParams params{.columns = 10, .rows = 10, .field_of_view = std::atan(10.0 / 300), .paths = 1024};
  const Image image = render(scene, render_panel, green_light, params);
  // Pixels 2 and 7 are at the centres of texels and span a fifth of one: bilinear weights of 0.95 per axis, on
  // average. Under a white sky the radiance is the albedo, and a path gives 0 or 1: 4 standard errors are at most
  // 4·½/√1024.
  const double pure = 0.95 * 0.95, beside = 0.05 * 0.95, error = 2 / std::sqrt(1024);
  EXPECT_NEAR(image(2, 2, 0), pure, error);
  EXPECT_NEAR(image(2, 2, 1), beside, error);
  EXPECT_NEAR(image(2, 7, 0), beside, error);
  EXPECT_NEAR(image(2, 7, 1), pure, error);
  EXPECT_NEAR(image(7, 2, 0), beside, error);
  EXPECT_NEAR(image(7, 7, 1), beside, error);
}

TEST(Render, APictureOfAnEmissiveWallIsItsRadianceAndBesideItTheBackground) {
  Scene scene;
  scene.materials = {Material{DiffuseMaterial{{0, 0, 0}}, {1, 2, 3}}};
  scene.meshes = {make_test_quad({-5_mm, 0, -0.3}, {5_mm, 0, 0}, {0, 20_mm, 0})};
  scene.background = {0.5, 0.25, 0.125};
  Record record;
  const RenderParams params{.columns = 0, .rows = 10, .paths = 9};
  const Image image = render(scene, render_panel, green_light, params, record.observer);
  ASSERT_EQ(image.nx, 10);
  ASSERT_EQ(image.ny, 10);
  ASSERT_EQ(image.channels, 3);
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 10; ++column)
      for (int channel = 0; channel < 3; ++channel) {
        // The wall ends on the axis, between pixels; its left end is outside the 1.9° of the view. Sums of a few
        // small numbers over 9, to float rounding.
        const double expected = column < 5 ? channel + 1 : 0.5 / (1 << channel);
        EXPECT_FLOAT_EQ(image(row, column, channel), float(expected));
      }
  EXPECT_EQ(record.count("paths"), 9 * 50);
  EXPECT_EQ(record.count("rays"), 9 * 100);
}

TEST(Render, EdgesAreAntialiased) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_test_quad({-10_mm, 0, -0.1}, {10_mm, 0, 0}, {0, 20_mm, 0})};  // its edge halves the only pixel
  const Image image = render(scene, render_panel, green_light, {.columns = 1, .rows = 1, .paths = 1024});
  // 32 × 32 strata, with the edge between strata.
  EXPECT_NEAR(image(0, 0), 0.5, 1e-6);
}

TEST(Render, APointAtAKnownPlaceLandsInItsPixel) {
  const double t = std::tan(10_deg);
  for (const auto& [x, y, row, column] : {std::tuple{0.0, 0.0, 10, 20}, {-1.0, 0.25, 5, 0}, {0.95, -0.25, 15, 39}}) {
    // 40 × 20 pixels: x/depth from −2T to 2T, y/depth from T down to −T. The point is at the middle of a pixel.
    Scene scene;
    const double depth = 0.25, half = 0.05;
    scene.points = {{{(2 * x + half) * t * depth, (2 * y - half) * t * depth, -depth}, 3.0f, 0}};
    const RenderParams params{.columns = 40, .rows = 20, .field_of_view = 10_deg, .paths = 1};
    const Image image = render(scene, render_panel, green_light, params);
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 40; ++i)  // 1e-6: rounding of the place moves a little light
        EXPECT_EQ(image(j, i) > 1e-6 * image(row, column), j == row && i == column) << j << " " << i;
  }
}

// A direction of n pixels to the right and m up moves everything as far to the left and down, for an eye anywhere: the window is in the
// plane in focus, in which the wall is. Its left and lower edges are between pixels, so nothing is random.
TEST(Render, AzimuthAndElevationMoveTheWindow) {
  const double t = std::tan(10_deg), pixel = t / 10;  // 20 rows
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_test_quad({2 * pixel * 0.3 + 1, 1 * pixel * 0.3 + 1, -0.3}, {1, 0, 0}, {0, 1, 0})};
  RenderParams params{.columns = 20, .rows = 20, .field_of_view = 10_deg, .focus = 0.3, .paths = 4};
  for (const Vec3 eye : {Vec3{}, Vec3{1_mm, -2_mm, 0.1}}) {
    params.eye = eye;
    params.azimuth = std::atan(5 * pixel);
    params.elevation = std::atan(-3 * pixel);
    scene.points = {{{(8 + 0.5) * pixel * 0.3, (-9 + 0.5) * pixel * 0.3, -0.3}, 1.0F, 0}};
    const Image image = render(scene, render_panel, green_light, params);
    // The wall begins at 2 and 1 pixels, the window at 5 − 10 and −3 + 10; the point's pixel is (8, −9).
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 20; ++i) {  // 1e-6: rounding of the place moves a little light
        const bool is_point = j == 7 + 8 && i == 8 + 5;
        EXPECT_EQ(image(j, i) > 1e-6 * image(15, 13), is_point || (i >= 2 + 5 && j < 7 - 1)) << j << " " << i;
      }
  }
}

TEST(Render, APointBetweenPixelsSharesItsLight) {
  Scene scene;
  const double pixel = std::tan(10_deg) / 10 * 0.25;  // 20 rows span 2T
  scene.points = {{{0.25 * pixel, 0.5 * pixel, -0.25}, 1.0f, 0}};
  const RenderParams params{.columns = 20, .rows = 20, .field_of_view = 10_deg, .paths = 1};
  const Image image = render(scene, render_panel, green_light, params);
  // The corner of four pixels is on the axis: 3/4 of a pixel to the right of the left one's middle, at a row's middle.
  EXPECT_NEAR(image(9, 10) / image(9, 9), 3, 1e-5);
  EXPECT_LT(image(10, 10) / image(9, 10), 1e-5);
}

TEST(Render, APointHasTheLightOfACellWithItsAmplitude) {
  Scene scene;
  scene.points = {{{10_mm, -7_mm, -0.2}, 3.0f, 0}};
  const RenderParams params{.columns = 16, .rows = 16, .field_of_view = 10_deg, .paths = 1};
  const Image image = render(scene, render_panel, green_light, params);
  double sum = 0;
  for (float value : image.values) sum += value;
  // a²·cos²θ = L·dA·cos⁴θ at the panel's centre, where a² is 9 W/m²/sr times λ²/(W·H); floats.
  const double side = 2 * std::tan(10_deg) / 16, squared = 0.2 * 0.2 / (0.2 * 0.2 + 1e-4 + 0.49e-4);
  const double solid_angle = green_light * green_light / (render_panel.width() * render_panel.height());
  EXPECT_NEAR(sum / 3 / (9 * solid_angle / (side * side * squared)), 1, 1e-6);
}

TEST(Render, MeshesHidePointsBehindThemAndNotBeforeThem) {
  Scene scene;
  scene.materials = {grey(0)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  const RenderParams params{.columns = 1, .rows = 1, .paths = 1};
  scene.points = {{{0, 0, -0.31}, 1.0f, 0}};
  EXPECT_EQ(render(scene, render_panel, green_light, params)(0, 0), 0);
  for (double z : {-0.29, -0.3}) {
    scene.points = {{{0, 0, z}, 1.0f, 0}};
    EXPECT_GT(render(scene, render_panel, green_light, params)(0, 0), 0);
  }
}

TEST(Render, ThePictureAndTheWavesHoldTheSameLight) {
  Scene scene;
  scene.materials = {grey(0.7), DiffuseMaterial{{0.9, 0.5, 0.2}, nullptr, {}}};
  scene.meshes = {make_wall(-0.3, 12_mm, 12_mm), make_test_quad({0, -6_mm, -0.29}, {12_mm, 0, 0}, {0, 2_mm, 10_mm}, 1)};
  scene.lights = {RectangleLight{{-5_mm, 15_mm, -0.29}, {10_mm, 0, 0}, {0, 0, 10_mm}, {40, 40, 40}}};
  const int side = 32;
  const double pixel = 2 * acceptance_tangent(green_light, render_panel.pitch) / side;
  Statistics difference, radiance;
  for (int64_t seed = 1; seed <= 10; ++seed) {
    const Image image = render(scene, render_panel, green_light, {.rows = side, .paths = 16, .seed = seed});
    const TraceParams params{.columns = side, .rows = side, .paths = 16, .seed = seed + 100};
    const Sources sources = trace(scene, render_panel, green_light, params);
    double picture = 0, waves = 0;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) picture += image(j, i, 1) / double(side * side);
    for (const Source& wave : sources.waves) {
      const double cosine = -wave.origin.z / length(wave.origin);
      waves += double(wave.amplitude) * wave.amplitude / (pixel * pixel * cosine * cosine) / (side * side);
    }
    difference.add(waves - picture);
    radiance.add(picture);
  }
  // 4 standard errors of ten pairs, plus the raster's centres compared with pixel means: an edge off by up to half a
  // row in 32.
  EXPECT_NEAR(difference.mean(), 0, 4 * difference.standard_error() + 0.5 / side * radiance.mean());
  EXPECT_GT(radiance.mean(), 0.1);
}

TEST(Render, ThroughAPinholeOnTheAxisTheFocusDoesNotMatter) {
  Scene scene;
  scene.materials = {grey(0.7, 0.5)};
  scene.meshes = {make_wall(-0.3, 3_mm, 3_mm)};
  scene.background = {0.2, 0.2, 0.2};
  EXPECT_EQ(render(scene, render_panel, green_light, {.rows = 16, .focus = 0.2, .paths = 4}).values,
            render(scene, render_panel, green_light, {.rows = 16, .focus = 0.5, .paths = 4}).values);
}

/// An emitting wall at that depth, left of the axis.
Scene half_plane(double depth) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_test_quad({-50_mm, 0, -depth}, {50_mm, 0, 0}, {0, 50_mm, 0})};
  return scene;
}

TEST(Render, ARoundLensBlursAnEdgeToTheDiscOfGeometry) {
  // In the plane in focus f, an edge at depth d = 2f is blurred over a disc of diameter pupil·|d − f|/d = 2 mm.
  const double focus = 0.2, radius = 1_mm, half = 2_mm;  // of the disc; of the window
  const RenderParams params{.columns = 20,
                            .rows = 20,
                            .field_of_view = std::atan(half / focus),
                            .lens = Lens::round,
                            .pupil = 4_mm,
                            .focus = focus,
                            .paths = 1024};
  const Image image = render(half_plane(2 * focus), render_panel, green_light, params);
  // The share of a disc left of the chord at s radii is acos(s)/π − s√(1−s²)/π; a pixel of 0.2 mm is the mean over it.
  const auto share = [](double s) {
    return s <= -1 ? 1.0 : s >= 1 ? 0.0 : (std::acos(s) - s * std::sqrt(1 - s * s)) / pi;
  };
  for (int column = 0; column < 20; ++column) {
    double expected = 0;
    for (int i = 0; i < 100; ++i) expected += share(((column + (i + 0.5) / 100) / 20 * 2 - 1) * half / radius) / 100;
    // 1024 paths of 0 or 1 in each of 20 rows, at least as good as independent ones: 4 standard errors of their mean.
    double mean = 0;
    for (int row = 0; row < 20; ++row) mean += image(row, column) / 20;
    EXPECT_NEAR(mean, expected, 4 * std::sqrt(std::abs(expected * (1 - expected)) / (20 * 1024)) + 1e-5) << column;
  }
  const Image sharp = render(half_plane(focus), render_panel, green_light, params);
  for (int row = 0; row < 20; ++row)
    for (int column = 0; column < 20; ++column)
      EXPECT_NEAR(sharp(row, column), column < 10 ? 1 : 0, 2.0 / 1024)
          << "in focus the edge falls between pixels; a path or two may fall on it, within Embree's rounding";
}

TEST(Render, ThePanelAsALensBlursByItsOwnWidth) {
  // 256 pixels of 8 µm: 2.048 mm wide. At f = 0.2 m its boxes extend 6.7 mm, so all of it lights the whole window. An
  // edge at depth 2f is blurred evenly over a width of 2.048 mm·|d − f|/d.
  const double focus = 0.2, width = render_panel.width() / 2, half = 2_mm;
  const RenderParams params{.columns = 20,
                            .rows = 20,
                            .field_of_view = std::atan(half / focus),
                            .lens = Lens::panel,
                            .focus = focus,
                            .paths = 1024};
  const Image image = render(half_plane(2 * focus), render_panel, green_light, params);
  for (int column = 0; column < 20; ++column) {
    double expected = 0, mean = 0;
    for (int i = 0; i < 100; ++i)
      expected += std::clamp(0.5 - ((column + (i + 0.5) / 100) / 20 * 2 - 1) * half / width, 0.0, 1.0) / 100;
    for (int row = 0; row < 20; ++row) mean += image(row, column) / 20;
    EXPECT_NEAR(mean, expected, 4 * std::sqrt(std::abs(expected * (1 - expected)) / (20 * 1024)) + 1e-4) << column;
  }
}

TEST(Render, ThePanelAsALensIsBlackWhereNoneOfItsPixelsSendsLight) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_wall(-0.2, 50_mm, 50_mm)};
  const double focus = 0.2, tangent = acceptance_tangent(green_light, render_panel.pitch);
  const double limit = render_panel.width() / 2 + focus * tangent, half = 2 * limit;  // of the light; of the window
  const RenderParams params{.columns = 40,
                            .rows = 1,
                            .field_of_view = std::atan(half / 40 / focus),
                            .lens = Lens::panel,
                            .focus = focus,
                            .paths = 16};
  const Image image = render(scene, render_panel, green_light, params);
  for (int column = 0; column < 40; ++column)
    EXPECT_NEAR(image(0, column), column >= 10 && column < 30 ? 1 : 0, 1e-6) << column;
}

TEST(Render, AnEyeOffTheAxisSeesParallax) {
  // A square of 1 mm at P, seen from e, appears at X = e + (P − e)·(e_z + f)/(e_z + d) in the plane in focus.
  const Vec3 at{1_mm, -0.5_mm, -0.4}, eye{2_mm, 1_mm, 0.3};
  const double focus = 0.2, half = 4_mm;
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_test_quad(at, {0.5_mm, 0, 0}, {0, 0.5_mm, 0})};
  for (const Lens lens : {Lens::pinhole, Lens::round}) {
    const RenderParams params{.columns = 40,
                              .rows = 40,
                              .field_of_view = std::atan(half / focus),
                              .eye = eye,
                              .lens = lens,
                              .pupil = 1_mm,
                              .focus = focus,
                              .paths = 256};
    const Image image = render(scene, render_panel, green_light, params);
    double sum = 0, x = 0, y = 0;
    for (int row = 0; row < 40; ++row)
      for (int column = 0; column < 40; ++column) {
        sum += image(row, column);
        x += image(row, column) * ((column + 0.5) / 20 - 1) * half;
        y += image(row, column) * (1 - (row + 0.5) / 20) * half;
      }
    const double scale = (0.3 + focus) / (0.3 + 0.4);
    // Pixels are 0.2 mm and the square covers 13 of them. Some 10 are cut, 1.8 from its middle; their share is known to
    // ½/√256: 0.5/16·√10·1.8/13 of a pixel, times four.
    EXPECT_NEAR(x / sum, eye.x + (at.x - eye.x) * scale, 0.06 * 0.2_mm);
    EXPECT_NEAR(y / sum, eye.y + (at.y - eye.y) * scale, 0.06 * 0.2_mm);
    EXPECT_NEAR(sum * 0.2_mm * 0.2_mm / (scale * scale * 1e-6), 1, 0.03) << "and has its size";
  }
}

TEST(Render, APointIsWhereTheEyeSeesItWithTheIrradianceOfItsWave) {
  Scene scene;
  scene.points = {{{1_mm, -0.5_mm, -0.4}, 2.0F, 0}};
  const Vec3 eye{2_mm, 1_mm, 0.3};
  const double focus = 0.2, half = 4_mm;
  const Image image = render(
      scene, render_panel, green_light,
      {.columns = 40, .rows = 40, .field_of_view = std::atan(half / focus), .eye = eye, .focus = focus, .paths = 1});
  double sum = 0, x = 0;
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 40; ++column) {
      sum += image(row, column);
      x += image(row, column) * ((column + 0.5) / 20 - 1) * half;
    }
  EXPECT_NEAR(x / sum, eye.x + (1_mm - eye.x) * 0.5 / 0.7, 1e-8);  // floats
  // A pixel of 0.2 mm at 0.5 m before the eye, under cosθ, is dΩ·cosθ = (0.2 mm/0.5 m)²·cos⁴θ.
  const double squared = 1e-6 + 1.5_mm * 1.5_mm + 0.49, cosine = 0.7 / std::sqrt(squared);
  const double solid_angle = green_light * green_light / (render_panel.width() * render_panel.height());
  EXPECT_NEAR(sum * std::pow(0.2e-3 / 0.5, 2) * std::pow(cosine, 4) / (4 * solid_angle * 0.16 / squared), 1, 1e-6);
}

TEST(Render, PathGroupsLeaveOutTheBackgroundToo) {
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_test_quad({-50_mm, 0, -0.3}, {50_mm, 0, 0}, {0, 50_mm, 0})};
  scene.background = {1, 1, 1};
  const auto picture = [&](const std::vector<std::string>& path_groups) {
    return render(scene, render_panel, green_light,
                  {.columns = 2, .rows = 1, .paths = 256, .path_expressions = path_groups});
  };
  EXPECT_EQ(picture({"EDL"})(0, 1), 0);
  EXPECT_EQ(picture({"EL"})(0, 0), 0);
  EXPECT_EQ(picture({"EL"})(0, 1), 1);
  const Image all = picture({}), parts = picture({"EL", "ED+L"});
  for (int column : {0, 1}) EXPECT_NEAR(parts(0, column), all(0, column), 1e-6);
}

TEST(Render, TheSamePictureComesFromAnyNumberOfThreads) {
  Scene scene;
  scene.materials = {grey(0.7)};
  scene.meshes = {make_wall(-0.3, 12_mm, 12_mm), make_test_quad({0, -6_mm, -0.29}, {12_mm, 0, 0}, {0, 2_mm, 10_mm})};
  scene.materials[0].emission = {0.1, 0.1, 0.1};
  scene.lights = {PointLight{{5_mm, 15_mm, -0.28}, {1, 1, 1}},
                  RectangleLight{{-5_mm, 15_mm, -0.29}, {10_mm, 0, 0}, {0, 0, 10_mm}, {4, 4, 4}}};
  auto map = std::make_shared<Image>(2, 4, 1);
  for (float& value : map->values) value = 1;
  scene.environment = {map, {1, 1, 1}, 0};
  std::vector<Image> images;
  for (size_t threads : {1, 2, 7}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    // A thread that has finished its first rows waits for another one to do some (a minute at most), so that every
    // picture is the work of as many threads as stated, at least two.
    std::mutex mutex;
    std::condition_variable another;
    std::set<std::thread::id> workers;
    Observer observer;
    observer.on_progress = [&](double) {
      std::unique_lock lock(mutex);
      workers.insert(std::this_thread::get_id());
      another.notify_all();
      another.wait_for(lock, std::chrono::minutes(1), [&] { return workers.size() >= std::min<size_t>(threads, 2); });
    };
    images.push_back(render(scene, render_panel, green_light, {.rows = 32, .paths = 4}, observer));
    EXPECT_GE(workers.size(), std::min<size_t>(threads, 2));
  }
  EXPECT_EQ(images[0].values, images[1].values);
  EXPECT_EQ(images[0].values, images[2].values);
}

TEST(RenderPixels, AreThoseOfTheWholePictureAndTheOthersStay) {
  Scene scene;
  scene.materials = {DiffuseMaterial{}};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.background = {1, 1, 1};
  scene.points = {{{1_mm, 2_mm, -0.2}, 1}};
  RenderParams params{.columns = 12, .rows = 8, .field_of_view = std::atan(10.0 / 300), .paths = 8};
  const Image whole = render(scene, render_panel, green_light, params);
  PixelMask mask(96, 0);
  for (size_t i = 0; i < mask.size(); i += 5) mask[i] = 1;
  Image image(8, 12, 3);
  std::fill(image.values.begin(), image.values.end(), 7.0F);
  render_pixels(scene, render_panel, green_light, params, mask, image);
  for (size_t i = 0; i < image.values.size(); ++i)
    EXPECT_EQ(image.values[i], mask[i / 3] ? whole.values[i] : 7.0F) << "value " << i;
  EXPECT_THROW(render_pixels(scene, render_panel, green_light, params, PixelMask(95), image), Error);
  params.rows = 9;
  EXPECT_THROW(render_pixels(scene, render_panel, green_light, params, mask, image), Error);
}

TEST(Render, ParametersOutOfRangeAreErrorsThatSayWhatWasExpected) {
  Scene scene;
  scene.points = {{{0, 0, -0.3}, 1.0f, 0}};
  const auto sentence = [&](const RenderParams& params) {
    return error_of([&] { render(scene, render_panel, green_light, params); });
  };
  EXPECT_EQ(sentence({.rows = 0}), "expected a whole number of 1 or more for \"rows\", got 0");
  EXPECT_EQ(sentence({.paths = -1}), "expected a whole number of 0 or more for \"paths\", got -1");
  EXPECT_EQ(sentence({.max_depth = 0}), "expected a whole number of 1 or more for \"max_depth\", got 0");
  EXPECT_EQ(sentence({.eye = {0, 0, -0.1}}), "expected a length of 0 m or more for z of \"eye\", got -100 mm");
  EXPECT_EQ(sentence({.focus = 0}),
            "expected a plane in focus behind the panel or in front of it, got the panel's own, 0 m");
  EXPECT_EQ(sentence({.lens = Lens::round, .pupil = 0}), "expected a length above 0 m for \"pupil\", got 0 m");
  EXPECT_EQ(sentence({.clamp = -1}), "expected a number of 0 or more for \"clamp\", got -1");
  EXPECT_EQ(sentence({.field_of_view = -0.1}).substr(0, 64),
            "expected an angle from 0 deg to less than 90 deg for \"field_of_v");
}

}  // namespace
}  // namespace holotrace
