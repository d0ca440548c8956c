#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "holotrace/trace/exposed_scene.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/trace/render.h"
#include "trace/scenes.h"

// Motion blur: pictures of a scene while a shutter is open.

namespace holotrace {
namespace {

const Grid shutter_panel{32, 24, 8e-6};

// The moments of an exposure: scene_at(t) at the middles of equal parts of 0 ≤ t ≤ 1.
template <class SceneAt>
std::vector<Moment> moments_of(int count, const SceneAt& scene_at) {
  std::vector<Moment> moments;
  for (int k = 0; k < count; ++k) moments.push_back({std::make_shared<Scene>(scene_at((k + 0.5) / count)), {}});
  return moments;
}

// A luminous rectangle, 4 mm wide, before black.
Scene bright_rectangle(double x, double depth) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_test_quad({x, 0, -depth}, {2_mm, 0, 0}, {0, 10_mm, 0})};
  return scene;
}

// The part of the time during which an edge that moves from a to b has passed the places of a pixel, in the mean.
double passed(double a, double b, double low, double high) {
  constexpr int places = 256;
  double sum = 0;
  for (int i = 0; i < places; ++i) sum += std::clamp((low + (high - low) * (i + 0.5) / places - a) / (b - a), 0.0, 1.0);
  return sum / places;
}

// An edge from a to b on the left and one 4 mm from it on the right make ramps of the width of the motion. There are N moments: a
// place sees an edge pass up to 1/2N of the time too early or too late. Times of paths are stratified: their error is below 1/P.
void expect_ramps(const Image& picture, double a, double b, double pixel, int moments, int paths) {
  const double error = 0.5 / moments + 1.0 / paths;
  for (int i = 0; i < picture.nx; ++i) {
    const double low = (i - picture.nx / 2.0) * pixel, high = low + pixel;
    const double width = 4_mm;
    EXPECT_NEAR(picture(0, i, 0), passed(a, b, low, high) - passed(a + width, b + width, low, high), error) << i;
  }
}

TEST(Shutter, AnEdgeThatMovesIsALinearRamp) {
  const int count = 32, paths = 256;
  const auto moments = moments_of(count, [](double t) { return bright_rectangle(-1_mm + t * 3_mm, 0.3); });
  const RenderParams params{
      .columns = 40, .rows = 1, .field_of_view = std::atan(0.15_mm / 0.3), .focus = 0.3, .paths = paths};
  expect_ramps(render(SceneExposure(moments), shutter_panel, green_light, params), -3_mm, 0, 0.3_mm, count, paths);
}

// Seen from x, a place at half the distance of the plane in focus is at X = 2·place − x there: its edges move by −1 each.
TEST(Shutter, AnEyeThatMovesBlursWhatIsNotInFocus) {
  const int count = 32, paths = 256;
  const Scene scene = bright_rectangle(0, 0.15);
  const auto shared = std::make_shared<Scene>(scene);
  std::vector<Moment> moments;
  for (int k = 0; k < count; ++k) moments.push_back({shared, {-3_mm * (k + 0.5) / count, 0, 0}});
  const RenderParams params{
      .columns = 40, .rows = 1, .field_of_view = std::atan(0.15_mm / 0.3), .focus = 0.3, .paths = paths};
  const Image picture = render(SceneExposure(moments), shutter_panel, green_light, params);
  const double error = 0.5 / count + 1.0 / paths;
  for (int i = 0; i < picture.nx; ++i) {
    const double low = (i - 20) * 0.3_mm, high = low + 0.3_mm;
    EXPECT_NEAR(picture(0, i, 0), passed(-4_mm, -1_mm, low, high) - passed(4_mm, 7_mm, low, high), error) << i;
  }
}

// A white wall in the light of a small lamp that moves by, with a block before it that moves the other way.
Scene lit_wall(double t) {
  Scene scene;
  scene.materials = {grey(0.8), grey(0.3)};
  scene.meshes = {make_wall(-0.04, 1_mm, 1_mm),
                  make_test_quad({0.05_mm - t * 0.1_mm, 0, -0.035}, {0.04_mm, 0, 0}, {0, 0.04_mm, 0}, 1)};
  scene.lights = {RectangleLight{{-0.01 + 0.02 * t, 0.005, -0.02}, {0, 0.002, 0}, {0.002, 0, 0}, {50, 50, 50}}};
  return scene;
}

// Compares pictures of an exposure, of several seeds, with the mean of stills at its moments. The mean square of differences over
// their standard errors is that of Student's t with (seeds − 1) degrees of freedom, ν/(ν − 2) = 1.4 for 8 seeds; the sum of all differences has
// a standard error, too.
void expect_mean_of_stills(const std::vector<Image>& exposed, const std::vector<Image>& stills) {
  const size_t values = stills.front().values.size();
  double squares = 0, sum = 0, variance_of_sum = 0;
  size_t count = 0;
  for (size_t v = 0; v < values; v += 3) {
    double truth = 0, mean = 0, variance = 0;
    for (const Image& still : stills) truth += still.values[v] / double(stills.size());
    for (const Image& one : exposed) mean += one.values[v] / double(exposed.size());
    for (const Image& one : exposed) variance += std::pow(one.values[v] - mean, 2) / double(exposed.size() - 1);
    variance /= double(exposed.size());
    if (!(variance > 0)) continue;
    squares += (mean - truth) * (mean - truth) / variance;
    sum += mean - truth;
    variance_of_sum += variance;
    ++count;
  }
  ASSERT_GT(count, 300u);
  // 300 values or more of t² with 7 degrees of freedom, whose variance is 9.8: 4 standard errors are 0.7.
  EXPECT_LT(squares / double(count), 1.4 + 0.7);
  EXPECT_LT(std::abs(sum), 4 * std::sqrt(variance_of_sum));
}

constexpr int seeds = 8, stills = 64;

TEST(Shutter, ARenderIsTheMeanOf64Stills) {
  const auto moments = moments_of(32, lit_wall);
  RenderParams params{
      .columns = 24, .rows = 20, .field_of_view = std::atan(0.13_mm / 0.04), .focus = 0.04, .paths = 16};
  std::vector<Image> exposed, each;
  for (params.seed = 1; params.seed <= seeds; ++params.seed)
    exposed.push_back(render(SceneExposure(moments), shutter_panel, green_light, params));
  params.paths = 128;
  for (int k = 0; k < stills; ++k, ++params.seed)
    each.push_back(render(lit_wall((k + 0.5) / stills), shutter_panel, green_light, params));
  expect_mean_of_stills(exposed, each);
}

TEST(Shutter, AFocalStackIsTheMeanOf64Stills) {
  const auto moments = moments_of(32, lit_wall);
  RenderParams params{.paths = 8};
  const std::vector<double> distances{0.04, 0.036};
  std::vector<Image> exposed, each;
  for (params.seed = 1; params.seed <= seeds; ++params.seed)
    exposed.push_back(
        trace_focal_stack(SceneExposure(moments), shutter_panel, green_light, distances, params).pictures[1]);
  params.paths = 64;
  for (int k = 0; k < stills; ++k, ++params.seed)
    each.push_back(
        trace_focal_stack(lit_wall((k + 0.5) / stills), shutter_panel, green_light, distances, params).pictures[1]);
  expect_mean_of_stills(exposed, each);
}

// With fewer paths than moments, pixels take different ones.
TEST(Shutter, EachPathHasAMomentAndEachMomentItsShareOfThePaths) {
  for (const int paths : {1, 3, 16, 50}) {
    const size_t count = 12, pixels = 4000;
    std::vector<int> of_moment(count, 0);
    for (uint64_t pixel = 0; pixel < pixels; ++pixel) {
      int next = 0;
      for (size_t m = 0; m < count; ++m) {
        const PathRange range = paths_of_moment(m, count, paths, 7, pixel);
        ASSERT_EQ(range.first, next);
        next = range.last;
        of_moment[m] += range.last - range.first;
      }
      ASSERT_EQ(next, paths);
    }
    // A count of 0 or 1 in a pixel beside a fixed one has a variance of at most 1/4.
    for (const int found : of_moment)
      EXPECT_NEAR(found, double(paths) * pixels / double(count), 4 * std::sqrt(pixels / 4.0)) << paths;
  }
}

// A luminous point that moves over two pixels gives each half of its light.
TEST(Shutter, ALuminousPointSharesItsLight) {
  const auto at = [](double x) {
    Scene scene;
    scene.points = {{{x, 0, -0.3}, 1, 0}};
    return std::make_shared<Scene>(scene);
  };
  const RenderParams params{
      .columns = 4, .rows = 1, .field_of_view = std::atan(0.5_mm / 0.3), .focus = 0.3, .paths = 1};
  const double still = render(*at(-0.5_mm), shutter_panel, green_light, params)(0, 1, 0);
  const Image moved = render(SceneExposure({{at(-0.5_mm), {}}, {at(0.5_mm), {}}}), shutter_panel, green_light, params);
  EXPECT_GT(still, 0);
  for (const int column : {1, 2}) EXPECT_NEAR(moved(0, column, 0), still / 2, 1e-6 * still) << "rounding of floats";
}

}  // namespace
}  // namespace holotrace
