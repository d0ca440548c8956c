// Scene → Sources → Field where the phase matters: interference of laser light, images in mirrors and behind glass,
// occlusion and parallax.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "holotrace/base/cycles.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/trace.h"
#include "holotrace/trace/waves/source_phase.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/synthesize.h"
#include "support/fields.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

using Complex = std::complex<double>;
using test::relative_error;

// --- interference ----------------------------------------------------------------------------------

struct Fringes {
  double period = 0, visibility = 0;
};

/// Period of the strongest fringe near `guess`, by the maximum of the Hann-windowed transform, and its visibility √(B²
/// + C²)/A of I = A + B·cos + C·sin under that window.
Fringes measure(const std::vector<double>& intensity, double pitch, double guess) {
  const auto n = int(intensity.size());
  const auto transform = [&](double frequency) {
    Complex sum = 0;
    for (int i = 0; i < n; ++i)
      sum += intensity[size_t(i)] * (0.5 - 0.5 * std::cos(2 * pi * (i + 0.5) / n)) * cis_cycles(-frequency * i * pitch);
    return std::abs(sum);
  };
  double best = 1 / guess;
  for (double width = 0.05 / guess; width > 1e-6 / guess; width /= 4) {
    const double centre = best;
    for (int k = -8; k <= 8; ++k)
      if (transform(centre + k * width / 8) > transform(best)) best = centre + k * width / 8;
  }
  return {1 / best, 2 * transform(best) / transform(0)};
}

TEST(Coherence, YoungsSlitsInLaserLight) {
  // Two spots at ±s/2 and one laser between them. The raster has one ray for each: cell centres at ±T/2, T = s/L.
  const double s = 1_mm, distance = 0.2;
  const Grid panel{256, 64, 8e-6};
  Scene scene;
  scene.materials = {grey(0.8)};
  for (const double side : {-1.0, 1.0})
    scene.meshes.push_back(make_test_quad({side * s / 2, 0, -distance}, {20_um, 0, 0}, {0, 20_um, 0}));
  scene.lights = {PointLight{{0, 0, -0.15}, {1, 1, 1}, true}};
  const TraceParams params{.columns = 2,
                           .rows = 1,
                           .field_of_view = std::atan(s / distance),
                           .paths = 1,
                           .max_depth = 1,
                           .phase = SourcePhase::laser};
  const Sources sources = trace(scene, panel, green_light, params);
  ASSERT_EQ(sources.waves.size(), 2u);
  // The spots are rough, each with its own phase. Without these phases only the path from the laser counts, as for two
  // slits.
  const auto without_surface = [](Sources waves) {
    for (size_t i = 0; i < waves.waves.size(); ++i)
      waves.waves[i].phase -= float(random_phase(waves.seed, waves.label.frame, waves.phase_keys.at(i)));
    return waves;
  };
  EXPECT_NE(sources.phase_keys.at(0), sources.phase_keys.at(1));
  const Field field = synthesize(without_surface(sources), panel, {SynthesisMethod::exact});
  std::vector<double> row;
  for (int i = 0; i < panel.nx; ++i) row.push_back(std::norm(field.samples(32, i)));
  const Fringes fringes = measure(row, panel.pitch, green_light * distance / s);
  EXPECT_NEAR(fringes.period / (green_light * distance / s), 1, 0.005);
  EXPECT_GT(fringes.visibility, 0.98);
  // The laser is on the axis: the paths over both spots are equal, so the middle of the panel is bright.
  const double middle = std::norm(field.samples(32, 127)), mean = power(field) / (256 * 64 * 64e-12);
  EXPECT_GT(middle, 1.9 * mean);

  // Other surface phases would give the same fringes at other places. Moving the laser sideways by δ shifts them
  // by λ/s·(path difference)/λ: at 0.15 m, 50 mm in front of the spots, δ = 10 µm gives s·δ/50 mm = 200 nm.
  scene.lights = {PointLight{{10_um, 0, -0.15}, {1, 1, 1}, true}};
  const Field moved =
      synthesize(without_surface(trace(scene, panel, green_light, params)), panel, {SynthesisMethod::exact});
  const auto phase_of = [&](const Field& f) {
    Complex sum = 0;
    for (int i = 0; i < panel.nx; ++i)
      sum += double(std::norm(f.samples(32, i))) * (0.5 - 0.5 * std::cos(2 * pi * (i + 0.5) / 256)) *
             cis_cycles(panel.x(i) / fringes.period);
    return std::arg(sum);
  };
  const double shift = std::remainder(phase_of(moved) - phase_of(field), 2 * pi);
  EXPECT_NEAR(std::abs(shift), 2 * pi * (s * 10_um / 50_mm) / green_light, 0.02);
}

TEST(Coherence, LloydsMirror) {
  // A spot on the axis, at the height h above a mirror perpendicular to the panel. The rows of the raster see the spot,
  // its image 2h below, and, with one row, neither.
  const double h = 0.5_mm, distance = 0.2;
  const Grid panel{64, 96, 8e-6};  // 0.38 mm to each side: completely above the mirror's plane
  Scene scene;
  scene.materials = {grey(0.8), ConductorMaterial{}};
  scene.meshes = {make_test_quad({0, 0, -distance}, {20_um, 0, 0}, {0, 20_um, 0}, 0),
                  make_test_quad({0, -h, -0.1}, {0, 0, 90_mm}, {10_mm, 0, 0}, 1)};
  scene.lights = {PointLight{{0, 1_mm, -0.15}, {1, 1, 1}, true}};
  const TraceParams params{.columns = 1,
                           .rows = 3,
                           .field_of_view = std::atan(1.5 * 2 * h / distance),
                           .paths = 1,
                           .max_depth = 3,
                           .phase = SourcePhase::laser};
  const Sources sources = trace(scene, panel, green_light, params);
  ASSERT_EQ(sources.waves.size(), 2u);
  EXPECT_EQ(sources.phase_keys.at(0), sources.phase_keys.at(1)) << "the spot and its image have one surface's phase";
  EXPECT_NEAR(sources.waves[1].origin.y, -2 * h, 1e-9);
  const Field field = synthesize(sources, panel, {SynthesisMethod::exact});
  std::vector<double> column;
  for (int j = 0; j < panel.ny; ++j) column.push_back(std::norm(field.samples(j, 32)));
  const Fringes fringes = measure(column, panel.pitch, green_light * distance / (2 * h));
  EXPECT_NEAR(fringes.period / (green_light * distance / (2 * h)), 1, 0.005);
  EXPECT_GT(fringes.visibility, 0.98);
  // The mirror changes the phase by π at grazing incidence: I(y) ∝ 1 − cos(2π·y'/Λ), y' from the mirror's plane.
  for (int j = 8; j < panel.ny; j += 8) {
    const double y = panel.y(j) + h, path = std::hypot(y + h, distance) - std::hypot(y - h, distance);
    const double expected = 2 * std::pow(std::sin(pi * path / green_light), 2);
    EXPECT_NEAR(column[size_t(j)] / (2 * double(sources.waves[0].amplitude) * sources.waves[0].amplitude), expected,
                0.05);  // for a metal the phase is π − O(cosθ = 0.005), the amplitude 1 − O(0.005)
  }
}

// --- images in mirrors and behind glass -----------------------------------------------------------

/// Highest |U|² near the axis at a depth.
double peak_at(const Field& field, double at_depth) {
  const Field plane = propagate(field, -at_depth);
  double peak = 0;
  for (int j = plane.grid.ny / 2 - 4; j < plane.grid.ny / 2 + 4; ++j)
    for (int i = plane.grid.nx / 2 - 4; i < plane.grid.nx / 2 + 4; ++i)
      peak = std::max(peak, double(std::norm(plane.samples(j, i))));
  return peak;
}

Field field_of(const Scene& scene, SourcePhase phase) {
  const Grid panel{256, 256, 8e-6};
  const TraceParams params{.columns = 1, .rows = 1, .paths = 16, .phase = phase};
  return synthesize(trace(scene, panel, green_light, params), panel, {});
}

// A spot 50 mm from a mirror that is 100 mm behind the panel. The depth of focus 2λz²/S² is 2.5 mm at 0.1 m and
// 5.7 mm at 0.15 m: 50 mm out of focus, a spot spreads over about (50/150·256)² pixels.
TEST(Coherence, ASpotInAMirrorIsInFocusAtItsOpticalDistance) {
  Scene scene;
  scene.materials = {grey(0, 1), ConductorMaterial{}};
  scene.meshes = {make_test_quad({-50_mm, 0, -0.1}, {0, 0, 20_um}, {0, 20_um, 0}, 0),
                  make_test_quad({0, 0, -0.1}, {15_mm, 0, 15_mm}, {0, 20_mm, 0}, 1)};
  const Field path = field_of(scene, SourcePhase::path), random = field_of(scene, SourcePhase::random);
  EXPECT_GT(peak_at(path, 0.15), 100 * peak_at(path, 0.1));
  // ±10 mm: on the axis of a square aperture ((C² + S²)(w)/w²)², w = S/2·√(2|1/z − 1/z'|/λ) = 1.3: a quarter.
  EXPECT_GT(peak_at(path, 0.15), 3 * peak_at(path, 0.16));
  EXPECT_GT(peak_at(path, 0.15), 3 * peak_at(path, 0.14));
  EXPECT_GT(peak_at(random, 0.1), 100 * peak_at(random, 0.15));
}

TEST(Coherence, ASpotBehindASlabOfGlassIsInFocusAtItsApparentDepth) {
  const double n = 1.5, thickness = 30_mm, at = 0.1, apparent = at - thickness * (1 - 1 / n);
  Scene scene;
  scene.materials = {grey(0, 1), DielectricMaterial{.index = constant_index(n)}};
  scene.meshes = {make_wall(-at, 20_um, 20_um, 0)};
  const Vec3 centre{0, 0, -0.06}, x{15_mm, 0, 0}, y{0, 15_mm, 0}, z{0, 0, thickness / 2};
  for (const double side : {-1.0, 1.0}) {
    scene.meshes.push_back(make_test_quad(centre + x * side, y * side, z, 1));
    scene.meshes.push_back(make_test_quad(centre + y * side, z * side, x, 1));
    scene.meshes.push_back(make_test_quad(centre + z * side, x * side, y, 1));
  }
  const Field field = field_of(scene, SourcePhase::path);
  // 10 mm out of focus are 5 depths of focus (2λz²/S² = 2.1 mm at 90 mm); for 4 mm, w = 1.4.
  EXPECT_GT(peak_at(field, apparent), 10 * peak_at(field, at));
  EXPECT_GT(peak_at(field, apparent), 3 * peak_at(field, apparent + 4_mm));
  EXPECT_GT(peak_at(field, apparent), 3 * peak_at(field, apparent - 4_mm));
  // With random phases the wave begins on the glass, 45 mm behind the panel.
  const Field random = field_of(scene, SourcePhase::random);
  EXPECT_GT(peak_at(random, 45_mm), 10 * peak_at(random, apparent));
}

// --- occlusion -------------------------------------------------------------------------------------

TEST(Coherence, ANearCardHidesAFarPointFromItsHalfOfThePanel) {
  // The card covers x > 50 µm at 50 mm; it blocks the paths from the axis at 0.2 m to pixels with x > 67 µm.
  const Grid panel{256, 256, 8e-6};
  Scene scene;
  scene.materials = {grey(0, 1), grey(0)};
  scene.meshes = {make_wall(-0.2, 20_um, 20_um, 0),
                  make_test_quad({10.05_mm, 0, -0.05}, {10_mm, 0, 0}, {0, 10_mm, 0}, 1)};
  const auto peaks = [&](Strategy strategy) {
    const TraceParams params{.strategy = strategy, .columns = 1, .rows = 1, .paths = 1};
    const Field whole = synthesize(trace(scene, panel, green_light, params), panel, {});
    std::pair<double, double> result;
    for (const bool is_left : {true, false}) {
      Field part = whole;
      for (int j = 0; j < panel.ny; ++j)
        for (int i = 0; i < panel.nx; ++i)
          if ((panel.x(i) < 0) != is_left) part.samples(j, i) = 0;
      (is_left ? result.first : result.second) = peak_at(part, 0.2);
    }
    return result;
  };
  const auto [shared_left, shared_right] = peaks(Strategy::shared);
  EXPECT_NEAR(shared_left / shared_right, 1, 0.05);  // mirror images; the pixel of the peak is half a pixel off
  const auto [tiled_left, tiled_right] = peaks(Strategy::tiled);
  EXPECT_NEAR(tiled_left / shared_left, 1, 1e-3);  // the tolerance of both sums
  EXPECT_LT(tiled_right, 1e-6 * tiled_left);
}

}  // namespace
}  // namespace holotrace
