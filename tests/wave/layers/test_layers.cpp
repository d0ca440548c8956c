// Slices of depth compared with waves summed one by one, with free space and with closed forms.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/layers/sum_layers.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/synthesize.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;
using test::make_disc_aperture;
using test::make_random_sources;
using test::relative_error;

// Random waves at three depths: each slice is at its waves' own depth.
Sources make_waves_on_layers(int count, const Grid& panel, double depth) {
  Sources sources = make_random_sources(count, panel, green, depth, depth);
  for (size_t i = 0; i < sources.waves.size(); ++i) {
    Source& wave = sources.waves[i];
    wave.origin.x += panel.centre_x;
    wave.origin.y += panel.centre_y;
    wave.origin.z *= 1 + 0.02 * double(i % 3);
    if (i % 4 == 0)  // on a raster point; the others between
      wave.origin = {panel.x(double(i % size_t(panel.nx))), panel.y(double(i % size_t(panel.ny))), wave.origin.z};
  }
  return sources;
}

SynthesizeParams layers_params(double tolerance, int slices = 0, bool has_silhouettes = false) {
  SynthesizeParams params;
  params.method = SynthesisMethod::layers;
  params.tolerance = tolerance;
  params.slices = slices;
  params.has_silhouettes = has_silhouettes;
  return params;
}

struct Case {
  Grid grid;
  double depth;
};
class LayersOnPanel : public ::testing::TestWithParam<Case> {};

// On slices at the waves' depths nothing is quantised, and boxes contain the panel: the error follows the tolerance.
// Samples are floats: sums of a few thousand frequencies are exact to about 1e-6.
TEST_P(LayersOnPanel, FollowTheTolerance) {
  const auto [grid, depth] = GetParam();
  for (const int count : {1, 60}) {
    const Sources sources = make_waves_on_layers(count, grid, depth);
    const FieldDouble exact = sum_exact(sources, grid);
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
      Heard heard;
      const Field field = synthesize(sources, grid, layers_params(tolerance, 3), heard.observer());
      EXPECT_LT(relative_error(field, exact), tolerance) << count << " waves";
      EXPECT_EQ(std::get<int64_t>(heard.facts.at("waves_cut")), 0);
      EXPECT_EQ(heard.number("expected_depth_error"), 0);
    }
  }
}

// A single slice has nothing to hide.
TEST_P(LayersOnPanel, OfOneDepthAreTheSameWithSilhouettes) {
  const auto [grid, depth] = GetParam();
  const Sources sources = make_random_sources(20, grid, green, depth, depth);
  EXPECT_LT(relative_error(sum_layers(sources, grid, layers_params(1e-3, 0, true)), sum_exact(sources, grid)), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Shapes, LayersOnPanel,
                         ::testing::Values(Case{{128, 97, 8_um}, 0.1_m}, Case{{97, 128, 8_um}, 0.3_m},
                                           Case{{64, 64, 8_um}, 2.0_m}, Case{{150, 60, 3.74_um}, 0.05_m},
                                           Case{{81, 80, 8_um, 3_mm, -1_mm}, 0.2_m}, Case{{1, 1, 8_um}, 0.2_m}),
                         [](const auto& info) { return fmt::format("Case{}", info.index); });

// Depths between slices: the error is the expected one, and within the tolerance.
TEST(Layers, OfMovedDepthsHaveTheErrorStated) {
  const Grid grid{128, 97, 8_um};
  const Sources sources = make_random_sources(300, grid, green, 0.2_m, 0.21_m);
  const FieldDouble exact = sum_exact(sources, grid);
  for (const double tolerance : {3e-2, 1e-2, 3e-3}) {
    Heard heard;
    const double error = relative_error(sum_layers(sources, grid, layers_params(tolerance), heard.observer()), exact);
    EXPECT_LT(error, tolerance);
    // 300 waves of random phase: cross terms are 1/√300 of the energy, half of that for the root. Three times it.
    EXPECT_NEAR(error / heard.number("expected_depth_error"), 1, 3 * 0.5 / std::sqrt(300)) << tolerance;
    EXPECT_TRUE(heard.warnings.empty());
  }
  for (const int slices : {1, 4, 40}) {
    Heard heard;
    const double error =
        relative_error(sum_layers(sources, grid, layers_params(1e-3, slices), heard.observer()), exact);
    EXPECT_EQ(std::get<int64_t>(heard.facts.at("slices")), slices);
    EXPECT_NEAR(error / heard.number("expected_depth_error"), 1, 3 * 0.5 / std::sqrt(300)) << slices;
    ASSERT_EQ(heard.warnings.size(), 1U);
    EXPECT_EQ(heard.warnings[0].rfind(fmt::format("with slices = {}, depths are rounded by up to ", slices), 0), 0U);
  }
}

// The expected difference from exact if the panel is wider than the box: √(0.45·√(λd)/R), most of it at the box's edge.
TEST(Layers, EndAWaveSoftlyAtItsBox) {
  for (const double depth : {0.02_m, 0.05_m, 0.1_m}) {
    const double radius = box_radius(depth, green, 8_um), fringe = std::sqrt(green * depth);
    const int side = int(2 * (radius + 6 * fringe) / 8_um);
    const Grid grid{side, side, 8_um};
    const Sources sources{green, {{{3_um, -2_um, -depth}, 1, 0}}};
    const FieldDouble exact = sum_exact(sources, grid);
    const Field field = sum_layers(sources, grid, layers_params(1e-3));
    EXPECT_NEAR(relative_error(field, exact), std::sqrt(0.45 * fringe / radius),
                0.1 * std::sqrt(0.45 * fringe / radius));
    double inside = 0, outside = 0, all = 0;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const double at = std::max(std::abs(grid.x(i)), std::abs(grid.y(j)));
        const double off = std::norm(std::complex<double>(field.samples(j, i)) - exact.samples(j, i));
        all += off;
        if (at < radius - fringe) inside += off;
        if (at > radius + fringe) outside += off;
      }
    EXPECT_LT(inside + outside, 0.2 * all) << depth;
  }
}

TEST(Layers, AreLinear) {
  const Grid grid{100, 90, 8_um};
  const Sources all = make_waves_on_layers(30, grid, 0.15_m);
  Sources a = all, b = all;
  for (size_t i = 0; i < all.waves.size(); ++i) (i % 2 ? a : b).waves[i].amplitude = 0;
  const SynthesizeParams params = layers_params(1e-3);
  Field sum = sum_layers(a, grid, params);
  const Field other = sum_layers(b, grid, params);
  for (size_t i = 0; i < sum.samples.size(); ++i) sum.samples.values[i] += other.samples.values[i];
  EXPECT_LT(relative_error(sum, sum_layers(all, grid, params)), 2e-6);  // a few roundings of floats
}

// Waves without effect: outside the panel, two at one place, and none on the panel.
TEST(Layers, TakeWavesThatMissOrCoincide) {
  const Grid grid{80, 80, 8_um};
  Sources sources = make_waves_on_layers(5, grid, 0.1_m);
  sources.waves.push_back(sources.waves[0]);
  const Field field = sum_layers(sources, grid, layers_params(1e-3));
  EXPECT_LT(relative_error(field, sum_exact(sources, grid)), 1e-3);
  Sources with_missing = sources;
  with_missing.waves.push_back({{0.5_m, 0, -0.1_m}, 1, 0});
  EXPECT_EQ(sum_layers(with_missing, grid, layers_params(1e-3)).samples.values, field.samples.values);
  const Sources missing{green, {{{0.5_m, 0, -0.1_m}, 1, 0}}};
  for (const auto& u : sum_layers(missing, grid, layers_params(1e-3)).samples.values)
    EXPECT_EQ(u, std::complex<float>());
}

TEST(Layers, GiveTheSameBytesOnAnyNumberOfThreads) {
  const Grid grid{120, 90, 8_um};
  const Sources sources = make_random_sources(200, grid, green, 0.1_m, 0.12_m);
  for (const bool has_silhouettes : {false, true}) {
    std::vector<Field> fields;
    for (const size_t threads : {1, 5}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      fields.push_back(sum_layers(sources, grid, layers_params(1e-2, 6, has_silhouettes)));
    }
    EXPECT_EQ(fields[0].samples.values, fields[1].samples.values);
  }
}

// Slices of samples hold the same light as the waves that were put into them.
TEST(Layers, OfSamplesAndOfWavesAgree) {
  const Grid grid{100, 81, 8_um};
  const Sources sources = make_waves_on_layers(30, grid, 0.15_m);
  const SynthesizeParams params = layers_params(1e-4);
  const Layers layers = make_layers(sources, grid, params);
  ASSERT_EQ(layers.slices.size(), 3U);
  EXPECT_GT(layers.slices[0].depth(), layers.slices[2].depth());
  EXPECT_LT(relative_error(sum_layers(layers, grid), sum_exact(sources, grid)), 1e-4);
  // Edges scatter light to all angles of the band. At the band's end the light of samples rolls off differently, over
  // less than a tenth of the band along each axis; little of the light of an edge (a few per cent) is in there.
  const SynthesizeParams hiding = layers_params(1e-4, 0, true);
  EXPECT_LT(relative_error(sum_layers(make_layers(sources, grid, hiding), grid), sum_layers(sources, grid, hiding)),
            3e-3);
}

Slice as_slice(const FieldDouble& light, double depth) {
  Slice slice{convert<float>(light), {}};
  slice.light.z = -depth;
  return slice;
}

// A slice of samples is free space over its depth. The light is limited in space and frequency to 1e-11; the samples
// are floats, as are the factors of free space (2e-7).
TEST(LayersOfSamples, AreFreeSpaceSliceBySlice) {
  const Grid grid{160, 120, 8_um};
  const FieldDouble light = test::make_band_limited_noise(grid, green, 8e3);
  for (const double depth : {0.01_m, 0.1_m, 0.7_m})
    EXPECT_LT(relative_error(sum_layers({green, {as_slice(light, depth)}}, grid), propagate(light, depth)), 2e-6)
        << depth;
  FieldDouble sum = propagate(light, 0.12_m);
  const FieldDouble near = propagate(light, 0.07_m);
  for (size_t i = 0; i < sum.samples.size(); ++i) sum.samples.values[i] += near.samples.values[i];
  EXPECT_LT(relative_error(sum_layers({green, {as_slice(light, 0.12_m), as_slice(light, 0.07_m)}}, grid), sum), 2e-6);
}

// A slice smaller than the panel, off its centre and on its raster.
TEST(LayersOfSamples, MayBePartsOfThePanelsRaster) {
  const Grid grid{160, 120, 8_um};
  Grid part{48, 36, 8_um};
  part.centre_x = 20 * 8_um, part.centre_y = -11 * 8_um;  // sizes of one parity: whole samples
  Slice small{Field(part, green, -0.05_m), {}}, whole{Field(grid, green, -0.05_m), {}};
  const FieldDouble light = test::make_band_limited_noise({48, 36, 8_um}, green, 8e3);
  for (int j = 0; j < part.ny; ++j)
    for (int i = 0; i < part.nx; ++i)
      small.light.samples(j, i) = whole.light.samples(42 + 11 + j, 56 + 20 + i) =
          std::complex<float>(light.samples(j, i));
  EXPECT_LT(relative_error(sum_layers({green, {small}}, grid), sum_layers({green, {whole}}, grid)), 2e-6);
}

// Light of a far slice through a hole of radius 0.5 mm in a near one: closed_forms.md section 5, case 3, on the axis.
// The far slice is a plane wave 20 µm behind. Its window's border changes the wave at most √(λ·20 µm) = 3 µm
// inward. On the rim a raster of 8 µm is coarse: the mean over a pixel is wrong by (k·a·p/z)²/24 of the rim's wave
// (test_diffraction).
TEST(LayersThatHide, PassAHoleAsTheClosedFormSays) {
  const double a = 0.5_mm, pitch = 4_um;
  const Grid grid{301, 301, pitch};
  const FieldDouble hole = make_disc_aperture(grid, green, a);
  const struct { double z, intensity; } cases[] = {{0.1_m, 3.171556}, {0.2_m, 1.089891}};
  for (const auto& c : cases) {
    Layers layers{green,
                  {{Field(grid, green, -(c.z + 1_um)), {}}, {Field(grid, green, -c.z), Array2D<float>(301, 301)}}};
    for (auto& u : layers.slices[0].light.samples.values) u = 1;
    for (size_t i = 0; i < hole.samples.size(); ++i)
      layers.slices[1].mask.values[i] = std::max(0.F, float(1 - hole.samples.values[i].real()));
    const double tolerance = 4 * std::pow(2 * pi / green * a * pitch / c.z, 2) / 12;
    EXPECT_NEAR(std::norm(sum_layers(layers, grid).samples(150, 150)), c.intensity, tolerance) << c.z;
  }
}

// Babinet: the light through a screen and the light through its complement add up to all light, at any depth.
TEST(LayersThatHide, AndTheirComplementsPassAllLight) {
  const Grid grid{120, 100, 8_um};
  const FieldDouble light = test::make_band_limited_noise(grid, green, 8e3);
  const FieldDouble disc = make_disc_aperture(grid, green, 0.2_mm);
  Layers screen{green, {as_slice(light, 0.1_m), {Field(grid, green, -0.06_m), Array2D<float>(100, 120)}}};
  Layers complement = screen, open = screen;
  for (size_t i = 0; i < disc.samples.size(); ++i) {
    screen.slices[1].mask.values[i] = float(disc.samples.values[i].real());
    complement.slices[1].mask.values[i] = 1 - screen.slices[1].mask.values[i];
  }
  // The open screen's mask is 0 everywhere, so the light around the slice is in its field too; the complement's field
  // does not have it.
  Field sum = sum_layers(screen, grid);
  const Field through = sum_layers(complement, grid), all = sum_layers(open, grid);
  Layers closed = screen;
  for (float& m : closed.slices[1].mask.values) m = 1;
  const Field around = sum_layers(closed, grid);
  for (size_t i = 0; i < sum.samples.size(); ++i)
    sum.samples.values[i] += through.samples.values[i] - around.samples.values[i];
  EXPECT_LT(relative_error(sum, all), 2e-6);
  EXPECT_LT(relative_error(all, propagate(light, 0.1_m)), 1e-5);
}

// A card of dark waves, 1 mm × 0.8 mm, 20 mm before a point at 0.12 m, casts a shadow six times as large on the panel.
Sources make_card_before_point(double card_depth, float card_amplitude) {
  Sources sources{green, {{{0, 0, -0.12_m}, 1, 0}}};
  for (int j = -20; j <= 20; ++j)
    for (int i = -25; i <= 25; ++i)
      sources.waves.push_back({{i * 20_um, j * 20_um, -card_depth}, card_amplitude, float(i * i + j * 7 * j)});
  return sources;
}

TEST(LayersThatHide, KeepThePointBehindACardInTheDark) {
  const Grid grid{128, 100, 8_um};
  const double point = power(sum_exact({green, {{{0, 0, -0.12_m}, 1, 0}}}, grid));
  const auto shown = [&](double depth, bool hides) {
    return power(sum_layers(make_card_before_point(depth, 0), grid, layers_params(1e-3, 0, hides))) / point;
  };
  EXPECT_NEAR(shown(0.1_m, false), 1, 1e-3);  // within the tolerance, twice for the square
  // The panel's nearest corner is 1.9 mm inside the shadow of a side 0.4 mm off the axis. Fresnel's v = 0.4 mm·√(2·120/
  // (532 nm·20 mm·100)) is 6 or more for each of four sides, 1/(√2·π·v) of the amplitude each: 4·(1/(√2·π·6))² = 0.6
  // % if they add up with random phases, four times that in phase.
  EXPECT_LT(shown(0.1_m, true), 0.024);
  EXPECT_NEAR(shown(0.14_m, true), 1, 1e-3);  // a card behind the point hides nothing
}

// The near card's own light is not changed by what it hides.
TEST(LayersThatHide, LeaveTheNearSlicesLightAlone) {
  const Grid grid{128, 100, 8_um};
  Sources both = make_card_before_point(0.1_m, 0.1F), card = both;
  card.waves.erase(card.waves.begin());
  both.waves[0].amplitude = 0;
  EXPECT_LT(relative_error(sum_layers(both, grid, layers_params(1e-3, 0, true)), sum_exact(card, grid)), 1e-3);
}

// Every third wave converges in front of the panel: the definition takes both.
TEST_P(LayersOnPanel, TakeWavesOfBothSides) {
  const auto [grid, depth] = GetParam();
  Sources sources = make_waves_on_layers(60, grid, depth);
  for (size_t i = 0; i < sources.waves.size(); i += 3) sources.waves[i].origin.z *= -1;
  const FieldDouble exact = sum_exact(sources, grid);
  for (const double tolerance : {1e-2, 1e-4})
    EXPECT_LT(relative_error(synthesize(sources, grid, layers_params(tolerance, 6)), exact), tolerance);
}

// Depths of both sides in slices: none reaches through the panel, where the phase on the axis jumps by π.
TEST(Layers, OfDepthsThroughThePanelHaveTheErrorStated) {
  const Grid grid{128, 97, 8_um};
  Sources sources = make_random_sources(300, grid, green, 0.2_m, 0.21_m);
  for (size_t i = 0; i < sources.waves.size(); i += 2) sources.waves[i].origin.z *= -1;
  Heard heard;
  const double error =
      relative_error(sum_layers(sources, grid, layers_params(1e-2), heard.observer()), sum_exact(sources, grid));
  EXPECT_LT(error, 1e-2);
  EXPECT_NEAR(error / heard.number("expected_depth_error"), 1, 3 * 0.5 / std::sqrt(300));
  sum_layers(sources, grid, layers_params(1e-2, 1), heard.observer());
  EXPECT_EQ(std::get<int64_t>(heard.facts.at("slices")), 2) << "one on each side";
}

// A card 20 mm in front of the panel is nearer to a viewer than the point behind it: where the card is, the light of the hologram is
// dark. A point in front of the card is not hidden by it: within the tolerance, twice for the square.
TEST(LayersThatHide, HideThroughThePanel) {
  const Grid grid{256, 200, 8_um};
  const auto light_on_card = [&](double card_z, double point_z, bool hides) {
    Sources sources = make_card_before_point(-card_z, 0);
    sources.waves[0].origin.z = point_z;
    const Field there = propagate(sum_layers(sources, grid, layers_params(1e-3, 0, hides)), card_z);
    double power = 0;  // 0.25 mm and more within the card's edges
    for (int j = 0; j < there.grid.ny; ++j)
      for (int i = 0; i < there.grid.nx; ++i)
        if (std::abs(there.grid.x(i)) < 0.25_mm && std::abs(there.grid.y(j)) < 0.15_mm)
          power += double(std::norm(there.samples(j, i)));
    return power;
  };
  // What the panel of 2 mm cannot send of the shadow's edge, and what diffraction brings into it: below 1/(√2·π·v)² of the light for
  // each of four edges, v = 0.25 mm·√(2/(λ·20 mm)) = 3.4: 1.8 % in all.
  EXPECT_LT(light_on_card(20_mm, -0.12_m, true) / light_on_card(20_mm, -0.12_m, false), 0.018);
  EXPECT_NEAR(light_on_card(20_mm, 60_mm, true) / light_on_card(20_mm, 60_mm, false), 1, 2e-3);
}

TEST(Layers, RefuseWhatTheyCannotSum) {
  const Grid grid{16, 12, 8_um};
  const auto error = [&](Sources sources, const SynthesizeParams& params) {
    return error_of([&] { synthesize(sources, grid, params); });
  };
  Sources sources = make_random_sources(3, grid, green, 0.1_m, 0.1_m);
  EXPECT_EQ(error(sources, layers_params(1e-3, -2)), "expected a whole number of 0 or more for \"slices\", got -2");
  sources.tiles = {2, 1, std::vector<float>(6, 1.F)};
  EXPECT_EQ(error(sources, layers_params(1e-3)).rfind("expected waves of one amplitude for the whole panel", 0), 0U);
  sources.tiles = {};
  sources.waves[0].origin.x = 900_m;
  sources.waves[0].origin.z = -1e6_m;
  EXPECT_EQ(error(sources, layers_params(1e-3)).rfind("expected a window of slices of less than a million samples", 0),
            0U);
  const Grid fine{16, 12, 0.2_um};
  EXPECT_EQ(error_of([&] {
              sum_layers(make_random_sources(3, fine, green, 1_mm, 2_mm), fine, layers_params(1e-2, 2, true));
            }),
            "expected a pitch above half a wavelength for silhouettes, got 200 nm at 532 nm");
}

TEST(LayersOfSamples, InThePanelAreItsField) {
  const Grid grid{16, 12, 8_um};
  Slice slice{Field(grid, green), {}};
  for (size_t i = 0; i < slice.light.samples.size(); ++i)
    slice.light.samples.values[i] = {float(i % 5), float(i % 3) - 1};
  EXPECT_LT(relative_error(sum_layers(Layers{green, {slice}}, grid), slice.light), 1e-6);
}

TEST(LayersOfSamples, AreCheckedBeforeTheyAreSummed) {
  const Grid grid{16, 12, 8_um};
  const Slice good{Field(grid, green, -0.1_m), {}};
  const auto error = [&](const std::function<void(Layers&)>& spoil) {
    Layers layers{green, {good, good}};
    spoil(layers);
    return error_of([&] { sum_layers(layers, grid); });
  };
  EXPECT_EQ(error([](Layers&) {}), "no error");
  EXPECT_EQ(error([](Layers& l) { l.slices.clear(); }), "expected at least one slice, got none");
  EXPECT_EQ(error([](Layers& l) { l.slices[0].light.z = -0.05; }),
            "expected slices from far to near, got slice 1 at 100 mm after one at 50 mm");
  EXPECT_EQ(error([](Layers& l) { l.slices[1].light.z = NAN; }), "expected slice 1 at a finite place, got z = nan m");
  EXPECT_EQ(error([](Layers& l) { l.slices[1].mask = Array2D<float>(3, 4); }),
            "expected a mask of 16 × 12 samples in slice 1, or none, got 4 × 3");
  EXPECT_EQ(error([](Layers& l) { l.slices[1].mask = Array2D<float>(12, 16, 1.5F); }),
            "expected a mask in [0, 1] in slice 1, got 1.5");
  EXPECT_EQ(
      error([](Layers& l) { l.slices[1].light.samples(3, 3) = NAN; }).rfind("expected finite samples in slice 1", 0),
      0U);
  EXPECT_EQ(error([](Layers& l) {
              l.slices[0].light.wavelength = 500e-9;
            }).rfind("expected slices of one wavelength and pitch, 532 nm and 8 µm, got 500 nm and 8 µm in slice 0", 0),
            0U);
  EXPECT_EQ(error([](Layers& l) {
              l.slices[1].light.grid.centre_x = 3e-6;
            }).rfind("expected slice 1 on the panel's raster, of its pitch 8 µm and whole samples from it", 0),
            0U);
}

// The front half of a sphere hides nothing of itself, for any number of slices: discs have the spacing of the
// points.
TEST(LayersSilhouettes, OfAConvexSurfaceLetItsLightThrough) {
  const Grid grid{200, 160, 8_um};
  Sources sources{green, {}};
  const double radius = 0.4_mm, step = 20_um;
  for (double x = -radius; x <= radius; x += step)
    for (double y = -radius; y <= radius; y += step)
      if (const double rest = radius * radius - x * x - y * y; rest > 0.2 * radius * radius)
        sources.waves.push_back({{x, y, -50_mm + std::sqrt(rest)}, 1, float(1e6 * x + 3e6 * y * y)});
  const double power_of_all = power(sum_layers(sources, grid, layers_params(1e-2, 20)));
  for (const int slices : {2, 10, 80}) {
    const double let_through = power(sum_layers(sources, grid, layers_params(1e-2, slices, true))) / power_of_all;
    EXPECT_GT(let_through, 0.8)
        << slices;  // edges of discs, 14 µm from the points, scatter some of their neighbours' light
    EXPECT_LT(let_through, 1.2) << slices;
  }
}

}  // namespace
}  // namespace holotrace
