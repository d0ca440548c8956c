// Scene → Sources → Field at three wavelengths: a white wall is white up to the border of the view.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "holotrace/base/observer.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/shade_triangles.h"
#include "holotrace/trace/trace.h"
#include "holotrace/view/camera.h"
#include "holotrace/wave/layers/depth_layers.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/triangles/sum_triangles.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const std::vector<double> colours{633e-9, 532e-9, 450e-9};
constexpr double distance = 0.3;
const Grid panel{256, 256, 8e-6};

Scene white_wall() {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_wall(-distance, 50_mm, 50_mm)};
  return scene;
}

/// tan(asin(λ/2p)) of the panel.
double cone_tangent(double wavelength) {
  const double sine = wavelength / (2 * panel.pitch);
  return sine / std::sqrt(1 - sine * sine);
}

constexpr int strip_count = 10;
using Strips = std::array<double, strip_count>;

/// The overlap of a panel's width [m] with a cone of that half-width [m] about x, as a fraction of the panel's width.
double part_seen(double x, double radius, double width) {
  return std::max(0.0, std::min(width / 2, x + radius) - std::max(-width / 2, x - radius)) / width;
}

/// Power that waves bring to the panel from ten strips of the view, from its left border to its right one [W]: what a
/// camera with the whole panel as its pupil sees of them. Strips are as wide as blue sees from the panel's centre.
Strips strips(const Sources& sources) {
  const double half = distance * cone_tangent(450e-9),
               radius = distance * cone_tangent(sources.acceptance_wavelength());
  Strips light{};
  for (const Source& source : sources.waves) {
    const int strip = int(std::floor((source.origin.x / half + 1) * strip_count / 2));
    if (strip < 0 || strip >= strip_count || std::abs(source.origin.y) > half / 10) continue;
    light[size_t(strip)] +=
        double(source.amplitude) * source.amplitude * part_seen(source.origin.x, radius, panel.width());
  }
  return light;
}

/// Ratio of red to blue in the strips.
Strips red_over_blue(const TraceParams& params) {
  const auto sets = trace(white_wall(), panel, colours, params);
  const auto red = strips(sets[0]), blue = strips(sets[2]);
  Strips ratio{};
  for (size_t i = 0; i < 10; ++i) ratio[i] = red[i] / blue[i];
  return ratio;
}

TEST(CommonCone, AWhiteWallIsWhiteUpToTheBorderOfTheView) {
  for (const Pattern pattern : {Pattern::grid, Pattern::random}) {
    TraceParams params{.pattern = pattern, .columns = 100, .rows = 100, .samples = 20000, .paths = 1};
    // All colours have the same rays, cones and solid angles: only the rounding of amplitudes to floats remains.
    for (const double ratio : red_over_blue(params)) EXPECT_NEAR(ratio, 1, 1e-6);
    // With its own cone, red fills boxes 633/450 as wide. At the border, where half of blue's box is on the panel,
    // red covers more of it. At 0.9 of the border, with half the panel 1.02 mm and boxes of 8.44 and 11.88 mm, blue
    // covers 8.44·0.1 + 1.02 of 2.05 mm, red all of it.
    params.has_common_cone = false;
    const auto ratio = red_over_blue(params);
    EXPECT_GT(ratio[0] / ratio[4], 1.05);
    EXPECT_GT(ratio[9] / ratio[5], 1.05);
  }
}

/// Mean irradiance that a camera sees in ten strips of a plane, from fields of several frames. The strips reach to the
/// border of blue's cone.
Strips strips_in_view(const std::vector<Field>& frames, double depth, double height) {
  const double half = depth * cone_tangent(450e-9);
  CameraParams camera;
  camera.width = 2 * half;
  camera.height = height;
  camera.pixel = half / 20;
  Strips light{};
  for (const Field& field : frames) {
    const Image view = look(field, {.grid = field.grid}, depth, {}, camera);
    const int columns = view.nx / strip_count;
    for (int j = 0; j < view.ny; ++j)
      for (int i = 0; i < view.nx; ++i)
        light[size_t(i / columns)] += view(j, i) / double(view.ny * columns) / double(frames.size());
  }
  return light;
}

/// The largest relative difference of two colours between the strips; 1 is their ratio in the middle two.
double unevenness(const Strips& a, const Strips& b) {
  const double middle = (a[4] + a[5]) / (b[4] + b[5]);
  double worst = 0;
  for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] / b[i] / middle - 1));
  return worst;
}

/// Fields of a white object in red, green and blue, each in several frames.
using Fields = std::vector<std::vector<Field>>;

/// A camera that receives all light of the panel sees the white object at `depth`, `height` of it, with the same ratio
/// of all colours, and each as in the closed form: as the part of the panel in the cone about a place. Without the
/// common cone blue ends before red and green.
void expect_white_view(const std::function<Fields(bool has_common_cone)>& fields, double depth, double height,
                       double tolerance, double of_closed_form) {
  const double radius = depth * cone_tangent(450e-9);
  const Fields common = fields(true), own = fields(false);
  ASSERT_EQ(common.size(), 3u);
  std::vector<Strips> views, own_views;
  for (const std::vector<Field>& frames : common) views.push_back(strips_in_view(frames, depth, height));
  for (const std::vector<Field>& frames : own) own_views.push_back(strips_in_view(frames, depth, height));
  EXPECT_LT(unevenness(views[0], views[1]), tolerance) << "red over green";
  EXPECT_LT(unevenness(views[2], views[1]), tolerance) << "blue over green";
  Strips part{};
  for (int i = 0; i < strip_count; ++i)
    for (int k = 0; k < 100; ++k)
      part[size_t(i)] +=
          part_seen(radius * ((i + (k + 0.5) / 100) * 2 / strip_count - 1), radius, common[0][0].grid.width()) / 100;
  for (const Strips& view : views)
    for (size_t i = 0; i < part.size(); ++i)
      EXPECT_NEAR(view[i] / (view[4] + view[5]), part[i] / (part[4] + part[5]), of_closed_form / 2) << i;
  EXPECT_GT(unevenness(own_views[2], own_views[1]), 3 * tolerance);
}

TEST(CommonCone, AWhiteWallOfWavesIsWhiteInTheView) {
  // Waves 0.24 mm apart, 2.6 times what the camera resolves in red, hardly overlap. In a strip of 35 rows and 7
  // columns the interference, about 1/3π in amplitude for neighbours, is 1 % of the light in a frame, 0.5 % in four.
  expect_white_view(
      [](bool has_common_cone) {
        TraceParams params{.columns = 70, .rows = 70, .paths = 1};
        EXPECT_TRUE(params.has_common_cone) << "the default";
        params.has_common_cone = has_common_cone;
        Fields fields;
        for (Sources& set : trace(white_wall(), panel, colours, params)) {
          fields.emplace_back();
          for (int frame = 0; frame < 4; ++frame) {
            set_frame(set, uint32_t(frame));
            fields.back().push_back(synthesize(set, panel, {}));
          }
        }
        return fields;
      },
      distance, 8_mm, 0.03, 0.03);
}

/// Irradiance of the panel by each strip, per area of its triangles: the part of their light that meets the panel.
Strips light_of_strips(const Triangles& set, const Grid& grid) {
  const double half = distance * cone_tangent(450e-9);
  std::array<Triangles, strip_count> strips;
  Strips area{};
  strips.fill(set);
  for (Triangles& strip : strips) strip.triangles.clear(), strip.phase_keys.clear();
  for (const Triangle& t : set.triangles) {
    const int strip = int(std::floor((centroid(t).x / half + 1) * strip_count / 2));
    if (strip < 0 || strip >= strip_count) continue;
    strips[size_t(strip)].triangles.push_back(t);
    area[size_t(strip)] += length(cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0])) / 2;
  }
  Strips light{};
  for (size_t i = 0; i < light.size(); ++i) light[i] = power(sum_triangles(strips[i], grid, 1e-2)) / area[i];
  return light;
}

TEST(CommonCone, AWhiteWallOfTrianglesIsWhiteUpToTheBorder) {
  // A row of squares across the view. Its triangles, 1/64 of the view, send beams of about λz/0.15 mm, 0.9 to 1.3 mm,
  // and the panel of 6.1 × 2 mm receives most of them: in the middle L·Ω with Ω = 6.1 · 2 mm²/z². The light of
  // triangles that do not overlap adds up if the panel receives all of it.
  const Grid wide{768, 256, panel.pitch};
  Scene row;
  row.materials = {grey(0, 1)};
  for (int k = 0; k < 16; ++k)
    row.meshes.push_back(make_test_quad({(k - 7.5) * 1.2_mm, 0, -distance}, {0.6_mm, 0, 0}, {0, 0.6_mm, 0}));
  const auto light_in = [&](bool has_common_cone) {
    TraceParams params{.paths = 1};
    params.has_common_cone = has_common_cone;
    std::vector<Strips> light;
    for (const Triangles& set : shade_triangles(row, wide, colours, params, Shading::flat, TrianglePhase::random))
      light.push_back(light_of_strips(set, wide));
    return light;
  };
  const std::vector<Strips> common = light_in(true), own = light_in(false);
  EXPECT_LT(unevenness(common[0], common[1]), 0.03) << "red over green";
  EXPECT_LT(unevenness(common[2], common[1]), 0.03) << "blue over green";
  EXPECT_GT(unevenness(own[2], own[1]), 0.09);
  const double radius = distance * cone_tangent(450e-9),
               solid_angle = wide.width() * wide.height() / distance / distance;
  Strips part{};
  for (int i = 0; i < strip_count; ++i)
    for (int k = 0; k < 100; ++k)
      part[size_t(i)] +=
          part_seen(radius * ((i + (k + 0.5) / 100) * 2 / strip_count - 1), radius, wide.width()) * solid_angle / 100;
  for (const Strips& strips : common) {
    double mean = 0;  // below 1 by the light of beams beyond the panel's edges, equal for all strips
    for (size_t i = 0; i < part.size(); ++i) mean += strips[i] / part[i] / strip_count;
    EXPECT_GT(mean, 0.6);
    EXPECT_LT(mean, 1);
    // Neighbours interfere where the panel receives only a part of their beams: 2.4 % of a strip of about 60.
    for (size_t i = 0; i < part.size(); ++i) EXPECT_NEAR(strips[i] / part[i] / mean, 1, 0.08) << i;
  }
}

TEST(CommonCone, AWhitePictureWithDepthIsWhiteInTheView) {
  // Speckle of the samples' random phases. In blue the camera resolves λz/S: the panel's 256² places in the cone,
  // half of them in the view's height and 3300 in each strip; in red half as many. Eight frames: 0.6 and 0.9 %.
  constexpr double depth = 0.1;
  constexpr int frames = 8;
  DepthImage image{Image(1, 2, 3), Array2D<float>(1, 2, float(depth))};
  std::fill(image.picture.values.begin(), image.picture.values.end(), 1.0F);
  DepthImageParams params;
  params.width = 2.2 * depth * cone_tangent(450e-9);
  expect_white_view(
      [&](bool has_common_cone) {
        Fields fields;
        for (const double wavelength : colours) {
          fields.emplace_back();
          for (int frame = 0; frame < frames; ++frame)
            fields.back().push_back(
                sum_depth_image(image, panel, {wavelength, has_common_cone ? 450e-9 : 0}, params, {}, uint32_t(frame)));
          EXPECT_EQ(fields.back().back().label.cone_wavelength, has_common_cone ? 450e-9 : 0);
        }
        return fields;
      },
      depth, 2.8_mm, 0.03, 0.03);
}

TEST(CommonCone, HoldsForEveryMethodThatSumsWaves) {
  // Red waves at the border of blue's cone end where blue ones do; each method has its tolerance against the exact sum.
  Sources sources{.wavelength = 633e-9, .label = {.cone_wavelength = 450e-9}};
  for (int i = 0; i < 40; ++i)
    sources.waves.push_back({{-9_mm + i * 0.45_mm, (i % 7) * 0.2_mm, -0.1 - (i % 3) * 1e-6}, 1, float(i * i % 6)});
  const FieldDouble exact = sum_exact(sources, panel);
  int dark = 0;
  for (const auto& u : exact.samples.values) dark += u == std::complex<double>();
  Sources alone = sources;
  alone.waves = {{{3_mm, 0, -0.1}, 1, 0}};
  const FieldDouble one = sum_exact(alone, panel);
  // R = 0.1·tan(asin(450/16000)) = 2.8136 mm: pixels from 0.186 mm on are lit, x(i) = (i − 127.5)·8 µm, i ≥ 151.
  EXPECT_EQ(one.samples(128, 150), std::complex<double>());
  EXPECT_NE(one.samples(128, 151), std::complex<double>());
  for (const SynthesisMethod method : {SynthesisMethod::tiled, SynthesisMethod::planes}) {
    const Field field = synthesize(sources, panel, {.method = method, .tolerance = 1e-3});
    double difference = 0, whole = 0;
    for (size_t i = 0; i < exact.samples.size(); ++i) {
      difference += std::norm(std::complex<double>(field.samples.values[i]) - exact.samples.values[i]);
      whole += std::norm(exact.samples.values[i]);
    }
    EXPECT_LT(std::sqrt(difference / whole), 1e-3) << method_name(method);
  }
}

TEST(CommonCone, GatheredFieldsAndTrianglesKeepToIt) {
  TraceParams params{.strategy = Strategy::gather, .pixel_samples = 16, .paths = 1, .phase = SourcePhase::surface};
  const Grid few{48, 48, 8e-6};
  // The mean irradiance is the solid angle of the cone: equal for all colours, or proportional to λ². Speckle of 2304
  // pixels with independent waves: 2 % each.
  const auto common = gather(white_wall(), few, colours, params);
  EXPECT_NEAR(power(common[0]) / power(common[2]), 1, 0.12);
  params.has_common_cone = false;
  const auto own = gather(white_wall(), few, colours, params);
  EXPECT_NEAR(power(own[0]) / power(own[2]), std::pow(633.0 / 450, 2), 0.24);
  for (const bool has_common_cone : {true, false}) {
    const auto sets = shade_triangles(white_wall(), few, colours, {.has_common_cone = has_common_cone, .paths = 1},
                                      Shading::flat, TrianglePhase::random);
    EXPECT_EQ(sets[0].acceptance_wavelength(), has_common_cone ? 450e-9 : 633e-9);
    EXPECT_EQ(sets[0].triangles.size() == sets[2].triangles.size(), has_common_cone);
  }
}

TEST(CommonCone, TheReportSaysWhatItCosts) {
  Observer observer;
  std::map<std::string, double> facts;
  std::vector<std::string> warnings;
  observer.on_fact = [&](const std::string& name, const Fact& fact) {
    if (const auto* number = std::get_if<double>(&fact)) facts[name] = *number;
  };
  observer.on_warning = [&](const std::string& text) { warnings.push_back(text); };
  const TraceParams params{.columns = 4, .rows = 4, .paths = 1};
  trace(white_wall(), panel, colours, params, observer);
  EXPECT_NEAR(facts["etendue_given_up"], 1 - std::pow(450.0 / 633, 2), 1e-12);  // 0.4946
  EXPECT_NEAR(facts["cone_half_angle"], std::asin(450e-9 / 16e-6), 1e-12);
  EXPECT_TRUE(warnings.empty());
  trace(white_wall(), panel, {720e-9, 450e-9}, params, observer);  // 0.609
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(
      warnings[0].find(
          "all wavelengths are limited to the acceptance cone of 450 nm (half angle 1.612°), which avoids a coloured "
          "border; light at 720 nm loses 61 %"),
      0u)
      << warnings[0];
  facts.clear();
  trace(white_wall(), panel, {532e-9}, params, observer);
  EXPECT_EQ(facts.count("etendue_given_up"), 0u);
}

}  // namespace
}  // namespace holotrace
