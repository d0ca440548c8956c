// Scene → Sources → Field at three wavelengths: a white wall is white up to the border of the view.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "holotrace/base/observer.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/shade_triangles.h"
#include "holotrace/trace/trace.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/synthesize.h"
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

/// Power that waves bring to the panel from ten strips of the view, from its left border to its right one [W]: what a
/// camera with the whole panel as its pupil sees of them. Strips are as wide as blue sees from the panel's centre.
std::array<double, 10> strips(const Sources& sources) {
  const double half = distance * acceptance_tangent(450e-9, panel.pitch);
  std::array<double, 10> light{};
  for (const Source& source : sources.waves) {
    const int strip = int(std::floor((source.origin.x / half + 1) * 5));
    if (strip < 0 || strip > 9 || std::abs(source.origin.y) > half / 10) continue;
    const PixelBox box = lit_box(source, panel, acceptance_tangent(sources.acceptance_wavelength(), panel.pitch));
    light[size_t(strip)] += double(source.amplitude) * source.amplitude * double(box.pixels());
  }
  return light;
}

/// Ratio of red to blue in the strips.
std::array<double, 10> red_over_blue(const TraceParams& params) {
  const auto sets = trace(white_wall(), panel, colours, params);
  const auto red = strips(sets[0]), blue = strips(sets[2]);
  std::array<double, 10> ratio{};
  for (size_t i = 0; i < 10; ++i) ratio[i] = red[i] / blue[i];
  return ratio;
}

TEST(CommonCone, AWhiteWallIsWhiteUpToTheBorderOfTheView) {
  for (const Pattern pattern : {Pattern::grid, Pattern::random}) {
    TraceParams params{.pattern = pattern, .columns = 100, .rows = 100, .samples = 20000, .paths = 1};
    // All colours have the same rays, boxes and solid angles: only the rounding of boxes to pixels remains.
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

TEST(CommonCone, HoldsForEveryMethodThatSumsWaves) {
  // Red waves at the border of blue's cone end where blue ones do; each method has its tolerance against the exact sum.
  Sources sources{.wavelength = 633e-9, .cone_wavelength = 450e-9};
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
  EXPECT_EQ(warnings[0].find("all wavelengths use the cone of 450 nm, a half angle of 1.612°; 720 nm loses 61 %"), 0u)
      << warnings[0];
  facts.clear();
  trace(white_wall(), panel, {532e-9}, params, observer);
  EXPECT_EQ(facts.count("etendue_given_up"), 0u);
}

}  // namespace
}  // namespace holotrace
