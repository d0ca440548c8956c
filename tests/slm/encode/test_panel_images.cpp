#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "holotrace/slm/encode/panel_images.h"
#include "support/error_of.h"

namespace holotrace {
namespace {

constexpr double pitch_of_panel = 8e-6;

Hologram of_levels(int rows, int columns, const std::vector<uint16_t>& levels, int count = 256) {
  Hologram hologram;
  hologram.grid = {columns, rows, pitch_of_panel};
  hologram.level = Array2D<uint16_t>(rows, columns);
  std::copy(levels.begin(), levels.end(), hologram.level.values.begin());
  hologram.levels = count;
  hologram.wavelength = 500e-9;
  return hologram;
}

std::vector<uint16_t> sent(const Hologram& hologram, const PanelImageParams& params, const PanelTables& tables = {}) {
  return panel_images({hologram}, params, tables, PanelValue::grey).at(0).values;
}

// The picture  1 2 3  by hand.
//              4 5 6
TEST(PanelImages, AreFlippedThenTransposedThenTurnedCounterclockwise) {
  const Hologram hologram = of_levels(2, 3, {1, 2, 3, 4, 5, 6});
  const auto oriented = [&](Flip flip, bool is_transposed, Turn turn) {
    PanelImageParams params;
    params.flip = flip;
    params.is_transposed = is_transposed;
    params.turn = turn;
    return panel_images({hologram}, params, {}, PanelValue::grey).at(0);
  };
  using Values = std::vector<uint16_t>;
  EXPECT_EQ(oriented(Flip::none, false, Turn::none).values, (Values{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(oriented(Flip::x, false, Turn::none).values, (Values{3, 2, 1, 6, 5, 4}));
  EXPECT_EQ(oriented(Flip::y, false, Turn::none).values, (Values{4, 5, 6, 1, 2, 3}));
  EXPECT_EQ(oriented(Flip::both, false, Turn::none).values, (Values{6, 5, 4, 3, 2, 1}));
  EXPECT_EQ(oriented(Flip::none, false, Turn::half).values, (Values{6, 5, 4, 3, 2, 1}));
  const PanelImage transposed = oriented(Flip::none, true, Turn::none);
  EXPECT_EQ(transposed.columns, 2);
  EXPECT_EQ(transposed.rows, 3);
  EXPECT_EQ(transposed.values, (Values{1, 4, 2, 5, 3, 6}));
  EXPECT_EQ(oriented(Flip::none, false, Turn::quarter).values, (Values{3, 6, 2, 5, 1, 4}));
  EXPECT_EQ(oriented(Flip::none, false, Turn::three_quarters).values, (Values{4, 1, 5, 2, 6, 3}));
  EXPECT_EQ(oriented(Flip::x, true, Turn::none).values, (Values{3, 6, 2, 5, 1, 4}));  // flip first: columns of 3 2 1
  EXPECT_EQ(oriented(Flip::x, false, Turn::quarter).values, (Values{1, 4, 2, 5, 3, 6}));  // 3 2 1 turned
  EXPECT_EQ(oriented(Flip::y, true, Turn::quarter).values, (Values{1, 2, 3, 4, 5, 6}));   // 4 1, 5 2, 6 3 turned
}

// A period of four pixels adds a quarter of a cycle, 64 of 256 levels, from pixel to pixel toward +x; light goes there by
// exp(+i·kx·x). Row 0 is on top, so y falls from row to row.
TEST(PanelImages, BlazeRisesTowardPositiveXAndY) {
  const Hologram hologram = of_levels(2, 4, {0, 0, 0, 0, 0, 0, 0, 0});
  PanelImageParams params;
  params.blaze = {4 * pitch_of_panel};
  EXPECT_EQ(sent(hologram, params), (std::vector<uint16_t>{160, 224, 32, 96, 160, 224, 32, 96}));  // x from −1.5 pixels
  params.blaze = {0, -8 * pitch_of_panel};  // y = ±0.5 pixels: ∓1/16 of a cycle
  EXPECT_EQ(sent(hologram, params), (std::vector<uint16_t>{240, 240, 240, 240, 16, 16, 16, 16}));
}

// The path to the focus from a pixel at r is √(r² + f²); it is a quarter of a wave longer than f at r = √(λf/2 + λ²/16). A
// converging lens adds less phase there: −64 of 256 levels; a diverging one +64.
TEST(PanelImages, LensHasTheFocalLengthAndItsSign) {
  Hologram hologram = of_levels(1, 81, std::vector<uint16_t>(81, 7));
  const double f = 0.05, wavelength = hologram.wavelength;
  hologram.grid.pitch = std::sqrt(wavelength * f / 2 + wavelength * wavelength / 16) / 40;
  PanelImageParams params;
  for (const auto& [lens, edge] : {std::pair{f, 199}, {-f, 71}}) {
    params.lens = lens;
    const std::vector<uint16_t> levels = sent(hologram, params);
    EXPECT_EQ(levels.front(), edge);
    EXPECT_EQ(levels[40], 7);
    EXPECT_EQ(levels.back(), edge);
  }
}

// The maker's map is of the panel's pixels as they are sent; blaze and lens are of the hologram, and turn with it. The table is
// last: here it doubles greys.
TEST(PanelImages, CorrectionBelongsToThePanelAndBlazeToTheHologram) {
  const Hologram hologram = of_levels(1, 3, {10, 20, 30});
  PanelImageParams params;
  params.turn = Turn::quarter;
  PanelTables tables;
  tables.correction = Array2D<float>(3, 1);
  tables.correction.values = {1 / 256.0F, 2 / 256.0F, 3 / 256.0F};
  EXPECT_EQ(sent(hologram, params, tables), (std::vector<uint16_t>{31, 22, 13}));
  params.blaze = {4 * pitch_of_panel};  // x = −1, 0, 1 pixels: −64, 0 and 64 levels
  EXPECT_EQ(sent(hologram, params, tables), (std::vector<uint16_t>{95, 22, 205}));
  for (int grey = 0; grey < 256; ++grey) tables.lut.push_back(uint16_t(2 * grey));
  EXPECT_EQ(sent(hologram, params, tables), (std::vector<uint16_t>{190, 44, 410}));
  tables.correction = Array2D<float>(1, 3);
  EXPECT_EQ(
      error_of([&] { sent(hologram, params, tables); }),
      "expected a correction of 1 × 3 pixels, as the picture for the panel has, got 3 × 1; take that of this panel");
}

TEST(PanelImages, WarnOfWhatLevelsAllowForAlready) {
  Hologram hologram = of_levels(1, 2, {0, 1});
  hologram.slm = Slm{};
  hologram.slm->grid = hologram.grid;
  hologram.slm->effects.aberration = {{2, 0, 0.1}};
  hologram.effects = {"aberration"};
  std::vector<std::string> warnings;
  Observer observer;
  observer.on_warning = [&](const std::string& sentence) { warnings.push_back(sentence); };
  PanelTables tables;
  tables.lut.resize(256);
  panel_images({hologram}, {}, tables, PanelValue::grey, observer);
  EXPECT_TRUE(warnings.empty());
  tables.correction = Array2D<float>(1, 2);
  panel_images({hologram}, {}, tables, PanelValue::grey, observer);
  EXPECT_EQ(
      warnings.at(0),
      "the levels of the hologram allow for the panel's aberration already, and the correction does so a second time; "
      "leave one of them out");
}

TEST(PanelImages, LevelsBeyondThePanelAreRefused) {
  PanelImageParams params;
  params.blaze = {4 * pitch_of_panel};
  EXPECT_EQ(error_of([&] {
              sent(of_levels(1, 2, {0, 9999}), params);
            }),
            "expected levels below 256 in a hologram for a panel, got 9999");
}

TEST(PanelImages, CorrectionWrapsAfterAFullCycle) {
  const Hologram hologram = of_levels(1, 3, {250, 0, 128});
  PanelTables tables;
  tables.correction = Array2D<float>(1, 3);
  tables.correction.values = {10 / 256.0F, -1 / 256.0F, 0.5F};
  EXPECT_EQ(sent(hologram, {}, tables), (std::vector<uint16_t>{4, 255, 0}));
}

// Levels of 0, 0.1, 0.5 and 0.8 cycles: half a cycle beyond 0.1 is 0.6, to which 0.5 is nearest; beyond 0.8 it is 0.3, which
// lies in the middle of 0.1 and 0.5, so 0.29 shows which one is nearer.
TEST(PanelImages, AddedPhasesUseTheStepsThatTheLevelsKnow) {
  Hologram hologram = of_levels(1, 2, {1, 3}, 4);
  hologram.slm = Slm{};
  hologram.slm->grid = hologram.grid;
  hologram.slm->levels = 4;
  for (const double cycles : {0.0, 0.1, 0.5, 0.8})
    hologram.slm->effects.calibration.push_back({2 * std::numbers::pi * cycles, 1});
  hologram.effects = {"calibration"};
  PanelTables tables;
  tables.correction = Array2D<float>(1, 2);
  tables.correction.values = {0.5F, 0.49F};
  const auto levels = [&] { return panel_images({hologram}, {}, tables, PanelValue::level).at(0).values; };
  EXPECT_EQ(levels(), (std::vector<uint16_t>{2, 1}));
  hologram.effects = {};  // even steps: 1/4 + 1/2 and 3/4 + 0.49 are nearest to 3/4 and 1/4
  EXPECT_EQ(levels(), (std::vector<uint16_t>{3, 1}));
}

// Static errors are in the levels already: what is added must not take them off a second time.
TEST(PanelImages, LevelsKeepTheErrorsThatTheyCompensate) {
  Hologram hologram = of_levels(1, 2, {100, 200});
  hologram.slm = Slm{};
  hologram.slm->grid = hologram.grid;
  auto map = std::make_shared<Array2D<float>>(1, 2);
  map->values = {1.0F, 2.0F};
  hologram.slm->effects.phase_map = map;
  hologram.effects = {"phase-map"};
  PanelTables tables;
  tables.correction = Array2D<float>(1, 2, 0.25F);
  EXPECT_EQ(sent(hologram, {}, tables), (std::vector<uint16_t>{164, 8}));
}

TEST(PanelImages, TablesAreByGreyOrByLevel) {
  const Hologram four = of_levels(1, 4, {0, 1, 2, 3}, 4);  // greys 0, 64, 128, 192
  PanelTables tables;
  for (int grey = 0; grey < 256; ++grey) tables.lut.push_back(uint16_t(grey / 2));
  EXPECT_EQ(sent(four, {}, tables), (std::vector<uint16_t>{0, 32, 64, 96}));
  tables.lut = {9, 8, 7, 4095};
  const PanelImage image = panel_images({four}, {}, tables, PanelValue::grey).at(0);
  EXPECT_EQ(image.values, tables.lut);
  EXPECT_EQ(image.bits, 16);
  EXPECT_EQ(panel_images({four}, {}, {}, PanelValue::level).at(0).values, (std::vector<uint16_t>{0, 1, 2, 3}));
  tables.lut = {1, 2, 3};
  EXPECT_EQ(
      error_of([&] { sent(four, {}, tables); }),
      "expected a level table of 256 values, one for each grey of 8 bits, or one for each of the 4 levels, got 3 values");
}

// Red is the longest wavelength, in whatever order the holograms come.
TEST(PanelImages, ThreeColoursBecomeRedGreenAndBlue) {
  std::vector<Hologram> holograms;
  for (const auto& [wavelength, level] :
       {std::pair{532e-9, 20}, {450e-9, 30}, {638e-9, 10}, {532e-9, 21}, {450e-9, 31}, {638e-9, 11}}) {
    holograms.push_back(of_levels(1, 1, {uint16_t(level)}));
    holograms.back().wavelength = wavelength;
  }
  PanelImageParams params;
  params.packing = Packing::colours;
  const std::vector<PanelImage> images = panel_images(holograms, params, {}, PanelValue::grey);
  ASSERT_EQ(images.size(), 2U);  // frames
  EXPECT_EQ(images[0].channels, 3);
  EXPECT_EQ(images[0].values, (std::vector<uint16_t>{10, 20, 30}));
  EXPECT_EQ(images[1].values, (std::vector<uint16_t>{11, 21, 31}));
  holograms.pop_back();
  EXPECT_EQ(
      error_of([&] { panel_images(holograms, params, {}, PanelValue::grey); }),
      "expected holograms of three wavelengths, as many of each, to pack colours, got wavelengths: 3, holograms: 5; pass all "
      "holograms of a run in three colours, or leave out pack");
}

TEST(PanelImages, TwentyFourBinaryHologramsBecomeBits) {
  std::vector<Hologram> holograms;  // the pixel is on in planes 0, 9 and 23, and in the first of the next picture
  for (int plane = 0; plane < 25; ++plane)
    holograms.push_back(of_levels(1, 1, {uint16_t(plane == 0 || plane == 9 || plane >= 23)}, 2));
  std::vector<std::string> warnings;
  Observer observer;
  observer.on_warning = [&](const std::string& sentence) { warnings.push_back(sentence); };
  PanelImageParams params;
  for (const auto& [packing, first] : {std::pair{Packing::bits_rgb, std::vector<uint16_t>{1, 2, 128}},
                                       {Packing::bits_grb, {2, 1, 128}},
                                       {Packing::bits_bgr, {128, 2, 1}}}) {
    params.packing = packing;
    const std::vector<PanelImage> images = panel_images(holograms, params, {}, PanelValue::grey, observer);
    ASSERT_EQ(images.size(), 2U);
    EXPECT_EQ(images[0].values, first);
    EXPECT_EQ(images[0].bits, 8);
    EXPECT_EQ(images[1].values[packing == Packing::bits_grb ? 1 : packing == Packing::bits_rgb ? 0 : 2], 1);
  }
  EXPECT_EQ(warnings.at(0), "the last picture has 1 of 24 bit planes; the others are 0: show only these");
  holograms[3].levels = 4;
  EXPECT_EQ(error_of([&] { panel_images(holograms, params, {}, PanelValue::grey); }),
            "expected binary holograms to pack bits, got one of 4 levels; encode for a panel of 2 levels");
}

TEST(PanelImages, WhatAPanelCannotShowIsRefused) {
  Hologram hologram = of_levels(1, 100, std::vector<uint16_t>(100, 0));
  PanelImageParams params;
  params.blaze = {15.9e-6};
  EXPECT_EQ(
      error_of([&] { sent(hologram, params); }),
      "expected added fringes of two pixels (16 µm) or more along x, got 15.9 µm at the panel's edge; give a longer "
      "period for blaze, or a longer focal length for lens");
  params.blaze = {16e-6};
  EXPECT_EQ(error_of([&] { sent(hologram, params); }), "no error");
  params.lens = 1;  // both together are finer
  EXPECT_NE(error_of([&] { sent(hologram, params); }).find("expected added fringes"), std::string::npos);
  params.blaze = {};
  hologram.wavelength = 0;
  EXPECT_EQ(error_of([&] { sent(hologram, params); }),
            "expected a hologram of one known wavelength, to add a lens; give --wavelength");
  hologram.modulation = Modulation::amplitude;
  EXPECT_EQ(error_of([&] { sent(hologram, params); }),
            "expected blaze, lens and correction with a hologram of phases, got one of amplitudes; leave them out");
  hologram.modulation = Modulation::phase;
  PanelTables tables;
  tables.correction = Array2D<float>(1, 99);
  EXPECT_EQ(
      error_of([&] { sent(hologram, {}, tables); }),
      "expected a correction of 100 × 1 pixels, as the picture for the panel has, got 99 × 1; take that of this panel");
  hologram.modulation = Modulation::complex;
  EXPECT_NE(error_of([&] { sent(hologram, {}); }).find("got one of both"), std::string::npos);
  EXPECT_EQ(error_of([&] { panel_images({}, {}, {}, PanelValue::grey); }),
            "expected a hologram to make a picture for a panel of, got none");
}

}  // namespace
}  // namespace holotrace
